"""One joint's zero that is off, by little or by much."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.model import Model
from tests.positions.arm import Arm, errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm, fit: true}\n"


@pytest.mark.parametrize(("joint", "angle"), [(1, 5.0), (2, -47.0), (3, 90.0), (4, -12.5)])
def test_a_zero_that_is_off_by_any_angle_is_told_with_what_to_write(
    tmp_path: Path, joint: int, angle: float
) -> None:
    """Beyond what a fit finds from where the file has it."""
    a = poses(40, 8)
    x = tracked(errors(2).stands(a)[0]) + 2e-5 * np.random.default_rng(1).normal(size=(40, 3))
    off = a - np.radians(angle) * np.eye(6)[joint]
    data = sk.read(write(tmp_path, off, x, FIT))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    with pytest.raises(InputError, match="With the zero of one joint elsewhere") as error:
        sk.fit(sk.base_model(robot), data)
    found = re.search(r"joints: \{j(\d): j\1 ([+-]) ([\d.]+) deg\}", error.value.remedy)
    assert found is not None, error.value.remedy
    assert int(found[1]) == joint + 1
    told = float(found[3]) * (1 if found[2] == "+" else -1)
    assert told == angle if angle == 90.0 else abs(told - angle) < 0.15


def test_a_zero_that_is_off_by_two_degrees_is_named(tmp_path: Path) -> None:
    """The way to it is curved: what is second to it is no other name."""
    a = poses(60, 9)
    arm = Arm(compliance=np.array([0.0, 1 / 6e5, 1 / 4e5, 0.0, 1 / 8e4, 0.0]))
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(1).normal(size=(60, 3))
    off = a - np.radians(2.0) * np.eye(6)[2]
    data = sk.read(write(tmp_path, off, x, FIT))
    found = sk.explain(Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Explained)
    names = {item.effect.id for item in found.findings}
    assert names == {"joint_offset:j3", "joint_springs:j2", "joint_springs:j3", "joint_springs:j5"}
    assert found.verdict == "named"
    assert 1e6 * found.steps[-1].heldout_rms < 30.0


@pytest.mark.parametrize("degrees", [0.05, 0.1])
def test_a_zero_that_is_off_by_little_is_named_by_its_one_number(
    tmp_path: Path, degrees: float
) -> None:
    """Neither by the six of a frame, nor by waves over the joint's angle."""
    a = poses(60, 13)
    arm = Arm(compliance=np.array([0.0, 1 / 6e5, 1 / 4e5, 0.0, 1 / 8e4, 0.0]))
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(2).normal(size=(60, 3))
    off = a - np.radians(degrees) * np.eye(6)[2]
    data = sk.read(write(tmp_path, off, x, FIT))
    found = sk.explain(Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Explained) and found.verdict == "named"
    names = {item.effect.id for item in found.findings}
    assert names == {"joint_offset:j3", *(f"joint_springs:j{k}" for k in (2, 3, 5))}
    (zero,) = [p for p in found.final.parameters if p.effect.name == "joint_offset"]
    assert abs(zero.internal - np.radians(degrees)) < 4.0 * zero.internal_std < 4e-4
