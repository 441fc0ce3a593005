"""Frames that are off and in no model: they enter the standard errors, and get no other's name."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain import Options
from sk120stiff.explain.positions.select.candidates import linear_at
from sk120stiff.explain.positions.select.choose import choose
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.omitted.nuisances import _with_left_out
from sk120stiff.model import Model, Parameter
from tests.positions.arm import Arm, Array, errors, poses, tracked, write

SIGMA = 2e-6
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
A = poses(60, 6)


def test_a_marker_mounted_anew_on_a_turned_last_frame(tmp_path: Path) -> None:
    """A shift of 20 mm in axes that are 1 mrad off misses by 20 µm, far beyond the noise."""
    arm = errors(4)
    arm.turn *= 4.0
    moved = replace(arm, marker=arm.marker + [0.0, 0.02, 0.0])
    late = np.arange(60) >= 30
    x = np.where(late[:, None], moved.stands(A)[0], arm.stands(A)[0])
    x = tracked(x) + SIGMA * np.random.default_rng(2).normal(size=x.shape)
    series = ["two" if k else "one" for k in late]
    data = sk.read(
        write(tmp_path, A, x, FIT + "noise: {sigma: 2, unit: um}\n", more=",series", cells=series)
    )
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings = data.with_joints(robot.actuated)
    found = calibrate(sk.base_model(robot), readings, waves=False)
    shift = [found.model.parameter(f"marker_shift:tool.two.{axis}") for axis in "xyz"]
    off = np.array([p.value for p in shift]) - [0.0, 0.02, 0.0]
    std = np.array([p.std for p in shift], dtype=float)
    assert np.abs(off).max() > 10.0 * SIGMA
    assert (np.abs(off) < 3.0 * std).all() and std.max() < 2e-4, (off, std)
    intervals = dict(zip((p.name for p in found.parameters), found.intervals(), strict=True))
    half = [0.5 * float(np.ptp(intervals[p.name])) for p in shift]
    np.testing.assert_allclose(half, 1.96 * std, rtol=0.01)


def test_a_spring_that_is_left_out_is_in_the_errors_of_the_others(tmp_path: Path) -> None:
    """Without the third joint's the second one comes out 6 % too soft, in a noise of 2 µm."""
    arm = errors(4)
    x = tracked(arm.stands(A)[0]) + SIGMA * np.random.default_rng(2).normal(size=(60, 3))
    data = sk.read(write(tmp_path, A, x, FIT + "noise: {sigma: 2, unit: um}\n"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings, whole = data.with_joints(robot.actuated), sk.base_model(robot)
    short = whole.without("joint_springs:j3")
    for model, low, high in ((whole, 0.0, 0.003), (short, 0.05, 0.1)):
        found = calibrate(model, readings, waves=False).model
        spring = found.parameter("joint_springs:j2.stiffness")
        assert abs(spring.internal - 1 / 8e5) < 2.0 * spring.internal_std
        assert low < spring.internal_std * 8e5 < high


def test_frames_that_are_turned_alone_are_left_out_at_the_other_joints(tmp_path: Path) -> None:
    """Where a model knows of no shift, frames that it lacks may be turned all the same."""
    data = sk.read(write(tmp_path, A, tracked(Arm().stands(A)[0]), FIT))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    frame = sk.effect(robot, "joint_frame", "j2")
    model = Model(robot) + [
        Parameter(frame, spec, 3e-4, free=spec.unit == "rad") for spec in frame.parameters
    ]
    wide, sizes = _with_left_out(model, sk.CATALOGUE)
    others = {wide.parameters[k].name for k in sizes}
    assert others == {f"joint_frame:j{k}.r{axis}" for k in (1, 3, 4, 5, 6) for axis in "xyz"}


def test_small_errors_of_all_frames_get_no_other_name(tmp_path: Path) -> None:
    """Each too small to ask for six parameters, together like an arm that is longer."""
    x = tracked(Arm().stands(A)[0])
    x = x + 2e-5 * np.random.default_rng(5).normal(size=x.shape)
    data = sk.read(write(tmp_path, A, x, FIT + "noise: {sigma: 20, unit: um}\n"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings = data.with_joints(robot.actuated)
    base = calibrate(Model(robot), readings, geometry=False, waves=False)
    wish = Options(exclude=("joint_springs", "joint_tilt", "link_bending", "link_torsion"))
    linear, _ = linear_at(base, wish, sk.CATALOGUE)
    rng = np.random.default_rng(3)
    frames = [e for e, effect in enumerate(linear.candidates) if effect.name == "joint_frame"]
    named: list[str] = []
    for _ in range(12):
        residual = rng.normal(size=len(linear.residual))
        residual -= linear.base @ (linear.base.T @ residual)
        for e in frames:
            own, count = linear.slices[e], len(linear.candidates[e].parameters)
            unit = np.where(np.arange(count) < 3, 4e-5, 6e-5) / linear.sizes[own]
            residual += linear.columns[:, own] @ (unit * rng.normal(size=count))
        found = choose(replace(linear, residual=residual))
        named += [linear.candidates[e].name for e in found.order]
    assert named.count("joint_frame") > 12
    assert set(named) == {"joint_frame"}, named


def test_waves_that_few_poses_cannot_show_are_in_the_errors_of_springs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """20 poses, gears with waves of 0.1 mrad: too few to let 24 unknowns in, enough to be misled.

    Exact gears cost nothing at 60 poses: the readings exclude waves there.
    """
    off: dict[bool, list[float]] = {True: [], False: []}
    for seed in (1, 3, 6):
        arm, a = errors(seed), poses(20, 500 + seed)
        arm.waves = 1e-4 * np.random.default_rng(seed).normal(size=(6, 2))
        for told, own in off.items():
            found = spring(tmp_path, arm, a, 900 + seed, told=told, patch=monkeypatch)
            own.append((found.internal - 1 / 8e5) / found.internal_std)
    size = {told: float(np.abs(own).max()) for told, own in off.items()}
    assert size[True] < 2.0 and size[False] > 4.0, off
    std = [
        spring(tmp_path, errors(1), poses(60, 8), 1, told=told, patch=monkeypatch).internal_std
        for told in off
    ]
    assert std[0] == pytest.approx(std[1], rel=0.05)


def spring(
    folder: Path, arm: Arm, a: Array, seed: int, *, told: bool, patch: pytest.MonkeyPatch
) -> Parameter:
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(seed).normal(size=a[:, :3].shape)
    data = sk.read(write(folder, a, x, FIT + "noise: {sigma: 20, unit: um}\n"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    with patch.context() as at:
        if not told:
            at.setattr(sys.modules[calibrate.__module__], "beside_waves", lambda fit, _: fit)
        found = calibrate(sk.base_model(robot), data.with_joints(robot.actuated))
    return found.model.parameter("joint_springs:j2.stiffness")
