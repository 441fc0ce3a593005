"""A force that a sensor on the tool has read turns with the tool as the arm bends."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.effects import effect, load_case
from sk120stiff.effects.load_cases import load_cases_of
from sk120stiff.model import joint_spring_model
from sk120stiff.model.pose_reading import read_poses
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import equilibrium, linear_springs
from tests.oracles.mujoco_serial import serial_statics, springs_of
from tests.oracles.numpy_kinematics import UrdfTree, transform
from tests.oracles.sample_urdfs import six_axis_arm
from tests.positions.arm import Arm, Array, poses, write
from tests.positions.loaded_arm import rests, write_moved

SOFT = np.array([1.2e4, 1.0e4, 1.1e4, 9e3, 8e3, 6e3])  # N·m/rad, of a cobot
POINT = np.array([0.05, -0.02, 0.1])
SENSED = np.array([80.0, -60.0, 90.0, 6.0, -4.0, 5.0])  # tool axes
G = 9.80665


def test_the_equilibrium_is_that_of_bodies_whose_load_is_turned_round_by_round() -> None:
    """MuJoCo knows constant loads only: turned by the pose found, until it stays."""
    text = six_axis_arm()
    robot, tree = load_robot(text, base="base", tool="tool"), UrdfTree(text)
    for a in np.random.default_rng(3).uniform(-1.0, 1.0, (3, 6)):
        values = dict(zip(robot.actuated, a, strict=True))
        springs, tip = springs_of(
            tree, "tool", values, dict(zip(robot.actuated, SOFT, strict=True))
        )
        statics = serial_statics(springs, tip @ transform(POINT))
        R = R_0 = statics.deflection(np.zeros(6)).unloaded[:3, :3]
        for _ in range(12):
            there = statics.deflection(np.concatenate([R @ SENSED[:3], R @ SENSED[3:]]))
            R = Rotation.from_rotvec(there.rotation).as_matrix() @ R_0
        rest = equilibrium(
            robot.mechanism(), a, np.zeros(6), linear_springs(SOFT), point=POINT, follower=SENSED
        )
        assert np.abs(rest.screws.position - there.position).max() < 1e-9
        assert np.abs(rest.screws.rotation - R).max() < 1e-9
        steady = np.concatenate([R_0 @ SENSED[:3], R_0 @ SENSED[3:]])
        otherwise = equilibrium(robot.mechanism(), a, steady, linear_springs(SOFT), point=POINT)
        assert np.abs(otherwise.screws.position - there.position).max() > 1e-5


def test_newtons_method_knows_that_the_load_turns() -> None:
    """It takes no more steps than under a load that keeps its direction."""
    robot = load_robot(six_axis_arm(), base="base", tool="tool")
    a = np.random.default_rng(4).uniform(-1.0, 1.0, (20, 6))
    law, mechanism = linear_springs(SOFT), robot.mechanism()
    turning = equilibrium(mechanism, a, np.zeros(6), law, follower=SENSED)
    assert turning.iterations <= equilibrium(mechanism, a, turning.load, law).iterations
    again = equilibrium(mechanism, a, turning.load, law)
    assert np.abs(again.z - turning.z).max() < 1e-12


@pytest.fixture(scope="module")
def pulled() -> tuple[Arm, Array, Array, Array, Array]:
    """A soft arm that sags, forces as read on its tool, and where it stands under them."""
    arm, a = Arm(compliance=1.0 / (4.0 * SOFT)), poses(12, 3)
    sensed = 150.0 * np.random.default_rng(2).normal(size=(12, 3))
    R = arm.pose(a)[1]
    for _ in range(8):
        x, R = rests(arm, a, np.einsum("nij,nj->ni", R, sensed))
    return arm, a, sensed, x, R


def _springs(robot: sk.Robot) -> sk.Model:
    return joint_spring_model(robot, 4.0 * SOFT)


def test_displacements_under_forces_in_tool_axes(pulled, tmp_path: Path) -> None:
    """Beside the sag: an arm of its own kinematics and energy says where the point goes."""
    arm, a, sensed, x, R = pulled
    x_0, R_0 = rests(arm, a, np.zeros_like(sensed))
    marker = np.array([0.05, -0.08, 0.12])
    d = x - x_0 + np.einsum("nij,j->ni", R - R_0, marker)
    columns = {f"d{axis}[mm]": 1e3 * d[:, k] for k, axis in enumerate("xyz")}
    settings = "point: {xyz: [50, -80, 120], unit: mm}\n"
    path = write_moved(tmp_path, a, sensed, columns, settings, weighs=True)
    rules = path.with_suffix(".yaml")
    rules.write_text(rules.read_text().replace("{frame: base", "{frame: tool"))
    data = sk.read(path)
    model = _springs(sk.load_robot(data.robot, base="base", tool="tool"))
    cases = load_cases_of(model.robot, data)
    assert np.abs(model.predict(cases) - d).max() < 2e-8
    assert np.abs(model.predict(replace(cases, follows=False)) - d).max() > 1e-4


def test_positions_under_forces_in_tool_axes_and_a_payload(pulled, tmp_path: Path) -> None:
    """The mass pulls straight down, however the tool turns; the force turns with it."""
    arm, a, sensed, _, _ = pulled
    mass, R = np.linspace(0.0, 12.0, 12), arm.pose(a)[1]
    down = -G * mass[:, None] * [0.0, 0.0, 1.0]
    for _ in range(8):
        x, R = rests(arm, a, np.einsum("nij,nj->ni", R, sensed) + down)
    marker = np.array([0.0, 0.0, 0.1])
    cells = [",".join(f"{v:.12g}" for v in row) for row in np.column_stack([mass, sensed])]
    place = "point: {xyz: [0, 0, 100], unit: mm}"
    settings = f"{place}\nforce: {{frame: tool}}\npayload: {{{place}}}\n"
    more = ",payload[kg],fx[N],fy[N],fz[N]"
    x = x + np.einsum("nij,j->ni", R, marker)
    path = write(tmp_path, a, x, settings, more=more, cells=cells)
    data = sk.read(path)
    model = _springs(sk.load_robot(data.robot, base="base", tool="tool"))
    cases = load_cases_of(model.robot, data)
    seen = read_poses(model, cases)
    assert np.abs(seen.position - x).max() < 2e-8
    assert np.abs(seen.rotation - R).max() < 2e-8
    heavier = model + effect(model.robot, "payload")
    more_mass = heavier.with_public(**{"payload:tool.mass": 3.0})
    stated = replace(data, absolute=replace(data.absolute, payload=data.absolute.payload + 3.0))
    theirs = read_poses(model, load_cases_of(model.robot, stated)).position
    ours = read_poses(more_mass, cases).position
    assert np.abs(ours - theirs).max() < 1e-12


def test_the_sensor_misreads_in_axes_of_the_bent_tool() -> None:
    """An offset that is known is as good as none."""
    robot = load_robot(six_axis_arm(), base="base", tool="tool")
    a = np.random.default_rng(5).uniform(-1.0, 1.0, (6, 6))
    R, offset = robot.screws(a).rotation, np.array([4.0, -7.0, 5.0])

    def read(force: Array) -> sk.Model:
        wrench = np.concatenate([R @ force, np.zeros((6, 3))], axis=1)
        return replace(load_case(robot, a, wrench), follows=True)

    model = joint_spring_model(robot, SOFT)
    off = (model + effect(robot, "force_bias")).with_public(
        **{f"force_bias:sensor.offset_{x}": v for x, v in zip("xyz", offset, strict=True)}
    )
    true = np.array([80.0, -60.0, 90.0])
    assert np.abs(off.predict(read(true + offset)) - model.predict(read(true))).max() < 1e-13
