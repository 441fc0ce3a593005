"""What positions could not show, and the poses that tell: both hold when it is tried."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.findings import likely
from sk120stiff.explain.options import Options
from sk120stiff.explain.positions.advise.other_poses import elsewhere, never_told, next_poses
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.explain.positions.select.choose import choose
from sk120stiff.model import Model
from sk120stiff.plan import Cell, feasible
from tests.positions.arm import Arm, Array, errors, poses, tracked, write
from tests.positions.test_forms import _with

SIGMA = 2e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"


def explained(
    tmp_path: Path, a: Array, x: Array, settings: str = FIT + NOISE, **columns: Any
) -> Explained:
    noise = SIGMA * np.random.default_rng(7).normal(size=x.shape)
    data = sk.read(write(tmp_path, a, tracked(x) + noise, settings, **columns))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return explain_positions(Model(robot), data.with_joints(robot.actuated))


def test_sizes_told_as_detectable_bring_a_name_and_smaller_ones_do_not(tmp_path: Path) -> None:
    a = poses(60, 1)
    found = explained(tmp_path, a, Arm().stands(a)[0])
    assert found.verdict == "none"
    smallest = {item.name: item.value for item in found.smallest}
    linear, rng = found.linear, np.random.default_rng(2)
    ids = [effect.id for effect in linear.candidates]
    tried = {1.0: [0, 0], 0.4: [0, 0]}
    for name, wave in (
        ("joint_coupling:j2,j3", "ratio"), ("transmission_error:j3", "sin_2"),
        ("joint_springs:j2", "stiffness"), ("joint_frame:j3", "x"),
    ):  # fmt: skip
        e = ids.index(name)
        effect = linear.candidates[e]
        k = [spec.name for spec in effect.parameters].index(wave)
        own = linear.slices[e].start + k
        spec, column = effect.parameters[k], linear.columns[:, own]
        size = spec.internal(smallest[f"{name}.{wave}"]) / linear.sizes[own]
        for share, counts in tried.items():
            for _ in range(8):
                noise = rng.normal(size=len(linear.residual))
                noise -= linear.base @ (linear.base.T @ noise)
                picked = choose(replace(linear, residual=noise + share * size * column))
                counts[0] += bool(picked.order)  # its own name, or what explains as much
                counts[1] += 1
    named, count = tried[1.0]
    assert 0.55 <= named / count <= 0.97, tried
    assert tried[0.4][0] <= 0.15 * count


def _place(found: Explained, name: str) -> int:
    return [effect.id for effect in found.linear.candidates].index(name)


def test_a_spring_and_the_torsion_of_a_link_along_its_axis_are_one(tmp_path: Path) -> None:
    """No pose tells them apart: the name is settled, says so, and asks for no readings."""
    a = poses(60, 4)
    arm = _with([0.05, -0.4, 0.12], (60.0, np.array([0.0, 0.4, 0.1])))
    arm.compliance = np.array([0, 1 / 6e5, 0, 0, 0, 1 / 5e5])
    arm.shift, arm.turn = np.zeros((6, 3)), np.zeros((6, 3))
    settings = FIT + NOISE + "payload: {point: {xyz: [0, 400, 100], unit: mm}}\n"
    found = explained(
        tmp_path, a, arm.stands(a)[0], settings, more=",payload[kg]", cells=["60"] * len(a)
    )
    told = {item.effect.id: item for item in found.findings}
    assert found.verdict == "named" and set(told) == {"joint_springs:j2", "joint_springs:j6"}
    item = told["joint_springs:j6"]
    assert "link_torsion:l5" in item.exact and item.kind_of("link_torsion:l5") == "always the same"
    assert item.settled and item.others == () and found.following is None
    own, together = found.chance_of(item).split("; it or one of those not told from it: ")
    names = item.effect.id, *item.exact
    assert together == "P > 0.99" and own == likely(found.probabilities[names[0]])
    chances = [found.probabilities[name] for name in names]  # both may be at work, if seldom
    assert max(chances) <= item.probability + 1e-9
    assert item.probability - 1e-9 <= sum(chances) < item.probability + 0.05
    effects = found.save(tmp_path / "out")["effects"]
    assert effects[1]["exact_aliases"] == list(item.exact) == effects[1]["alternatives"]
    assert "Always the same in such readings: " in found.report().html()
    spring, torsion, bending = (
        found.linear.candidates[_place(found, name)]
        for name in ("joint_springs:j6", "link_torsion:l5", "link_bending:l3")
    )
    there = elsewhere(found.final, Options())
    assert there is not None
    assert never_told(found.final, there, spring, [bending, torsion]) == ("link_torsion:l5",)
    assert next_poses(found.final, there, [(spring, torsion)]) is None


def test_next_poses_tell_what_the_first_ones_left_open(tmp_path: Path) -> None:
    """Joints 3 to 6 hardly move: the weight's torque on joint 2 goes with its angle alone."""
    arm = Arm(compliance=np.array([0, 1 / 6e5, 0, 0, 0, 0]))
    a = poses(60, 3)
    a[:, 2:] = 1.2 + 0.01 * (a[:, 2:] - a[:, 2:].mean(axis=0))
    first = explained(tmp_path, a, arm.stands(a)[0])
    assert first.verdict == "ambiguous" and first.following is not None
    following = first.following
    assert following.before < 3.3 < 6.0 < following.after, following
    both = [item for item in first.findings if item.alternatives]
    names = {both[0].effect.id, *both[0].alternatives}
    assert set(following.between) <= names and "joint_springs:j2" in names
    shares = [first.probabilities[name] for name in names if name in first.probabilities]
    assert max(shares) <= 1.0 and 1.0 - 1e-6 < sum(shares) < 1.01  # both may be at work
    pair = [first.linear.candidates[_place(first, name)] for name in following.between]
    first.save(tmp_path / "out")
    back = sk.read(tmp_path / "out" / "next_poses.csv")  # the YAML file beside it says whose
    np.testing.assert_allclose(back.joints, following.readings.joints, atol=1e-12)
    assert back.is_plan and back.robot == first.readings.robot and back.tool_frame == "tool"
    assert back.absolute is not None and back.absolute.frame == "unknown"
    assert back.absolute.fit_point and "joint_springs:j2" in back.source
    robot, cell = first.final.model.robot, Cell(low=np.array([0.5, -1.0, 0.5]))
    there = elsewhere(first.final, Options(cell=cell))
    assert there is not None and never_told(first.final, there, pair[0], pair[1:]) == ()
    apart = next_poses(first.final, there, [(pair[0], pair[1])])
    assert apart is not None and not feasible(robot, cell, following.readings.joints).ok.all()
    assert feasible(robot, cell, apart.readings.joints).ok.all()
    a = np.concatenate([a, following.readings.joints])
    second = explained(tmp_path, a, arm.stands(a)[0])
    told = [(item.effect.id, item.alternatives) for item in second.findings]
    assert told == [("joint_springs:j2", ())]
    assert not second.final.wild.any(), "rows far off a rigid arm are not wild beside the spring"


def test_a_payload_that_nobody_stated_is_named_from_a_rigid_start(tmp_path: Path) -> None:
    """A load bends nothing that is rigid: it shows only beside springs that were named before."""
    a = poses(70, 5)
    arm = _with(payload=(30.0, np.array([0.0, 0.0, 0.12])))
    found = explained(tmp_path, a, arm.stands(a)[0])
    ids = {item.effect.id for item in found.findings}
    assert "payload:tool" in ids, ids
    assert {"joint_springs:j2", "joint_springs:j3"} < ids, ids  # it acts through them alone
    assert found.final.rms < 2.0 * SIGMA


def test_play_under_weight_is_named(tmp_path: Path) -> None:
    arm = errors(3)
    arm.compliance, arm.play = np.zeros(6), np.array([0, 0, 2e-4, 0, 0, 0])
    a = poses(90, 8)
    found = explained(tmp_path, a, arm.stands(a)[0])
    names = [item.effect.id for item in found.findings if item.effect.name != "joint_frame"]
    assert names == ["lost_motion:j3"]
    half = found.final.model.parameter("lost_motion:j3.half_width")
    assert half.value == pytest.approx(2e-4, abs=4.0 * half.std)


def test_play_whose_teeth_take_hold_gradually_is_named_with_its_law(tmp_path: Path) -> None:
    """Beside the law that jumps the spring comes out an eighth too soft, and sure of it."""
    arm = errors(3)
    arm.compliance, arm.play = np.zeros(6), np.array([0, 0, 3e-4, 0, 0, 0])
    arm.compliance[2] = 1 / 5e5
    arm.flank = 20.0
    a = poses(90, 8)
    found = explained(tmp_path, a, arm.stands(a)[0])
    (law,) = [item.effect for item in found.findings if item.effect.name == "lost_motion"]
    assert all("_flank_" in spec.name for spec in law.parameters)
    spring = found.final.model.parameter("joint_springs:j3.stiffness")
    assert spring.value == pytest.approx(5e5, abs=2.0 * spring.std) and spring.std < 4e4


def test_a_gear_that_hardens_under_weight_and_payload_is_no_wave(tmp_path: Path) -> None:
    """Nor is its spring named before it: each alone is hidden by the waves of that joint."""
    mass = np.where(np.arange(70) % 2, 80.0, 0.0)
    arm = _with(payload=(mass, np.zeros(3)))  # type: ignore[arg-type]
    arm.hardens[1] = 6e-10
    a = poses(70, 8)
    x = tracked(arm.stands(a)[0]) + SIGMA * np.random.default_rng(7).normal(size=(70, 3))
    path = write(tmp_path, a, x, FIT + NOISE, more=",payload[kg]", cells=[f"{m:g}" for m in mass])
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = explain_positions(Model(robot), data.with_joints(robot.actuated))
    ids = {item.effect.id for item in found.findings}
    assert {"gear_hardening:j2", "joint_springs:j2"} <= ids, ids
    assert not any(name.startswith("transmission_error") for name in ids), ids
    model = found.final.model
    bends = model.parameter("gear_hardening:j2.quadratic")
    assert bends.value == pytest.approx(6e-10, abs=3.0 * bends.std) and bends.std < 6e-11
    spring = model.parameter("joint_springs:j2.stiffness")
    assert spring.value == pytest.approx(8e5, abs=3.0 * spring.std) and spring.std < 3e4
