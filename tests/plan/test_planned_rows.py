"""MuJoCo finds nothing wrong with what is planned, and a lot with what is drawn at random."""

import pytest

from tests.plan.planned_rows import rows_of


@pytest.mark.parametrize("name", ["ur10_robot.urdf", "panda.urdf"])
def test_planned_rows_touch_nothing_and_motors_hold_them(name: str) -> None:
    count, wrong, random = rows_of(name, poses=25)
    assert count > 25 and not wrong
    assert random > 0.15
