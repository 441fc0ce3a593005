"""Joints that turn more than once: an arm stands in one posture by several numbers."""

from pathlib import Path

import numpy as np

from sk120stiff import base_model, load_robot
from sk120stiff.plan import Cell
from sk120stiff.workspace import elastic_arm, joints_along, places_of, read_path
from tests.data_checks.readings import UR5

POINT = np.array([0.03, 0.0, 0.08])


def test_no_joint_is_wound_by_a_turn_that_it_need_not_make(tmp_path: Path) -> None:
    robot = load_robot(str(UR5), base="base_link", tool="tool0")
    assert np.median(robot.upper) > 6.0  # two turns each, but for the elbow
    places = tmp_path / "places.csv"
    rows = [f"p{k},{400 + 30 * k},{-200 + 80 * k},{300 + 40 * k}" for k in range(5)]
    places.write_text("point,x[mm],y[mm],z[mm]\n" + "\n".join(rows) + "\n")
    found = places_of(places, robot, Cell(), POINT, None)
    assert len(found.a) > 10 and np.abs(found.a).max() <= np.pi + 1e-9
    path = tmp_path / "path.csv"
    lines = [f"{row.split(',', 1)[1]},180,0,0,0,0,-20" for row in rows]
    head = "x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg],fx[N],fy[N],fz[N]"
    path.write_text(head + "\n" + "\n".join(lines) + "\n")
    a = joints_along(read_path(path, robot), elastic_arm(base_model(robot), point=POINT))
    assert np.abs(a[0]).max() <= np.pi + 1e-9
    assert np.abs(np.diff(a, axis=0)).max() < 0.5 * np.pi
