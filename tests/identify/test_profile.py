"""Profile intervals against a scan of the misfit."""

import numpy as np
import pytest
from scipy.optimize import brentq, least_squares

from sk120stiff.effects import effect, load_cases_of
from sk120stiff.identify import Problem, profile_intervals, solve
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import joint_spring_model
from tests.identify.conftest import readings_of

NOISE = NoiseModel(10e-6)


def scanned_end(problem: Problem, found, k: int, side: float, goal: float) -> float:
    """How far to the internal value where the least misfit over the others has risen by goal²."""
    load_cases = load_cases_of(problem.model.robot, problem.measurements)
    L = np.linalg.cholesky(problem.noise.covariance(problem.measurements))
    best = np.array([p.internal for p in found.parameters])
    others = [j for j in range(len(best)) if j != k]
    unit = best[others]

    def least(value: float) -> float:
        def residual(part: np.ndarray) -> np.ndarray:
            x = best.copy()
            x[k], x[others] = value, part * unit
            gap = problem.measured - problem.model.predict(load_cases, x)
            return np.linalg.solve(L, gap.T[..., None]).ravel()

        return 2.0 * float(least_squares(residual, np.ones(len(others))).cost)

    std = found.parameters[k].internal_std
    return brentq(
        lambda d: least(best[k] + side * d) - found.chi_square - goal**2,
        0.2 * std,
        12 * std,
        rtol=1e-5,
    )


def test_ends_as_found_by_scanning(springs, table2) -> None:
    problem = Problem(springs, table2, NOISE)
    found = solve(problem)
    for k, (low, high) in enumerate(profile_intervals(found)):
        best = found.parameters[k].internal
        for side, end in ((1.0, low), (-1.0, high)):
            expected = best + side * scanned_end(problem, found, k, side, 1.95996)
            assert 1.0 / end == pytest.approx(expected, rel=1e-4)


def test_linear_and_profile_agree_where_readings_are_linear(springs, table2) -> None:
    found = solve(Problem(springs, table2, NOISE))
    np.testing.assert_allclose(profile_intervals(found), found.intervals(), rtol=2e-3)


def test_a_bound_ends_the_interval(springs, robot) -> None:
    model = springs + effect(robot, "base_rocking")
    found = solve(Problem(model, readings_of(springs, poses=6, seed=3), NOISE))
    ends = profile_intervals(found)
    held = np.flatnonzero(found.at_bound)
    assert len(held)
    for k in held:
        assert ends[k][1] == np.inf
        assert ends[k][0] == pytest.approx(found.intervals()[k][0], rel=0.02)


def test_what_is_not_seen_has_no_end(robot, table2) -> None:
    found = solve(Problem(joint_spring_model(robot), table2, NOISE))
    ends = profile_intervals(found)
    assert ends[3] == (0.0, np.inf)
    assert ends[5] == (0.0, np.inf)


def test_progress_is_told(springs, table2) -> None:
    told: list[tuple[int, int]] = []
    profile_intervals(
        solve(Problem(springs, table2, NOISE)), progress=lambda *step: told.append(step)
    )
    assert told == [(1, 3), (2, 3), (3, 3)]
