"""A reading may lack axes: the fit is that of the numbers that are left."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from sk120stiff.data_checks import look
from sk120stiff.effects import load_cases_of
from sk120stiff.identify import Problem, fit, fit_report, held_out, refitted
from sk120stiff.identify.checks.yardstick import scatter
from sk120stiff.identify.robust import reading_lengths
from sk120stiff.identify.uncertainty.left_over import left_over
from sk120stiff.measurements import Measurements, ModelForm, NoiseModel
from sk120stiff.plan import Schedule
from tests.identify.conftest import readings_of


def with_blanks(readings: Measurements, share: float = 0.35) -> Measurements:
    """The same readings, this share of the cells not read; one cell a row stays."""
    rng = np.random.default_rng(8)
    read = rng.random(readings.displacement.shape) > share
    read[np.arange(len(read)), rng.integers(0, 3, len(read))] = True
    return replace(readings, displacement=np.where(read, readings.displacement, np.nan))


def readings_with(zero: str, springs, seed: int = 3) -> Measurements:
    return readings_of(springs, poses=8, seed=seed, schedule=Schedule("ascending", 4, 1, zero))


def covariance(m: Measurements, noise: NoiseModel) -> np.ndarray:
    """(R, R) of the numbers that were read, without a closed form."""
    row, axis = np.nonzero(np.isfinite(m.displacement))
    group = m.zero_group if noise.zero == "shared" else np.arange(m.n_readings)
    same = (group[row][:, None] == group[row]) & (axis[:, None] == axis)
    grown = noise.growth**2 * np.nansum(m.displacement[row] ** 2, axis=1)
    own = noise.sigma**2 + grown
    return np.where(same, noise.sigma**2 / m.zero_count[row], 0.0) + np.diag(own)


@pytest.mark.parametrize("zero", ["shared", "separate"])
@pytest.mark.parametrize("growth", [0.0, 0.03])
def test_the_fit_is_generalised_least_squares_of_what_was_read(
    springs, zero: str, growth: float
) -> None:
    m = with_blanks(readings_with(zero, springs))
    noise = NoiseModel(10e-6, growth, zero)
    found = fit(springs, m, noise=noise)
    read = np.isfinite(m.displacement)
    V = covariance(m, noise)
    half = np.linalg.cholesky(np.linalg.inv(V)).T
    cases, start = load_cases_of(springs.robot, m), found.problem.start

    def residual(x: np.ndarray) -> np.ndarray:
        values = found.problem.values(x)
        return half @ (m.displacement - springs.predict(cases, values))[read]

    dense = least_squares(
        residual, start, jac="3-point", x_scale=np.abs(start), xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    np.testing.assert_allclose(found.x, dense.x, rtol=1e-6)
    np.testing.assert_allclose(found.chi_square, 2.0 * dense.cost, rtol=1e-9)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(dense.jac.T @ dense.jac), rtol=1e-3)
    assert found.degrees_of_freedom == read.sum() - 3
    ln2pi = read.sum() * np.log(2.0 * np.pi)
    expected = -0.5 * (2.0 * dense.cost + np.linalg.slogdet(V)[1] + ln2pi)
    assert found.log_likelihood == pytest.approx(expected, rel=1e-9)
    gap = (m.displacement - springs.predict(cases, found.problem.values(found.x)))[read]
    assert found.rms == pytest.approx(np.sqrt(np.mean(gap**2)), rel=1e-9)
    assert np.isnan(found.gap[~read]).all()
    assert f"{m.n_readings} readings, {read.sum()} of their {read.size} axes read," in fit_report(
        found
    )


def test_a_cell_without_information_is_a_blank_cell(springs) -> None:
    """Blank cells, and cells of enormous uncertainty, give the same fit."""
    full = readings_with("separate", springs)
    m = with_blanks(full)
    sigma = np.where(m.read, 10e-6, 10.0)
    noise = NoiseModel(10e-6, zero="separate")
    blank = fit(springs, m, noise=noise)
    vague = fit(springs, replace(full, sigma=sigma), noise=noise)
    np.testing.assert_allclose(blank.x, vague.x, rtol=1e-8)
    np.testing.assert_allclose(blank.covariance, vague.covariance, rtol=1e-8)


def test_masked_rows_that_are_blank_change_nothing(springs) -> None:
    full = readings_with("shared", springs)
    more = full + full.select([0, 5, 9])
    use = np.arange(more.n_readings) < full.n_readings
    empty = np.where(use[:, None], more.displacement, np.nan)
    noise = NoiseModel(10e-6, 0.02)
    plain = fit(springs, full, noise=noise)
    beside = fit(springs, replace(more, use=use, displacement=empty), noise=noise)
    np.testing.assert_array_equal(beside.x, plain.x)
    np.testing.assert_array_equal(beside.residual, plain.residual)
    assert beside.log_likelihood == plain.log_likelihood


def test_an_axis_that_nobody_read_is_no_axis_of_the_zero_reading(springs) -> None:
    """Rows of one axis each: those of different axes share nothing but the pose."""
    full = readings_with("shared", springs)
    one = np.eye(3, dtype=bool)[np.arange(full.n_readings) % 2]
    m = replace(full, displacement=np.where(one, full.displacement, np.nan))
    axis = np.arange(full.n_readings) % 2
    apart = replace(m, zero_group=2 * m.zero_group + axis)
    noise = NoiseModel(10e-6, zero="shared")
    np.testing.assert_allclose(
        fit(springs, m, noise=noise).x, fit(springs, apart, noise=noise).x, rtol=1e-12
    )


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_lengths_of_readings_by_dense_conditioning(springs, zero: str) -> None:
    m = with_blanks(readings_with(zero, springs))
    noise = NoiseModel(10e-6, zero=zero)
    problem = Problem(springs, m, noise)
    drawn = 1e-5 * np.random.default_rng(9).normal(size=m.read.shape)
    gap = np.where(m.read, drawn, np.nan)
    V, row = covariance(m, noise), m.row_of_number
    inverse, flat = np.linalg.inv(V), gap[m.read]
    pull = inverse @ flat
    expected = np.bincount(row, pull**2 / np.diag(inverse))  # axes of a row are independent
    np.testing.assert_allclose(reading_lengths(problem, gap), np.sqrt(expected), rtol=1e-9)


def test_a_spoilt_gauge_reading_is_found(springs) -> None:
    full = readings_of(springs, poses=25, seed=4)
    m = replace(full, displacement=np.where([False, False, True], full.displacement, np.nan))
    spoilt = m.displacement.copy()
    spoilt[19, 2] += 1e-3
    bad = replace(m, displacement=spoilt)
    noise = NoiseModel(10e-6)
    robust = fit(springs, bad, noise=noise, robust=True)
    assert robust.problem.weights[19] < 0.05
    assert len(robust.down_weighted) <= 5  # one in a hundred of 100, and the spoilt one
    truth = fit(springs, m, noise=noise)
    seen = truth.identifiable & ~truth.at_bound
    error = np.sqrt(np.diag(truth.covariance))[seen]
    assert np.abs((robust.x - truth.x)[seen] / error).max() < 1.0


def test_poses_left_out_are_weighed_by_the_numbers_read(springs) -> None:
    m = with_blanks(readings_with("shared", springs))
    (found,) = held_out(m, refitted(springs, noise=NoiseModel(10e-6)), folds=8)
    np.testing.assert_array_equal(found.counts, np.bincount(m.pose_index[m.row_of_number]))
    assert 0.7 < found.rms / (10e-6 * np.sqrt(2.0)) < 1.6


def test_model_form_and_remainder_are_of_what_was_read(springs) -> None:
    """With an error of its own at every pose: its size comes out, and V is the dense one."""
    full = readings_of(springs, poses=30, seed=6)
    rng = np.random.default_rng(10)
    own = 4e-5 * rng.normal(size=(30, 3))
    m = with_blanks(replace(full, displacement=full.displacement + own[full.pose_index]))
    found = fit(springs, m, noise=NoiseModel(10e-6))
    left = left_over(found)
    of_these = np.sqrt(np.mean(own[m.pose_index][m.read] ** 2))  # what was drawn, not its law
    assert left.interval[0] < of_these < left.interval[1]
    noise = NoiseModel(10e-6, form=ModelForm(0.0, 4e-5))
    row, axis = np.nonzero(m.read)
    same = (m.pose_index[row][:, None] == m.pose_index[row]) & (axis[:, None] == axis)
    V = covariance(m, NoiseModel(10e-6)) + np.where(same, 4e-5**2, 0.0)
    whitener, x = noise.whitener(m), rng.normal(size=(m.n_readings, 3, 4))
    white = whitener.apply(x)
    np.testing.assert_allclose(white.T @ white, x[m.read].T @ np.linalg.solve(V, x[m.read]))
    assert whitener.logdet == pytest.approx(np.linalg.slogdet(V)[1], rel=1e-10)
    assert noise.form.rms(m) == pytest.approx(4e-5)


def test_the_scatter_within_poses_tells_the_noise_of_one_axis(springs) -> None:
    full = readings_of(springs, poses=12, seed=9, schedule=Schedule("ascending", 6))
    m = replace(full, displacement=np.where([True, False, False], full.displacement, np.nan))
    told = scatter(fit(springs, m, noise=NoiseModel(10e-6)))
    assert told is not None
    assert told.freedom <= m.n_readings
    assert 0.7 < told.sigma / 10e-6 < 1.4


def test_more_parameters_than_numbers_are_refused(springs) -> None:
    m = readings_of(springs, poses=2, schedule=Schedule("ascending", 1))
    one = replace(m, displacement=np.where([False, False, True], m.displacement, np.nan))
    with pytest.raises(
        Exception, match="3 parameters cannot be estimated from 2 readings of 2 num"
    ):
        fit(springs, one, noise=NoiseModel(10e-6))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_checks_of_the_data_see_no_slip_in_a_gauge_of_one_axis(springs, axis: int) -> None:
    full = readings_of(springs, poses=15, seed=12)
    one = np.arange(3) == axis
    sound = replace(full, displacement=np.where(one, full.displacement, np.nan))
    assert look(springs, sound).sentences == ()
    assert look(springs, with_blanks(full)).sentences == ()
    turned = look(springs, replace(sound, displacement=-sound.displacement)).slip
    assert turned is not None
    assert "sign" in turned.said
