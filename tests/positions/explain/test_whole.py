"""That calibrating everything at once foretells better than names do is told, where it is so."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from sk120stiff.explain.positions.judge.accounts import heldout_on
from tests.positions.arm import Arm, poses, tracked, write
from tests.positions.explain.test_advice import FIT, explained


def off(seed: int) -> Arm:
    """Every joint frame a little off, every drive a little soft: nothing stands out."""
    rng = np.random.default_rng(seed)
    return Arm(
        shift=3e-4 * rng.normal(size=(6, 3)),
        turn=4e-4 * rng.normal(size=(6, 3)),
        compliance=1e-6 * rng.uniform(0.3, 1.0, 6),
    )


def test_where_few_poses_confirm_few_names_everything_together_is_nearer(tmp_path: Path) -> None:
    arm, a = off(2), poses(16, 2)
    answer = explained(tmp_path, a, arm.stands(a)[0], settings=FIT)
    assert answer.whole is not None
    assert answer.whole < 0.9 * answer.steps[-1].heldout_rms
    assert "sk120stiff identify DATA --out calibrated.yaml" in next_step_of_positions(answer)
    document = answer.document().as_keys()
    assert document["whole_heldout_um"] == 1e6 * answer.whole

    new = poses(40, 99)  # that it is so is tried at poses that nobody read
    (tmp_path / "new").mkdir()
    others = sk.read(write(tmp_path / "new", new, tracked(arm.stands(new)[0]), FIT))
    robot = sk.load_robot(others.robot, base="base", tool="tool")
    others = others.with_joints(robot.actuated)
    whole = sk.fit(sk.joint_spring_model(robot), answer.readings)
    assert heldout_on(whole, whole, others).rms < heldout_on(answer.final, whole, others).rms


def test_where_names_say_it_all_nothing_is_told(tmp_path: Path) -> None:
    arm, a = off(0), poses(24, 0)
    answer = explained(tmp_path, a, arm.stands(a)[0], settings=FIT)
    assert answer.whole is None
    assert "calibrated.yaml" not in next_step_of_positions(answer)


def test_that_drives_yield_is_no_fault_of_an_arm(tmp_path: Path) -> None:
    a = poses(24, 0)
    x = Arm(compliance=1e-6 * np.array([0.5, 1.0, 1.0, 3.0, 3.0, 3.0])).stands(a)[0]
    answer = explained(tmp_path, a, x, settings=FIT)
    assert all(item.effect.joint_spring for item in answer.findings)
    said = next_step_of_positions(answer)
    assert "drives yield, and that is no fault" in said and "to be mended" not in said
