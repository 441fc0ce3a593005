"""What is said not to be told: a test that tries to tell it, and fails as was said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.words import NO_TORQUE, SHARED, unseen
from sk120stiff.model import Model
from tests.positions.arm import NAMES, Arm, Array, errors, poses, tracked, write

SIGMA = 3e-5
FIT = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 30, unit: um}\n"
)


def calibrated(tmp_path: Path, arm: Arm, a: Array, *, geometry: bool = True) -> Calibration:
    x = tracked(arm.stands(a)[0])
    x = x + SIGMA * np.random.default_rng(3).normal(size=x.shape)
    data = sk.read(write(tmp_path, a, x, FIT))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return calibrate(sk.base_model(robot), data.with_joints(robot.actuated), geometry=geometry)


def test_errors_of_geometry_that_are_frozen_leave_nothing_if_they_are_there(
    tmp_path: Path,
) -> None:
    """Half a millimetre and half a milliradian in every one of them: the fit is as good."""
    arm, a = errors(5), poses(60, 1)
    a[:, 4] = 0.3  # joint 5 never moves
    first = calibrated(tmp_path, arm, a)
    frozen = [item.name for item in first.frozen if item.name.startswith("joint_frame")]
    assert len(frozen) > 15 and first.still == ("j5",)
    shift, turn = arm.shift.copy(), arm.turn.copy()
    rng = np.random.default_rng(2)
    for name in frozen:
        where, _, what = name.removeprefix("joint_frame:").partition(".")
        error = 5e-4 * rng.choice([-1.0, 1.0])
        (turn if what[0] == "r" else shift)[NAMES.index(where), "xyz".index(what[-1])] += error
    again = calibrated(tmp_path, replace(arm, shift=shift, turn=turn), a)
    moved = arm.stands(a)[0] - replace(arm, shift=shift, turn=turn).stands(a)[0]
    assert np.abs(moved).max() > 30.0 * SIGMA
    assert again.misfit[2] > 1e-3
    assert abs(again.chi_square - first.chi_square) < 0.1 * first.chi_square


def test_errors_of_geometry_that_are_not_frozen_are_missed_if_left_out(tmp_path: Path) -> None:
    """So the test before could have failed."""
    arm, a = errors(5), poses(60, 1)
    assert calibrated(tmp_path, arm, a).misfit[2] > 1e-3
    assert calibrated(tmp_path, arm, a, geometry=False).misfit[2] < 1e-9


def test_springs_that_cannot_be_seen_may_be_anything(tmp_path: Path) -> None:
    arm, a = errors(1), poses(60, 11)
    first = calibrated(tmp_path, arm, a)
    reasons = unseen(first)
    assert reasons["joint_springs:j1.stiffness"] in (NO_TORQUE, SHARED)
    compliance = arm.compliance.copy()
    for name in reasons:
        compliance[NAMES.index(name.split(":")[1].split(".")[0])] *= 5.0
    again = calibrated(tmp_path, replace(arm, compliance=compliance), a)
    assert again.misfit[2] > 1e-3
    for k in (1, 2):
        name = f"joint_springs:j{k + 1}.stiffness"
        p = again.model.parameter(name)
        assert abs(p.internal - arm.compliance[k]) < 4.0 * p.internal_std


def test_candidates_that_do_not_show_leave_nothing_if_they_are_there(tmp_path: Path) -> None:
    """A rigid arm's payload: whatever hangs on it, the positions are the same."""
    a = poses(40, 4)
    x = tracked(Arm().stands(a)[0])
    data = sk.read(write(tmp_path, a, x + SIGMA * np.random.default_rng(5).normal(size=x.shape),
                         FIT))  # fmt: skip
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = explain_positions(Model(robot), data.with_joints(robot.actuated))
    assert found.verdict == "none" and "payload:tool" in found.hidden
    model = found.final.model
    effect = sk.CATALOGUE.effect(robot, "payload", "tool")
    loaded = model + effect
    heavy = loaded.values.copy()
    heavy[len(model.parameters)] = 50.0
    problem = replace(found.final.problem, model=loaded)
    gap, same = (problem.channel_gap(v)[0] for v in (heavy, loaded.values))
    assert np.abs(gap - same).max() < 1e-12
