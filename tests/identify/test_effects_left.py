"""What random effects leave, against dense matrices and against draws."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sk120stiff.identify import fit
from sk120stiff.identify.uncertainty.laid_out import LaidOut
from sk120stiff.identify.uncertainty.left_over import LeftByPoses, left_by_all, left_over
from sk120stiff.measurements import ModelForm, NoiseModel
from tests.identify.conftest import readings_of
from tests.identify.test_variance_components import SIGMA, fits

FORM = ModelForm(0.05, 3e-5)


def columns_of(laid, form):
    """Random effects of all poses as one dense matrix (3N, Gq), raw; derivative and gap, raw."""
    q = laid.drawn.shape[2]
    size = np.where(np.arange(q) < laid.proportional, form.proportional, form.constant)
    flat = laid.drawn.reshape(-1, q) * size
    Z = np.zeros((len(flat), q * len(laid.poses)))
    for g, rows in enumerate(laid.poses):
        Z[rows, g * q : (g + 1) * q] = flat[rows]
    rest = laid.derivative.reshape(len(flat), -1)
    return Z, rest[:, :-1], rest[:, -1]


def moved(data, added):
    """The readings with something more (N, 3) in their displacements, in their own axes."""
    return replace(data, displacement=data.displacement + added)


def test_low_rank_algebra_is_that_of_dense_matrices(springs):
    found = fits(springs, FORM, noise=NoiseModel(SIGMA), count=1)[0]
    laid, factor = LaidOut.of(found), 1.2
    Z, X, gap = columns_of(laid, FORM)
    whiten = laid.problem.whitener.apply

    def white(raw):
        return whiten(raw.reshape(-1, 3, raw.shape[1])) / factor

    Zw, Xw, y = white(Z), white(X), white(gap[:, None])[:, 0]
    pinv = np.linalg.pinv(Xw)
    A = Z - X @ pinv @ Zw
    M = np.eye(len(y)) - Xw @ pinv
    C = np.linalg.inv(np.eye(Z.shape[1]) + Zw.T @ M @ Zw)
    likeliest = C @ Zw.T @ M @ y
    K = A.T @ A
    mean = likeliest @ K @ likeliest + np.trace(K @ C)
    variance = 2 * np.trace(K @ C @ K @ C) + 4 * likeliest @ K @ C @ K @ likeliest
    freedom = 2 * mean**2 / variance
    ends = stats.chi2.ppf([0.025, 0.975], freedom) / freedom
    expected = np.sqrt(mean / len(y) * np.array([ends[0], 1.0, ends[1]]))
    told = LeftByPoses.of(LaidOut.of(found)).of_sizes(FORM, factor)
    assert told == pytest.approx(expected, rel=1e-9)


def test_intervals_hold_what_was_drawn(springs):
    """20 arms with random effects: what least squares leaves of them lies in the interval."""
    held = 0
    for seed in range(20):
        data = readings_of(springs, poses=15, sigma=SIGMA, seed=seed)
        found = fit(springs, data, noise=NoiseModel(SIGMA, zero=data.zero))
        rng = np.random.default_rng(seed)
        laid = LaidOut.of(found)
        Z, X, _ = columns_of(laid, FORM)
        added = (Z @ rng.normal(size=Z.shape[1])).reshape(-1, 3)
        rough = fit(springs, moved(data, added), noise=NoiseModel(SIGMA, zero=data.zero))
        whiten = laid.problem.whitener.apply
        Xw = whiten(X.reshape(-1, 3, X.shape[1]))
        taken = np.linalg.lstsq(Xw, whiten(added), rcond=None)[0]
        true = np.sqrt(np.mean((added.ravel() - X @ taken) ** 2))
        low, high = left_over(rough).interval
        held += low < true < high
    assert held >= 17


def test_what_all_poses_share_is_found_by_its_columns(springs):
    """Two columns of any shape, at 0.7 of the noise: no single pose shows them."""
    data = readings_of(springs, poses=15, sigma=SIGMA, seed=3)
    found = fit(springs, data, noise=NoiseModel(SIGMA, zero=data.zero))
    columns = np.random.default_rng(1).normal(size=(data.n_readings, 3, 2))
    added = 0.7 * SIGMA * columns @ np.array([0.8, -0.6])
    rough = fit(springs, moved(data, added), noise=NoiseModel(SIGMA, zero=data.zero))
    low, middle, high = left_by_all(LaidOut.of(rough), columns, 1.0)
    true = np.sqrt(np.mean(added**2))
    assert low < true < high
    assert middle == pytest.approx(true, rel=0.3)
    nothing = left_by_all(LaidOut.of(found), columns, 1.0)[1]
    assert nothing < 0.3 * middle
