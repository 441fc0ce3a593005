"""Rows of joints and positions that do not belong together from a line on, and a moved tracker."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.measurements.placing.placing import place
from tests.positions.arm import NAMES, Array, errors, poses, tracked, write
from tests.positions.checks.test_slips import explain, fit, told
from tests.positions.test_stations import AWAY, ELSEWHERE, FIT, NOISE, SIGMA, half, read

COUNT = 40
A = poses(COUNT, 3)
X = tracked(errors(4).stands(A)[0]) + SIGMA * np.random.default_rng(1).normal(size=(COUNT, 3))


def refused(folder: Path, a: Array, x: Array) -> InputError:
    path = write(folder, a, x, FIT + NOISE)
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    with pytest.raises(InputError) as told:
        place(robot, sk.read(path).with_joints(NAMES))
    return told.value


@pytest.mark.parametrize(
    ("a", "x", "words"),
    [
        (A[1:], X[:-1], "From line 2 on positions and joints look 1 row apart: with the position "
         "of line 3 at the joints of line 2,"),
        (A[:-1], X[1:], "From line 2 on positions and joints look 1 row apart: with the position "
         "of line 2 at the joints of line 3,"),
        (A[:-1], np.delete(X, 20, 0), "From line 22 on positions and joints look 1 row apart: with "
         "the position of line 22 at the joints of line 23,"),
        (np.delete(A, 20, 0), X[:-1], "From line 22 on positions and joints look 1 row apart: with "
         "the position of line 22 at the joints of line 21,"),
        (A[:-2], np.delete(X, [12, 13], 0), "From line 14 on positions and joints look 2 rows "
         "apart: with the position of line 14 at the joints of line 16,"),
    ],
)  # fmt: skip
def test_a_row_without_partner_is_told(a: Array, x: Array, words: str, tmp_path: Path) -> None:
    error = refused(tmp_path, a, x)
    assert words in error.what
    assert "one of them lacks its partner" in error.remedy


@pytest.mark.parametrize("row", [6, 17, 34])
def test_a_tracker_that_was_moved_is_told(row: int, tmp_path: Path) -> None:
    there = ELSEWHERE.apply(errors(4).stands(A)[0]) + AWAY
    error = refused(tmp_path, A, np.where((np.arange(COUNT) >= row)[:, None], there, X))
    assert f"The tracker looks moved between lines {row + 1} and {row + 2}" in error.what
    assert "Add a column station" in error.remedy


def test_rows_in_no_order_are_neither(tmp_path: Path) -> None:
    error = refused(tmp_path, A, np.random.default_rng(2).permutation(X))
    assert "apart" not in error.what and "moved" not in error.what


def test_slips_are_found_beside_stations(tmp_path: Path) -> None:
    path = read(tmp_path, COUNT, 41, half(COUNT))
    path.write_text(path.read_text().replace("j2[deg]", "j[deg]").replace("j3[deg]", "j2[deg]")
                    .replace("j[deg]", "j3[deg]"))  # fmt: skip
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    with pytest.raises(InputError, match="The columns of j2 and j3 look exchanged"):
        place(robot, sk.read(path).with_joints(NAMES))


def test_a_column_of_something_else_is_no_joint_in_degrees(tmp_path: Path) -> None:
    """Small numbers of anything bring a joint that hardly moves near: no arm is that far off."""
    a = A.copy()
    a[:, 1] *= 0.1
    x = tracked(errors(4).stands(a)[0])
    a[:, 1] = np.random.default_rng(1).uniform(-6.0, 6.0, COUNT)
    error = refused(tmp_path, a, x)
    assert "degrees" not in error.what


@pytest.mark.parametrize("verb", [fit, explain])
def test_and_both_verbs_go_on_with_a_frame_for_each_part(verb, tmp_path: Path) -> None:
    there = ELSEWHERE.apply(errors(4).stands(A)[0]) + AWAY
    moved = np.where((np.arange(COUNT) >= 17)[:, None], there, X)
    found = verb(write(tmp_path, A, moved, FIT + NOISE))
    assert "The tracker looks moved between lines 18 and 19" in told(found)
    assert getattr(found, "final", found).rms < 1.3 * SIGMA
