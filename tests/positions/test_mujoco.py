"""Where markers stand under self-weight and payload, against MuJoCo, which reads the same URDF."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.model.pose_reading import read_poses
from tests.positions.arm import Array, urdf
from tests.positions.checks.test_bad_input import PUBLIC

HUNG = np.array([0.03, -0.02, 0.09])  # where the payload hangs, tool axes [m]
MARKER = np.array([0.05, -0.08, 0.12])
SOFT = {"ur5": 1.0 / 9e3, "panda": 1.0 / 6e3, "six": 1.0 / 3e5}  # rad/(N m)


def files(name: str, folder: Path) -> tuple[Path, str, str]:
    if name != "six":
        return PUBLIC[name]
    path = folder / "six.urdf"
    path.write_text(urdf())
    return path, "base", "tool"


class Statics:
    """A URDF in MuJoCo with springs in the joints that a robot has."""

    def __init__(self, path: Path, tool: str, joints: tuple[str, ...], mass: float) -> None:
        root = ET.parse(path).getroot()
        for link in root.iter("link"):
            for part in (*link.findall("visual"), *link.findall("collision")):
                link.remove(part)
        for name, at, m in (("seen", MARKER, 1e-9), ("hung", HUNG, max(mass, 1e-9))):
            xyz = " ".join(map(repr, map(float, at)))
            small = 'ixx="1e-12" iyy="1e-12" izz="1e-12" ixy="0" ixz="0" iyz="0"'
            root.append(ET.fromstring(
                f'<link name="{name}"><inertial><mass value="{m}"/><inertia {small}/></inertial>'
                "</link>"
            ))  # fmt: skip
            root.append(ET.fromstring(
                f'<joint name="to_{name}" type="fixed"><parent link="{tool}"/>'
                f'<child link="{name}"/><origin xyz="{xyz}"/></joint>'
            ))  # fmt: skip
        compiler = '<compiler fusestatic="false" balanceinertia="true" boundmass="1e-12"/>'
        root.append(ET.fromstring(f"<mujoco>{compiler}</mujoco>"))
        self.model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
        self.model.opt.gravity[:] = 0.0, 0.0, -9.80665
        self.data = mujoco.MjData(self.model)
        self.at = [self.model.joint(name).qposadr[0] for name in joints]
        self.of = [self.model.joint(name).dofadr[0] for name in joints]

    def seen(self, a: Array, compliance: float, base: str) -> tuple[Array, Array]:
        """Marker (3,) in axes of the base and tool axes (3, 3) where springs hold the weight."""
        q = a.copy()
        for _ in range(40):
            self.data.qpos[self.at], self.data.qvel[:] = q, 0.0
            mujoco.mj_forward(self.model, self.data)
            q = a - compliance * self.data.qfrc_bias[self.of]
        body, origin = self.data.body("seen"), self.data.body(base)
        R = origin.xmat.reshape(3, 3)
        return R.T @ (body.xpos - origin.xpos), R.T @ body.xmat.reshape(3, 3)


@pytest.mark.parametrize("name", ["ur5", "panda", "six"])
@pytest.mark.parametrize("mass", [0.0, 4.0])
def test_sag_under_weight_and_payload_is_mujocos(name: str, mass: float, tmp_path: Path) -> None:
    path, base, tool = files(name, tmp_path)
    robot = sk.load_robot(str(path), base=base, tool=tool)
    rng = np.random.default_rng(2)
    a = rng.uniform(np.maximum(robot.lower, -1.5), np.minimum(robot.upper, 1.5), (6, robot.n))
    other = Statics(path, tool, robot.actuated, mass)
    expected = [other.seen(row, SOFT[name], base) for row in a]
    header = ",".join(f"{joint}[rad]" for joint in robot.actuated) + ",x[m],y[m],z[m],payload[kg]"
    rows = [
        ",".join(f"{v!r}" for v in map(float, (*q, *x, mass)))
        for q, (x, _) in zip(a, expected, strict=True)
    ]
    data = tmp_path / "readings.csv"
    data.write_text("\n".join([header, *rows]) + "\n")
    data.with_suffix(".yaml").write_text(
        f"robot: {path}\nbase_frame: {base}\ntool_frame: {tool}\nposition: {{frame: base}}\n"
        "point: {xyz: [50, -80, 120], unit: mm}\n"
        "payload: {point: {xyz: [30, -20, 90], unit: mm}}\n"
    )
    readings = sk.read(data).with_joints(robot.actuated)
    springs = np.full(robot.n, 1.0 / SOFT[name])
    assert readings.absolute is not None
    model = sk.joint_spring_model(robot, springs).under(readings.gravity)
    found = read_poses(model, load_cases_of(robot, readings))
    stiff = robot.screws(a).frame_position + robot.screws(a).rotation @ MARKER
    sag = np.linalg.norm(found.position - stiff, axis=1)
    assert sag.max() > 1e-3
    for k, (x, R) in enumerate(expected):
        assert np.abs(found.position[k] - x).max() < 1e-9
        assert np.abs(found.rotation[k] - R).max() < 1e-9
