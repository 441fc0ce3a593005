"""Springs of like axes under like torques: that one has what may be another's is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.identify.positions.checks.acting_alike import acting_alike
from tests.positions.arm import Arm, Array, errors, poses, tracked, write

SETTINGS = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 20, unit: um}\n"
)


def told(folder: Path, arm: Arm, a: Array) -> list[str]:
    noise = 2e-5 * np.random.default_rng(1).normal(size=(len(a), 3))
    data = sk.read(write(folder, a, tracked(arm.stands(a)[0]) + noise, SETTINGS))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = sk.fit(sk.joint_spring_model(robot), data.with_joints(robot.actuated))
    return acting_alike(found)


def test_where_two_joints_move_like_drives_are_told(tmp_path: Path) -> None:
    """Only j1 and j2 move: what is beyond j3 weighs on it as on j2, poses do not tell which."""
    a = np.zeros((24, 6))
    a[:, 0], a[:, 1] = np.linspace(-1, 1, 24), np.tile(np.linspace(-1.2, 0.6, 8), 3)
    a[:, 2], a[:, 4] = 0.4, 0.5
    (said,) = told(tmp_path, Arm(compliance=np.array([0, 2e-6, 0, 0, 0, 0])), a)
    assert said.startswith("joint_springs:j2.stiffness does here what joint_springs:j3.stiffness")
    assert "Move the joints between them" in said


def test_where_all_move_none_are(tmp_path: Path) -> None:
    assert told(tmp_path, errors(3), poses(60, 2)) == []
