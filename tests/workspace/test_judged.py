"""A corrected path as a model judges it, in the axes of the path."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.workspace import Judged, compensate, read_path, standing_uncertainty


def test_a_path_is_judged_in_its_own_axes(tmp_path: Path) -> None:
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    names = ",".join(f"{name}[deg]" for name in model.robot.actuated)
    file, back = tmp_path / "path.csv", tmp_path / "back.csv"
    file.write_text(f"point,{names},fx[N],fy[N],fz[N]\nA,0,10,-20,0,-50,0,0,0,-490\n")
    path = read_path(file, model.robot)
    assert path.joints is not None
    found = compensate(model, path.joints, path.wrench)
    part = np.eye(4)
    part[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    part[:3, 3] = [0.5, 0.0, -0.2]
    down = 1e3 * (found.before.away[0] @ part[:3, :3])
    back.write_text(
        "point,run,dx[mm],dy[mm],dz[mm]\nA,before," + ",".join(f"{x:.9f}" for x in down) + "\n"
    )
    judged = Judged(
        path, model, path.joints, None, part, found.before, found.after,
        standing_uncertainty(model, found.a, path.wrench), back,
    )  # fmt: skip
    place = model.robot.placement(path.joints)[:, :3, 3]
    np.testing.assert_allclose(judged.meant @ part[:3, :3].T + part[:3, 3], place)
    (before,) = judged.returned
    assert judged.off_prediction(before) < 1e-9 < found.before.distance[0]
    assert judged.uncertainty is None and judged.budgets[0]


def test_loads_of_the_tool_are_turned_into_base_axes(tmp_path: Path) -> None:
    robot = sk.load_robot("motoman_sk120")
    names = ",".join(f"{name}[deg]" for name in robot.actuated)
    file = tmp_path / "path.csv"
    file.write_text(f"{names},fx[N],fy[N],fz[N]\n0,10,-20,0,-50,0,0,0,100\n")
    path = read_path(file, robot)
    assert path.joints is not None
    along = robot.placement(path.joints)[0, :3, 2]
    turned = path.turned_to_base(robot, path.joints, None)
    np.testing.assert_allclose(turned.wrench[0], [*(100.0 * along), 0.0, 0.0, 0.0], atol=1e-9)
