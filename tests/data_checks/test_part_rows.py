"""Another unit or sign in a part of the rows: what, where and by how much is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.data_checks import find_slip, part_rows
from sk120stiff.data_checks.part_rows import KGF, LBF, part_of_the_rows
from sk120stiff.data_checks.part_words import places
from sk120stiff.data_checks.search import Slip
from sk120stiff.data_checks.sheet import sheet_of
from sk120stiff.errors import Refusal
from sk120stiff.explain import explain
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot
from tests.data_checks.readings import ARMS, ur5

ROWS = {
    "the second half": (slice(28, None), "lines 30 to 57"),
    "some between": (slice(12, 31), "lines 14 to 32"),
    "from the first on": (slice(None, 20), "lines 2 to 21"),
}


def _in_turn(*units: tuple[str, float]) -> list[tuple[str, str, float]]:
    """Each unit in one choice of rows, and each choice by one unit."""
    return [(rows, *unit) for rows, unit in zip(ROWS, units, strict=True)]


def numbered(readings: Measurements) -> Measurements:
    """With the lines of a file whose first holds the headers."""
    return replace(readings, line=np.arange(2, readings.n_readings + 2))


def loads_times(by: float, rows: slice) -> Measurements:
    """Loads of some rows written in a unit that is `by` N large, and read as N."""
    readings = numbered(ur5().readings)
    wrench = readings.wrench.copy()
    wrench[rows] /= by
    return replace(readings, wrench=wrench)


def read_times(by: float, rows: slice) -> Measurements:
    """Displacements of some rows written in a unit that is `by` mm large, and read as mm."""
    readings = numbered(ur5().readings)
    assert readings.displacement is not None
    moved = readings.displacement.copy()
    moved[rows] /= by
    return replace(readings, displacement=moved)


def slip_in(readings: Measurements) -> Slip | None:
    return find_slip(ur5().robot, readings)


@pytest.mark.parametrize(("rows", "unit", "by"), _in_turn(("kgf", KGF), ("lbf", LBF), ("kN", 1e3)))
def test_forces_in_another_unit(rows: str, unit: str, by: float) -> None:
    part, lines = ROWS[rows]
    found = slip_in(loads_times(by, part))
    assert found is not None and found.after > 0.95
    told = f"{lines}: forces look like {unit}, not N"
    assert told in found.said or told in found.remedy  # µm for mm look like kN for N
    assert f"Write fx, fy, fz there times {by:.6g}." in found.remedy


@pytest.mark.parametrize(("rows", "unit", "by"), _in_turn(("inch", 25.4), ("um", 1e-3), ("m", 1e3)))
def test_displacements_in_another_unit(rows: str, unit: str, by: float) -> None:
    part, lines = ROWS[rows]
    found = slip_in(read_times(by, part))
    assert found is not None and found.after > 0.95
    told = f"{lines}: displacements look like {unit}, not mm"
    assert told in found.said or told in found.remedy
    assert f"Write dx, dy, dz there times {by:.6g}." in found.remedy


@pytest.mark.parametrize("rows", ROWS)
def test_forces_of_the_other_sign(rows: str) -> None:
    part, lines = ROWS[rows]
    found = slip_in(loads_times(-1.0, part))
    assert found is not None and found.after > 0.95
    assert f"{lines}: forces have the other sign than in the other rows" in found.said
    assert "Negate fx, fy, fz there" in found.remedy


def test_rows_here_and_there() -> None:
    found = slip_in(loads_times(-1.0, slice(3, None, 7)))
    assert found is not None
    assert "lines 5, 12, 19, 26, 33, 40, 47, 54: forces have the other sign" in found.said
    found = slip_in(loads_times(KGF, slice(3, None, 7)))
    assert found is not None
    assert "lines 5, 12, 19, 26, 33, 40, 47, 54: forces look like kgf" in found.said


def test_one_axis_of_the_other_sign_in_a_part() -> None:
    readings = numbered(ur5().readings)
    wrench = readings.wrench.copy()
    wrench[28:, 2] *= -1.0
    found = slip_in(replace(readings, wrench=wrench))
    assert found is not None and "lines 30 to 57: fz has the other sign" in found.said


@pytest.mark.parametrize("force", ["N", "kgf"])
def test_the_header_tells_which_rows_are_wrong(force: str, tmp_path: Path) -> None:
    """Under a header in kgf, the rows whose loads are too large hold newtons."""
    path = tmp_path / "data.csv"
    path.write_text(f"pose,fx[{force}],dx[mm]\nP01,1,1\n", encoding="utf-8")
    found = slip_in(replace(loads_times(KGF, slice(28, None)), path=path))
    assert found is not None
    if force == "N":
        assert "lines 30 to 57: forces look like kgf, not N" in found.said
        assert "times 9.80665" in found.remedy
    else:
        assert "lines 2 to 29: forces look like N, not kgf" in found.said
        assert "times 0.101972" in found.remedy


def test_explain_names_no_spring_for_it() -> None:
    arm = ARMS["ur5"]()
    with pytest.raises(Refusal, match="lines 30 to 57: forces look like kgf, not N"):
        explain(arm.model, loads_times(KGF, slice(28, None)))


@pytest.mark.parametrize("by", [1.5, 6.5, 15.0])
def test_a_factor_that_is_no_unit_is_not_told(by: float) -> None:
    """Two arms in one file, or something that came loose: that is a matter of physics."""
    assert slip_in(loads_times(by, slice(28, None))) is None


def test_dead_readings_are_no_unit() -> None:
    """A load that was forgotten leaves noise, which fits no unit however small it is."""
    readings = numbered(ur5().readings)
    assert readings.displacement is not None
    moved = readings.displacement.copy()
    moved[20:30] = 5e-6 * np.random.default_rng(3).normal(size=(10, 3))
    assert slip_in(replace(readings, displacement=moved)) is None


@pytest.mark.parametrize("play", [0.5, 2.0])
def test_gears_with_play_are_not_doubted(play: float) -> None:
    """Small loads then move the point several times as far for their size, row by row."""
    for robot, readings in _uneven_loads(play):
        sheet = sheet_of(robot, readings)
        assert sheet is not None
        assert find_slip(robot, readings) is None


def _uneven_loads(play: float) -> Iterator[tuple[Robot, Measurements]]:
    """Loads from a tenth up, in steps; each gear turns by its play first [mrad]."""
    arm = ur5()
    for seed in range(4):
        rng = np.random.default_rng(seed)
        wrench = arm.readings.wrench * np.tile([0.1, 0.2, 0.5, 1.0], 14)[:, None]
        at = arm.robot.screws(arm.readings.joints, point=arm.readings.point)
        torques = at.torques(wrench)
        turned = torques / rng.uniform(5e3, 3e4, 6) + 1e-3 * play * np.tanh(torques / 2.0)
        moved = np.einsum("nij,nj->ni", at.linear_jacobian, turned)
        moved += 5e-6 * rng.normal(size=moved.shape)
        yield arm.robot, replace(numbered(arm.readings), wrench=wrench, displacement=moved)


def test_sound_readings_hold_no_part() -> None:
    for make in ARMS.values():
        arm = make()
        assert find_slip(arm.robot, numbered(arm.readings)) is None


@pytest.mark.parametrize("count", [21, 56])
@pytest.mark.parametrize("share", [(0.34, 1.0), (0.18, 0.53)])
def test_the_very_rows_are_told(
    count: int, share: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of rows that follow one another, too, which are not sorted one by one."""
    monkeypatch.setattr(part_rows, "_here_and_there", lambda plain, other: None)
    first, last = (round(end * count) for end in share)
    readings = loads_times(KGF, slice(first, last)).select(np.arange(count))
    sheet = sheet_of(ur5().robot, readings)
    assert sheet is not None
    found = part_of_the_rows(sheet, 6)
    assert found is not None
    told = np.zeros(count, dtype=bool)
    told[found.rows] = True
    if found.way.times < 1.0:
        told = ~told
    assert np.flatnonzero(told).tolist() == list(range(first, last))


def test_few_rows_are_not_tried() -> None:
    sheet = sheet_of(ur5().robot, ur5().readings.select(np.arange(5)))
    assert sheet is not None and part_of_the_rows(sheet, 6) is None


def test_lines_are_told_in_stretches() -> None:
    used = np.array([0, 2, 3, 5, 6, 7, 9])
    lines = np.arange(10) + 2
    assert places(np.array([2, 3, 5, 9]), used, lines) == "lines 4 to 7, 11"
    assert places(np.array([0, 6, 7]), used, lines) == "lines 2, 8, 9"
    assert places(np.array([0]), used, np.zeros(10, dtype=int)) == "rows 1"
