"""What each effect moves the marker by, against an arm that has that effect alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.effects import Mounting, Viewpoint
from sk120stiff.explain.positions.judge.budget import budget_of
from sk120stiff.identify.positions.calibrate import calibrate
from tests.positions.arm import errors, poses, tracked, write

SETTINGS = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 5, unit: um}\n"
)


def test_sag_of_each_joint(tmp_path: Path) -> None:
    """Without one spring the marker stands elsewhere by what the budget says."""
    a, arm = poses(80, 2), errors(1)
    x = arm.stands(a)[0] + 5e-6 * np.random.default_rng(0).normal(size=(80, 3))
    read = sk.read(write(tmp_path, a, tracked(x), SETTINGS))
    robot = sk.load_robot(read.robot, base="base", tool="tool")
    found = calibrate(sk.base_model(robot), read.with_joints(robot.actuated))
    effects, joints = budget_of(found)
    said = {share.name: share for share in effects}
    for k in (1, 2):
        without = replace(arm, compliance=arm.compliance * (np.arange(6) != k))
        moved = arm.stands(a)[0] - without.stands(a)[0]
        share = said[f"joint_springs:j{k + 1}"]
        assert share.std is not None and share.std < 0.1 * share.rms
        assert abs(share.rms - np.sqrt(np.mean(moved**2))) < 3.0 * share.std + 0.01 * share.rms
    named = {share.name for share in effects}
    away = (Viewpoint, Mounting)
    assert not any(e.id in named for e in found.model.effects if isinstance(e, away))
    assert "tool_offset:tool" not in named and any(n.startswith("joint_frame") for n in named)
    assert {share.name for share in joints} <= set(robot.actuated)


def test_angles_alone_have_none(tmp_path: Path) -> None:
    a = poses(40, 3)
    _, axes = errors(2).stands(a)
    level = np.degrees(np.arcsin(axes[:, 2, 0]))
    cells = [f"{v:.9f},1,0,0" for v in level]
    path = write(tmp_path, a, np.full((40, 3), np.nan), "", more=",inc[deg],vx,vy,vz", cells=cells)
    text = path.read_text()
    path.write_text(text.replace(",x[mm],y[mm],z[mm]", "").replace(",,,,", ","))
    read = sk.read(path)
    robot = sk.load_robot(read.robot, base="base", tool="tool")
    assert budget_of(calibrate(sk.base_model(robot), read.with_joints(robot.actuated))) == ((), ())
