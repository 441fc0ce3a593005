"""One of two files lacks a line: from there on columns stand a row off, and the line is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.data_checks.passive import of_sums, passive
from sk120stiff.data_checks.search import find_slip
from sk120stiff.measurements import Measurements
from tests.data_checks.readings import ARMS, ur5

LINE = 31  # of the file, from where on; row 29
PARTS = {
    "readings": "the readings (dx, dy, dz)",
    "loads": "the loads (fx, fy, fz)",
    "joints": "the joints",
}


def lacking(m: Measurements, part: str, row: int, by: int) -> Measurements:
    """The columns of a part lack `by` rows from `row` on; of the others as many at the end."""
    count = m.n_readings - by
    own = np.delete(np.arange(m.n_readings), np.arange(row, row + by))
    of = {name: np.arange(count) for name in PARTS} | {part: own}
    if m.displacement is None:
        raise ValueError("a plan")
    return Measurements(
        pose=tuple(f"p{k}" for k in range(count)),
        joint_names=m.joint_names,
        joints=m.joints[of["joints"]],
        wrench=m.wrench[of["loads"]],
        displacement=m.displacement[of["readings"]],
        point=m.point,
        zero="separate",
        noise=m.noise,
        line=np.arange(2, count + 2),
    )


@pytest.mark.parametrize(("arm", "by"), list(zip(ARMS, [1, 2], strict=True)))
@pytest.mark.parametrize("part", PARTS)
def test_the_line_is_told(arm: str, part: str, by: int) -> None:
    sound = ARMS[arm]()
    found = find_slip(sound.robot, lacking(sound.readings, part, LINE - 2, by))
    assert found is not None and found.after > max(0.9, found.before)
    rows = f"{by} row{'s' if by > 1 else ''}"
    # what lacks lines holds, from there on, what belongs further down: it stands too high
    assert f"on {PARTS[part]} seem to stand {rows} too high" in found.said
    told = int(found.said.split("from line ")[1].split()[0])
    loads = 4  # a pose's rows are alike in their joints
    assert abs(told - LINE) <= (loads if part == "joints" else 1)
    assert f"{PARTS[part]} down by {rows}" in found.remedy


def test_a_row_that_is_masked_keeps_its_place() -> None:
    whole = lacking(ur5().readings, "readings", LINE - 2, 1)
    use = np.ones(whole.n_readings, dtype=bool)
    use[[5, 40]] = False
    found = find_slip(ur5().robot, replace(whole, use=use))
    assert found is not None and f"from line {LINE} on" in found.said


def test_of_many_rows_the_very_line_is_told() -> None:
    """Some rows are tried, then those between the best two."""
    arm = ur5()
    many = arm.readings.select(np.tile(np.arange(arm.readings.n_readings), 7))
    for row in (171, 174):
        found = find_slip(arm.robot, lacking(many, "readings", row, 1))
        assert found is not None
        told = int(found.said.split("from line ")[1].split()[0])
        assert told in (row + 2, row + 3)  # the first of them has no reading of its own at all


def test_sums_say_what_rows_say() -> None:
    rng = np.random.default_rng(0)
    A, d = rng.normal(size=(20, 3, 5)) ** 2, rng.normal(size=(20, 3)) + 1.0
    B, y = A.reshape(60, 5), d.ravel()
    whole, summed = passive(A, d), of_sums(B.T @ B, B.T @ y, float(y @ y), 60)
    assert summed.share == pytest.approx(whole.share, rel=1e-9)
    assert summed.left == pytest.approx(whole.left, rel=1e-9) and summed.count == whole.count
    assert of_sums(np.zeros((5, 5)), np.zeros(5), 1.0, 60).share == 0.0
