"""MuJoCo finds nothing wrong with what is planned, and a lot with what is drawn at random."""

import pytest

from tests.plan.planned_rows import rows_of


@pytest.mark.parametrize("name", ["ur10_robot.urdf", "panda.urdf"])
def test_planned_rows_touch_nothing_and_motors_hold_them(name: str) -> None:
    found = rows_of(name, poses=25, driven=4)
    assert found.rows > 25 and not found.wrong
    assert found.touching > 0.15
    assert found.on_the_way > 300 and not found.run_into
