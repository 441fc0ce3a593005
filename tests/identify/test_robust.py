"""Huber's loss on whole readings."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.identify import Problem, fit, lack_of_fit, solve
from sk120stiff.identify.robust import LIMIT, _inflation, reading_lengths, solve_robustly
from sk120stiff.measurements import NoiseModel
from sk120stiff.plan import Schedule
from tests.identify.conftest import readings_of, without_statement

NOISE = NoiseModel(10e-6)


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_lengths_by_dense_conditioning(springs, zero: str) -> None:
    """Each reading given all others, from the textbook on multivariate normals."""
    readings = readings_of(springs, poses=3, schedule=Schedule("ascending", 4, 1, zero))
    noise = replace(NOISE, zero=zero)
    weights = np.linspace(0.2, 1.0, readings.n_readings)
    problem = Problem(springs, readings, noise, weights)
    rng = np.random.default_rng(1)
    gap = 1e-5 * rng.normal(size=(readings.n_readings, 3))
    own, shared = noise.variances(readings)
    expected = np.zeros(readings.n_readings)
    for axis in range(3):
        same = readings.zero_group[:, None] == readings.zero_group[None, :]
        if zero == "separate":
            same = np.eye(len(gap), dtype=bool)
        V = np.where(same, shared[0, axis], 0.0)
        for k in range(len(gap)):
            trust = weights.copy()
            trust[k] = 1.0
            full = V + np.diag(own[:, axis] / trust)
            rest = np.delete(np.arange(len(gap)), k)
            cross = np.linalg.solve(full[np.ix_(rest, rest)], full[rest, k])
            mean, variance = cross @ gap[rest, axis], full[k, k] - cross @ full[rest, k]
            expected[k] += (gap[k, axis] - mean) ** 2 / variance
    np.testing.assert_allclose(reading_lengths(problem, gap), np.sqrt(expected), rtol=1e-10)


def test_clean_readings_are_left_alone(springs) -> None:
    readings = readings_of(springs, poses=20, seed=2)
    plain = fit(springs, readings, noise=NOISE)
    robust = fit(springs, readings, noise=NOISE, robust=True)
    assert len(robust.down_weighted) <= 4  # one in a hundred of 80
    moved = (robust.x - plain.x) / np.sqrt(np.diag(plain.covariance))
    assert np.abs(moved).max() < 0.5
    np.testing.assert_allclose(
        np.sqrt(np.diag(robust.covariance) / np.diag(plain.covariance)), 1.0, atol=0.12
    )


@pytest.mark.parametrize("stated", [True, False])
def test_a_spoilt_reading_is_found_and_hardly_counts(springs, stated: bool) -> None:
    readings = readings_of(springs, poses=10, seed=4)
    spoilt = readings.displacement.copy()
    spoilt[19] += [2e-3, -1e-3, 1e-3]
    readings = replace(readings, displacement=spoilt)
    if not stated:
        readings = without_statement(readings)
    clean = fit(springs, readings.select(np.arange(40) != 19), noise=NOISE)
    plain = fit(springs, readings, noise=NOISE)
    robust = fit(springs, readings, robust=True)
    std = np.sqrt(np.diag(clean.covariance))
    assert np.abs((plain.x - clean.x) / std).max() > 5.0
    assert np.abs((robust.x - clean.x) / std).max() < 1.0
    worst = robust.down_weighted[np.argmin(robust.problem.weights[robust.down_weighted])]
    assert worst == 19
    assert robust.problem.weights[19] < 0.1
    spread = 1.0 if stated else robust.noise_factor
    assert spread * robust.problem.noise.sigma == pytest.approx(10e-6, rel=0.25)
    assert lack_of_fit(robust) is None  # a weighted misfit is no χ²


def test_weights_are_hubers(springs) -> None:
    readings = readings_of(springs, poses=10, seed=4, outliers=0.1)
    found = solve_robustly(Problem(springs, readings, NOISE))
    lengths = reading_lengths(found.problem, found.gap)
    np.testing.assert_allclose(
        found.problem.weights, np.minimum(1.0, LIMIT[3] / lengths), rtol=0, atol=1e-5
    )
    assert found.inflation > 1.0


def test_intervals_hold_in_spite_of_outliers(springs) -> None:
    """One in ten readings off by 5 to 20 sigma: Huber holds with intervals half as wide."""
    inside = {True: 0, False: 0}
    misses, widths = {True: [], False: []}, {True: [], False: []}
    for seed in range(30):
        readings = readings_of(springs, poses=12, seed=seed, outliers=0.1)
        for robust in (True, False):
            found = (
                solve_robustly(Problem(springs, readings, NOISE))
                if robust
                else solve(Problem(springs, readings, NOISE))
            )
            for p, (low, high), true in zip(
                found.parameters, found.intervals(), springs.parameters, strict=True
            ):
                inside[robust] += low <= true.value <= high
                misses[robust].append((p.internal - true.internal) / true.internal)
                widths[robust].append(1.0 / low - 1.0 / high)
    assert inside[True] >= 0.88 * 90
    assert inside[False] >= 0.88 * 90  # inflated by what the outliers leave
    assert np.median(widths[True]) < 0.6 * np.median(widths[False])
    assert np.std(misses[True]) < 0.75 * np.std(misses[False])


def test_inflation_by_hand() -> None:
    """Huber 1973 for whole readings: E ψ² over (E ψ')², times the mean weight."""
    lengths = np.array([0.5, 1.0, 2.0, 2.0 * LIMIT[3]])
    weights = np.array([1.0, 1.0, 1.0, 0.5])
    psi = (0.25 + 1.0 + 4.0 + LIMIT[3] ** 2) / 4 / 3
    slope = (3 * (1 + 2) + 0 + 2 * 0.5) / 4 / 3
    freedom = (12 - 3) / 12
    expected = psi / freedom / slope**2 * 3.5 / 4
    assert _inflation(lengths, weights, np.full(4, 3), 3) == pytest.approx(expected, rel=1e-12)
