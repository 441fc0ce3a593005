"""What grows as it gets warmer: a link of the arm, or what the instrument or the arm stands on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import effect
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from tests.effects.arms import arm
from tests.positions.arm import TURN, Array, errors, poses, tracked, write

COUNT = 60
A = poses(COUNT, 8)
ARM = replace(errors(3), weighs=False)
WARM = 20.0 + 16.0 * np.random.default_rng(2).uniform(size=COUNT)  # degC
FIT = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm}\nmassless\n"
NOISE = "noise: {sigma: 20, unit: um}\n"


def explained(folder: Path, x: Array) -> Explained:
    """What is said of positions (60, 3) [m] of a rigid arm, read at these temperatures."""
    y = tracked(x) + 2e-5 * np.random.default_rng(3).normal(size=x.shape)
    cells = [f"{degrees:.2f}" for degrees in WARM]
    path = write(folder, A, y, FIT + NOISE, more=",temperature[degC]", cells=cells)
    robot = sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")
    found = sk.explain(sk.Model(robot), sk.read(path))
    assert isinstance(found, Explained)
    return found


def test_a_stand_that_grows_is_no_link(tmp_path: Path) -> None:
    """Upwards alike at all poses, as a tripod makes it; a short first link would have to boil."""
    up = 1.2e-5 * (WARM - WARM.mean())
    found = explained(tmp_path, ARM.stands(A)[0] + up[:, None] * [0.0, 0.0, 1.0])
    named = {each.effect.id: each for each in found.findings}
    assert "thermal_drift:tracker" in named
    assert not [name for name in named if name.startswith("thermal_growth")]
    rates = [p for p in found.final.parameters if p.effect.name == "thermal_drift"]
    for rate, true in zip(rates, TURN.apply([0.0, 0.0, 1.2e-5]), strict=True):
        assert abs(rate.value - true) < 4.0 * rate.std
        assert rate.std < 2e-6


def test_nothing_grows_where_the_temperature_changes_alone(tmp_path: Path) -> None:
    found = explained(tmp_path, ARM.stands(A)[0])
    assert not [each.effect.id for each in found.findings if each.effect.name.startswith("thermal")]


def test_a_link_grows_by_its_own_length() -> None:
    """Not by that of the arm; a plate of 1 m that is heated as the room is grows by 10 µm/K."""
    robot = arm("six_axis")
    for link in sk.CATALOGUE["thermal_growth"].places(robot):
        joint = next(j for j in sk.robot.anatomy.arm_joints(robot) if j.link == link)
        (growth,) = effect(robot, "thermal_growth", link, thermal=True).parameters
        assert growth.typical == pytest.approx(1e-5 * joint.length)
        assert growth.plausible == pytest.approx(10.0 * growth.typical)


def test_values_that_no_arm_has_come_before_all_advice(tmp_path: Path, monkeypatch) -> None:
    found = explained(tmp_path, ARM.stands(A)[0])
    assert "make sure why" not in next_step_of_positions(found)
    monkeypatch.setattr(PoseProblem, "reach", lambda self, parameter: 1e-9)
    said = next_step_of_positions(found)
    assert said.startswith("First make sure why ") and "Use model.yaml" in said.partition(": ")[2]
