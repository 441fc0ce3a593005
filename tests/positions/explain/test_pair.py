"""A tilting bearing against a bent link: positions leave it open, the tool's turn settles it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain import Options
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.model import Model
from tests.positions.arm import ORIGINS, TOOL, Array, tracked, urdf
from tests.positions.arm import TURN as TRACKER

COUNT, PULL, SOFT = 60, 300.0, 1.0 / 2e6  # poses, N, rad/(N m)
MARKER = np.array([0.05, -0.08, 0.12])
PAIR = ("joint_tilt:j2", "link_bending:l2")


def pulled() -> tuple[Array, Array, Array, Array]:
    """Joints, forces, markers and tool axes of an arm that does nothing but tilt in joint 2.

    The first two joints move, so beyond the upper arm all is one body. The bearing gives way about
    the axis across joint axis and link: a hinge at the shoulder, by the moment of the pull there.
    """
    rng = np.random.default_rng(4)
    a = np.zeros((COUNT, 6))
    a[:, 0], a[:, 1] = rng.uniform(-1.5, 1.5, COUNT), rng.uniform(-0.7, 0.8, COUNT)
    force, x, axes = np.zeros((COUNT, 3)), np.zeros((COUNT, 3)), np.zeros((COUNT, 3, 3))
    reach = ORIGINS[2] + ORIGINS[3] + ORIGINS[4] + ORIGINS[5] + TOOL + MARKER
    for k, (first, second) in enumerate(a[:, :2]):
        base = _turn(np.array([0.0, 0, first]))
        R = base @ _turn(np.array([0.0, second, 0]))
        shoulder = ORIGINS[0] + base @ ORIGINS[1]
        way = R[:, 1]  # along the joint's axis: sideways
        force[k] = PULL * rng.choice([-1.0, 0.0, 1.0]) * way
        tilt = np.zeros(3)
        for _ in range(30):
            bent = R @ _turn(tilt)
            moment = R.T @ np.cross(bent @ reach, force[k])
            tilt = np.array([SOFT * moment[0], 0.0, 0.0])
        bent = R @ _turn(tilt)
        x[k], axes[k] = shoulder + bent @ reach, bent
    return a, force, x, axes


def _turn(vector: Array) -> Array:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def explained(tmp_path: Path, rotations: bool) -> Explained:
    from scipy.spatial.transform import Rotation

    a, force, x, axes = pulled()
    rng = np.random.default_rng(5)
    seen = tracked(x) + 2e-5 * rng.normal(size=x.shape)
    turned = Rotation.from_rotvec(2e-5 * rng.normal(size=x.shape)) * Rotation.from_matrix(
        TRACKER.as_matrix() @ axes
    )
    header = [f"j{k}[rad]" for k in range(1, 7)] + ["fx[N]", "fy[N]", "fz[N]"]
    header += ["x[m]", "y[m]", "z[m]"]
    table = np.column_stack([a, force, seen])
    if rotations:
        header += ["rx[rad]", "ry[rad]", "rz[rad]"]
        table = np.column_stack([table, turned.as_rotvec()])
    path = tmp_path / "readings.csv"
    lines = [",".join(f"{v:.12g}" for v in row) for row in table]
    path.write_text("\n".join([",".join(header), *lines]) + "\n")
    (tmp_path / "six.urdf").write_text(urdf(weighs=False))
    path.with_suffix(".yaml").write_text(
        "robot: six.urdf\nbase_frame: base\ntool_frame: tool\nposition: {frame: unknown}\n"
        "point: {xyz: [50, -80, 120], unit: mm}\nforce: {frame: base}\n"
        "noise: {sigma: 20, unit: um, rotation: 20, rotation_unit: urad}\n"
    )
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return explain_positions(
        Model(robot), data.with_joints(robot.actuated), options=Options(only=PAIR)
    )


@pytest.mark.parametrize("rotations", [False, True])
def test_the_turn_of_the_tool_settles_what_positions_leave_open(
    rotations: bool, tmp_path: Path
) -> None:
    found = explained(tmp_path, rotations)
    (named,) = found.findings
    if rotations:
        assert (named.effect.id, named.alternatives) == (PAIR[0], ())
    else:
        assert found.verdict == "ambiguous"
        assert {named.effect.id, *named.alternatives} == set(PAIR)
