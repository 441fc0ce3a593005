"""Positions of an arm whose springs became others while it was measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.judge.changed import changed
from tests.positions.arm import poses, tracked, write
from tests.positions.test_forms import _with
from tests.positions.test_payload_place import COMPLIANCE, FIT, NOISE, robot_of

ROW = 33  # from which on the arm is softer


def two_arms(folder: Path, softer: float) -> Path:
    a = poses(60, 4)
    seen = []
    for share in (1.0, softer):
        arm = _with()
        arm.compliance, arm.shift, arm.turn = share * COMPLIANCE, np.zeros((6, 3)), np.zeros((6, 3))
        seen.append(arm.stands(a)[0])
    x = np.where(np.arange(60)[:, None] < ROW, *map(tracked, seen))
    x += 2e-5 * np.random.default_rng(3).normal(size=(60, 3))
    return write(folder, a, x, FIT + NOISE)


def explained(path: Path) -> Explained:
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    return found


def test_the_pose_from_which_on_springs_are_others_is_told(tmp_path: Path) -> None:
    found = explained(two_arms(tmp_path, 1.5))
    (said,) = [note for note in found.final.notes if note.startswith("The springs are others")]
    label = sk.read(tmp_path / "readings.csv").pose[ROW]
    assert f"from pose {label} on than before" in said
    assert "positions of two arms" in said


def test_a_column_order_says_in_which_order_rows_were_read(tmp_path: Path) -> None:
    path = two_arms(tmp_path, 1.5)
    head, *rows = path.read_text().splitlines()
    mixed = [f"{rows[k]},{k},p{k}" for k in np.random.default_rng(2).permutation(60)]
    path.write_text("\n".join([f"{head},order,pose", *mixed]) + "\n")
    (said,) = [n for n in explained(path).final.notes if n.startswith("The springs are others")]
    assert f"from pose p{ROW} on than before" in said


def test_springs_that_stay_the_same_are_not_told_to_change(tmp_path: Path) -> None:
    final = explained(two_arms(tmp_path, 1.0)).final
    assert not any("springs are others" in note for note in final.notes)
    told = 0
    for seed in range(20):  # noise of other readings in the same places
        rng = np.random.default_rng(seed)
        told += bool(changed(replace(final, residual=rng.permutation(final.residual)), seed))
    assert told <= 1
