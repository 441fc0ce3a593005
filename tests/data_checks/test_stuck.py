"""Gauges that are stuck, or at the end of their range, and those that only read coarsely."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import base_model, explain, load_robot
from sk120stiff.data_checks import without_stuck
from sk120stiff.errors import ToolkitWarning
from sk120stiff.measurements import Measurements
from tests.explain.readings import hidden


def rounded(readings: Measurements, to: float) -> Measurements:
    """As an instrument shows them that tells so much [m]."""
    assert readings.displacement is not None
    return replace(readings, displacement=np.rint(readings.displacement / to) * to)


def with_axis(readings: Measurements, axis: int, rows: np.ndarray, value: float) -> Measurements:
    moved = np.array(readings.displacement)
    moved[rows, axis] = value
    return replace(readings, displacement=moved)


@pytest.mark.parametrize("to", [1e-6, 1e-5, 5e-5, 2e-4])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_coarse_readings_are_none(to: float, seed: int) -> None:
    assert without_stuck(rounded(hidden(poses=30, loads=6, seed=seed), to))[1] is None


def test_an_axis_that_hardly_moves_is_none() -> None:
    """It reads the same few numbers again and again."""
    readings = rounded(hidden(poses=30, loads=6), 1e-6)
    moved = np.array(readings.displacement)
    moved[:, 1] = 1e-6 * np.rint(np.random.default_rng(1).normal(scale=1.5, size=len(moved)))
    assert without_stuck(replace(readings, displacement=moved))[1] is None


def test_a_stuck_axis_is_left_out_and_the_others_stay() -> None:
    readings = rounded(hidden(poses=20, loads=5), 1e-6)
    rows = np.flatnonzero(np.isin(readings.pose_index, [3, 7]))
    stuck = with_axis(readings, 1, rows, 37e-6)
    told, said = without_stuck(stuck)
    assert said is not None
    assert f"dy reads exactly 0.037 mm in {len(rows)} rows" in said
    assert "stuck" in said
    lines = [str(readings.line[row]) for row in rows[:5]]
    assert f"(lines {', '.join(lines)}, …)" in said
    expected = np.array(stuck.displacement)
    expected[rows, 1] = np.nan
    np.testing.assert_array_equal(told.displacement, expected)
    assert told.use.all()


def test_the_end_of_a_range_is_left_out_on_both_sides_and_springs_come_out_right() -> None:
    readings = rounded(hidden(poses=20, loads=5), 1e-6)
    most = float(np.rint(1e6 * np.quantile(np.abs(readings.displacement), 0.8)) * 1e-6)
    clipped = replace(readings, displacement=np.clip(readings.moved, -most, most))
    beyond = (np.abs(readings.moved) >= most).sum()
    told, said = without_stuck(clipped)
    assert said is not None and "the end of its range" in said
    assert np.isnan(told.displacement).sum() == beyond
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    with pytest.warns(ToolkitWarning, match="the end of its range"):
        answer = explain(model, clipped, holdout=readings)
    whole = explain(model, readings, holdout=readings)
    for own, other in zip(answer.final.parameters, whole.final.parameters, strict=True):
        assert own.internal == pytest.approx(other.internal, rel=0.02)
