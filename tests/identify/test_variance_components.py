"""Sizes of model-form error from gaps whose covariance is known."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import load_cases_of
from sk120stiff.identify import Fit, fit
from sk120stiff.identify.uncertainty.laid_out import LaidOut
from sk120stiff.identify.uncertainty.variance_components import Deviance, variance_components
from sk120stiff.measurements import Measurements, ModelForm, NoiseModel
from sk120stiff.measurements.noise.model_form import EXACT
from sk120stiff.model import Model
from tests.identify.conftest import readings_of

SIGMA = 10e-6


def with_form(data: Measurements, form: ModelForm, rng: np.random.Generator) -> Measurements:
    """The readings with a compliance error and an offset drawn for every pose."""
    d = data.displacement.copy()
    f = data.wrench[:, :3]
    for pose in data.poses:
        rows = np.array([label == pose for label in data.pose])
        c = np.sqrt(np.mean(d[rows] ** 2) / np.mean(f[rows] ** 2))
        D = form.proportional * c * rng.normal(size=(3, 3))
        d[rows] += f[rows] @ D.T + form.constant * rng.normal(size=3)
    return replace(data, displacement=d)


def fits(springs: Model, form: ModelForm, *, noise: NoiseModel, count: int) -> list[Fit]:
    """Fits of data with such an error, all of other poses and noise."""
    found = []
    for seed in range(count):
        data = readings_of(springs, poses=15, sigma=SIGMA, seed=seed)
        data = with_form(data, form, np.random.default_rng((seed, 2)))
        assert len(load_cases_of(springs.robot, data).poses) == 15
        found.append(fit(springs, data, noise=replace(noise, zero=data.zero)))
    return found


@pytest.mark.parametrize(
    "form", [ModelForm(0.08, 0.0), ModelForm(0.0, 60e-6), ModelForm(0.1, 8e-5)]
)
@pytest.mark.parametrize("known", [True, False])
def test_sizes_come_out_without_bias(springs, form, known):
    noise = NoiseModel(SIGMA) if known else NoiseModel(3e-5, freedom=0)
    found = [variance_components(each) for each in fits(springs, form, noise=noise, count=8)]
    for name in ("proportional", "constant"):
        true = getattr(form, name)
        sizes = np.array([getattr(each.form, name) for each in found])
        if true:
            # 15 poses tell a standard deviation to about a tenth, eight times that to 4 %
            assert np.sqrt(np.mean(sizes**2)) == pytest.approx(true, rel=0.2)
        else:
            assert np.median(sizes) < 0.2 * getattr(ModelForm(0.08, 60e-6), name)
    assert all(each.probability < 1e-6 for each in found)
    if not known:
        assert np.mean([each.noise_factor for each in found]) == pytest.approx(
            SIGMA / 3e-5, rel=0.1
        )


def test_noise_alone_is_no_model_form_error(springs):
    noise = NoiseModel(SIGMA)
    found = [
        variance_components(each) for each in fits(springs, ModelForm(), noise=noise, count=30)
    ]
    chances = np.array([each.probability for each in found])
    assert (chances < 1e-3).sum() == 0
    assert (chances < 0.1).mean() < 0.3
    assert np.mean([each.inflation for each in found]) == pytest.approx(1.0, abs=0.03)


def test_a_sigma_that_is_too_small_is_told_from_structure(springs):
    """Noise that is merely larger than was stated inflates σ; structure does better than that."""
    small = NoiseModel(SIGMA / 1.5)
    for each in fits(springs, ModelForm(), noise=small, count=6):
        found = variance_components(each)
        assert found.inflation == pytest.approx(1.5, rel=0.12)
        assert found.inflation_gain > found.gain
    for each in fits(springs, ModelForm(0.1, 0.0), noise=NoiseModel(SIGMA), count=3):
        found = variance_components(each)
        assert found.gain > found.inflation_gain + 20.0


def test_parameters_are_taken_off_the_freedom_of_an_unknown_noise(springs):
    """Few readings: sigma comes from χ² over rows less parameters, as least squares have it."""
    data = readings_of(springs, poses=3, sigma=SIGMA, seed=1)
    found = fit(springs, data, noise=NoiseModel(3e-5, freedom=0, zero=data.zero))
    sums = Deviance.of(LaidOut.of(found))
    assert sums.freedom == found.degrees_of_freedom == len(found.residual) - len(found.x)
    assert sums.noise_factor(EXACT) == pytest.approx(
        np.sqrt(found.chi_square / found.degrees_of_freedom), rel=1e-6
    )


def test_a_noise_that_is_known_is_no_other(springs):
    """Known to nothing of itself, to a little, and by the gap alone."""
    found = fit(springs, readings_of(springs, poses=3, sigma=SIGMA, seed=1))
    laid, form = LaidOut.of(found), ModelForm(0.02, 1e-5)
    known, nearly = Deviance.of(laid), Deviance.of(laid, slack=1e-4)
    assert known.noise_factor(form) == 1.0
    assert known.with_noise(form, 1.0) == pytest.approx(known(form), rel=1e-12)
    assert known.with_noise(form, 1.1) == np.inf
    assert nearly.noise_factor(form) == pytest.approx(1.0, abs=1e-4)
    assert nearly(form) == pytest.approx(known(form), rel=1e-3)
