"""What is missing is named from positions alone; what is not there is not."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects.foundation import BaseRocking
from sk120stiff.explain import Options
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.judge.laws import as_fitted, by_best_laws, laws_at
from sk120stiff.explain.positions.judge.settled import Campaign
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.explain.positions.select.candidates import linear_at
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.model import Model
from tests.positions.arm import Arm, Array, errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
RNG = np.random.default_rng(12)


def explained(tmp_path: Path, arm: Arm, a: Array, seed: int) -> Explained:
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(seed).normal(size=(len(a), 3))
    data = sk.read(write(tmp_path, a, x, FIT + NOISE))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return explain_positions(Model(robot), data.with_joints(robot.actuated))


def test_geometry_alone_gets_no_elastic_name(tmp_path: Path) -> None:
    for seed in (1, 2):
        arm = errors(seed)
        arm.compliance = np.zeros(6)
        found = explained(tmp_path, arm, poses(90, 30 + seed), seed)
        families = set(found.families)
        assert families == {"geometry"}, [item.effect.id for item in found.findings]
        assert found.chance > 1e-3
        assert found.steps[-1].heldout_rms < 0.1 * found.steps[0].heldout_rms
        assert found.steps[-1].heldout_rms < 2.6e-5


def test_soft_joints_are_named_beside_geometry(tmp_path: Path) -> None:
    found = explained(tmp_path, errors(4), poses(90, 41), 4)
    named = {item.effect.id for item in found.findings}
    alternatives = {
        name for item in found.findings for name in (item.effect.id, *item.alternatives)
    }
    assert {"joint_springs:j2", "joint_springs:j3"} <= alternatives
    assert any(name.startswith("joint_frame") for name in named)
    assert found.chance > 1e-3 and found.remainder[0] < 1e-5
    spring = found.final.model.parameter("joint_springs:j2.stiffness")
    assert abs(spring.internal - 1 / 8e5) < 4.0 * spring.internal_std


def test_nothing_missing_is_nothing_named(tmp_path: Path) -> None:
    found = explained(tmp_path, Arm(), poses(60, 50), 5)
    assert found.verdict == "none" and not found.findings


def test_what_hides_what_at_poses_left_out_is_confirmed_together(tmp_path: Path) -> None:
    """One axis a row: 60 numbers. One by one the frames are not confirmed, all of them are."""
    a, arm, rng = poses(60, 42), errors(1), np.random.default_rng(1)
    arm.shift *= 2.0
    arm.turn *= 2.0
    x = arm.stands(a)[0]
    x = x + 2e-5 * rng.normal(size=x.shape)
    x[np.arange(60)[:, None] % 3 != np.arange(3)] = np.nan
    data = sk.read(write(tmp_path, a, x, FIT.replace("unknown", "base") + NOISE))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = explain_positions(Model(robot), data.with_joints(robot.actuated))
    assert {"joint_springs:j2", "joint_springs:j3"} <= {item.effect.id for item in found.findings}
    assert found.chance > 1e-3


def test_a_law_that_rows_now_set_aside_made_usual_is_held_against_the_others(
    tmp_path: Path,
) -> None:
    """Flanks are shares of the largest torque, and that row may have become a wild one since."""
    a = poses(40, 5)
    data = sk.read(write(tmp_path, a, tracked(errors(4).stands(a)[0]), FIT + NOISE))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    base = calibrate(Model(robot), data.with_joints(robot.actuated), geometry=False, waves=False)
    linear, _ = linear_at(base, Options(), sk.CATALOGUE)
    ids = [effect.id for effect in linear.candidates]
    e = ids.index("lost_motion:j3")
    law = replace(linear.candidates[e], flanks=(12.3,), sided=False)
    own = linear.slices[e]
    linear = linear.by_law(e, law, linear.sizes[own], 0.0 * linear.columns[:, own])
    laws = laws_at(linear, (e,), base)
    assert law in [block[0] for block in laws[e]]
    assert by_best_laws(linear, (e,), laws).candidates[e] in [block[0] for block in laws[e]]


def test_a_law_with_more_numbers_than_were_tried_is_judged_by_its_own_columns(
    tmp_path: Path,
) -> None:
    """A base that rocks about a point beside the axis has a cross term that the usual law lacks."""
    a = poses(40, 5)
    data = sk.read(write(tmp_path, a, tracked(errors(4).stands(a)[0]), FIT + NOISE))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    readings = data.with_joints(robot.actuated)
    base = calibrate(Model(robot), readings, geometry=False, waves=False)
    linear, _ = linear_at(base, Options(), sk.CATALOGUE)
    e = [effect.id for effect in linear.candidates].index("base_rocking:base")
    usual = linear.candidates[e]
    assert isinstance(usual, BaseRocking)
    law = replace(usual, askew=True, beside=(0.15, -0.1))
    final = replace(base, model=base.model + law)
    there = as_fitted(linear, (e,), base, final)
    assert there.candidates[e] == law and len(there.values((e,), 1.0)) == 3
    at, size = final.model.values, 1e-9
    for k, column in enumerate(there.columns[:, there.slices[e]].T):
        step = np.eye(len(at))[base.model.values.size + k] * size * there.sizes[there.slices[e]][k]
        problem = replace(base.problem, model=final.model)
        slope = (problem.channel_gap(at - step)[0] - problem.channel_gap(at + step)[0]) / 2 / size
        slope = base.problem.of_channels.apply(slope)
        slope -= linear.base @ (linear.base.T @ slope)
        np.testing.assert_allclose(column, slope, atol=1e-3 * np.abs(slope).max())


def test_waves_are_named_with_their_joint(tmp_path: Path) -> None:
    waves = np.zeros((6, 2))
    waves[1] = 2e-4, -1.5e-4
    found = explained(tmp_path, Arm(waves=waves), poses(90, 60), 6)
    assert [item.effect.id for item in found.findings] == ["transmission_error:j2"]
    wave = found.final.model.parameter("transmission_error:j2.sin_1")
    assert abs(wave.internal - 2e-4) < 4.0 * wave.internal_std < 2e-4


def test_a_fit_that_went_another_way_begins_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where more is left than to first order, the values found so are another start."""
    module = sys.modules[Campaign.__module__]
    x = tracked(errors(4).stands(poses(60, 41))[0]) + 2e-5 * RNG.normal(size=(60, 3))
    data = sk.read(write(tmp_path, poses(60, 41), x, FIT + NOISE))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    first, fits = module.refined, []

    def lost(*given: Any) -> Calibration:
        """Every odd fit ends where it began."""
        fits.append(given[3])
        base, effects, *rest = given
        return first(base, effects if len(fits) % 2 == 0 else effects[:1], *rest)

    monkeypatch.setattr(module, "refined", lost)
    found = explain_positions(Model(robot), data.with_joints(robot.actuated))
    assert len(fits) > 1 and len(fits) % 2 == 0
    assert found.chance > 1e-3
    spring = found.final.model.parameter("joint_springs:j2.stiffness")
    assert abs(spring.internal - 1 / 8e5) < 4.0 * spring.internal_std
