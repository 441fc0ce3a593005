"""Zeros of joints beside a joint's frame, and a shift along an axis beside one across it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.effects import effect
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.solve.minimal_parameters import least_set
from sk120stiff.model import Model, Parameter
from tests.positions.arm import Arm, poses, tracked, write

COUNT = 60
OFF = np.array([0.0, 1.4e-3, 0.0, 0.0, 2.6e-3, 0.0])  # rad
SETTINGS = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\nmassless\n"
    "noise: {sigma: 20, unit: um}\n"
)


def test_zeros_are_named_beside_a_frame(tmp_path: Path) -> None:
    """All frames of an arm together explain a zero as well: it is a number of one of them."""
    a = poses(COUNT, 5)
    turn = np.zeros((6, 3))
    turn[3] = [0.0, 1.5e-3, -1e-3]  # across its axis x
    x = Arm(turn=turn, weighs=False).stands(a + OFF)[0]
    y = tracked(x) + 2e-5 * np.random.default_rng(1).normal(size=x.shape)
    path = write(tmp_path, a, y, SETTINGS)
    robot = sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")
    found = sk.explain(Model(robot), sk.read(path))
    assert isinstance(found, Explained)
    named = {each.effect.id for each in found.findings}
    assert {"joint_offset:j2", "joint_offset:j5", "joint_frame:j4"} == named
    for parameter in found.final.parameters:
        if parameter.effect.name == "joint_offset":
            true = OFF[int(parameter.effect.where[1:]) - 1]
            assert abs(parameter.value - true) < 4.0 * parameter.std


def test_a_shift_along_the_last_axis_does_not_stand_for_one_across_it(tmp_path: Path) -> None:
    """Along it, it is one of the marker but for the tilt that was found, here 3 mrad."""
    path = write(tmp_path, poses(6, 1), np.zeros((6, 3)), SETTINGS)
    robot = sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")
    kinds = [effect(robot, "tool_offset", "tool"), effect(robot, "joint_frame", "j6")]
    model = Model(robot) + [
        Parameter(kind, spec, 0.0, origin="here") for kind in kinds for spec in kind.parameters
    ]
    columns = np.random.default_rng(0).normal(size=(40, 9))
    columns = 100.0 * np.linalg.qr(columns)[0]
    columns[:, 3] = columns[:, 0] + 3e-3 * columns[:, 5]  # x: the marker's, and a little of z
    for order in (columns, columns[::-1]):
        few, frozen = least_set(model, order, np.ones(9))
        assert [each.name for each in frozen] == ["joint_frame:j6.x"]
        assert frozen[0].exact and frozen[0].inside == ("tool_offset:tool.offset_x",)
        assert len(few.free) == 8
    columns[:, 3] = columns[:, 0] + 0.05 * columns[:, 1] + 5.0 * np.eye(40)[:, 0]
    assert least_set(model, columns, np.ones(9))[1] == ()  # seldom seen is seen, if last
