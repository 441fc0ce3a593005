"""A joint that stands off from some row on: its clamp slipped, or its belt jumped a tooth."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from tests.positions.arm import Array, errors, poses, tracked
from tests.positions.checks.test_slips import CLOCK, COUNT, A, explain, fit, read, told

AFTER = (np.arange(COUNT) >= 37)[:, None]


def slipped(joint: int, size: float, a: Array = A, after: Array = AFTER, seed: int = 4) -> Array:
    """Positions (N, 3) where a joint stands off by `size` from some rows on."""
    return tracked(errors(seed).stands(a + size * after * np.eye(6)[joint - 1])[0])


def size_in(message: str) -> float:
    found = re.search(r"slipped by (\S+) mrad", message)
    assert found is not None
    return 1e-3 * float(found[1])


@pytest.mark.parametrize(("verb", "joint"), [(fit, 2), (explain, 3), (explain, 4), (fit, 5)])
def test_it_is_told_with_the_lines_and_by_how_much(verb, joint: int, tmp_path: Path) -> None:
    size = 4e-4 if joint < 4 else 9e-4
    said = told(verb(read(tmp_path, slipped(joint, size), A)))
    assert re.match(f"J{joint} looks slipped by.*between lines 38 and 39", said)
    assert size_in(said) == pytest.approx(size, rel=0.15)
    deg = f"{np.degrees(size_in(said)):+.2g}"[:5]
    assert f"add to values of j{joint} {deg}" in said
    assert "from line 39 on" in said


def test_with_what_the_remedy_says_the_arm_comes_out(tmp_path: Path) -> None:
    x = slipped(3, 4e-4)
    taken = fit(read(tmp_path, x, A))
    by = re.search(r"add to values of j3 (\S+) deg", told(taken))
    assert by is not None
    mended = A + np.radians(float(by[1])) * AFTER * np.eye(6)[2]
    given = sk.read(read(tmp_path, x, A)).with_joints(taken.model.robot.actuated)
    off = sk.predict(taken.model, given).gap(given)
    size = np.sqrt(np.nanmean(off**2, axis=1))
    assert size[AFTER[:, 0]].max() < 1e-4 < size[~AFTER[:, 0]].max()  # the arm as it stands since
    for found in (taken, fit(read(tmp_path, x, mended))):
        assert found.rms < 1.3 * 2e-5
        stiffness = found.model.parameter("joint_springs:j2.stiffness").value
        assert stiffness == pytest.approx(8e5, rel=0.03)


def test_of_the_first_joint_the_base_may_have_turned(tmp_path: Path) -> None:
    said = told(fit(read(tmp_path, slipped(1, 4e-4), A)))
    assert said.startswith("J1 looks slipped")
    assert "Or the tracker or the base turned about its axis by as much." in said


def test_one_label_for_all_lets_it_be_and_it_is_told(tmp_path: Path) -> None:
    found = fit(read(tmp_path, slipped(3, 4e-4), A, more=",series", cells=["all"] * COUNT))
    (note,) = [note for note in found.notes if "slipped" in note]
    assert note.startswith("J3 looks slipped") and found.rms > 2.0 * 2e-5


def test_two_slips_are_both_told(tmp_path: Path) -> None:
    after = AFTER * 1.0 - 2.0 * (np.arange(COUNT) >= 60)[:, None]
    found = fit(read(tmp_path, slipped(3, 5e-4, after=after), A))
    said = told(found)
    assert "between lines 38 and 39 and 61 and 62" in said and found.rms < 1.3 * 2e-5
    assert re.search(r"slipped by \+0\.\d+ mrad and -[01]\.?\d* mrad", said)


@pytest.mark.parametrize(
    ("verb", "seed"), [*((fit, k) for k in range(3)), *((explain, k) for k in range(3, 6))]
)
def test_nothing_of_clean_readings_slipped(verb, seed: int, tmp_path: Path) -> None:
    a = poses(COUNT, seed)
    found = verb(read(tmp_path, tracked(errors(seed).stands(a)[0]), a))
    assert not _told(found)


GROWTH = np.array([[0, 0, 1.0], [0, 0, 1.0], [0, 0, 1.0], [0, 0, 0], [1.0, 0, 0], [0, 0, 0]])


def warm(a: Array, course: Array, size: float = 4e-4) -> Array:
    """Positions of an arm whose links grow along a course of time (N,)."""
    cold, hot = errors(4), errors(4)
    hot = replace(hot, shift=hot.shift + size * GROWTH)
    x, y = cold.stands(a)[0], hot.stands(a)[0]
    return tracked(x + course[:, None] * (y - x))


@pytest.mark.parametrize(
    ("verb", "course", "seed"),
    [
        (fit, CLOCK[:, 0], 3),
        (explain, CLOCK[:, 0], 8),
        (explain, 1.0 - np.exp(-CLOCK[:, 0] / 0.15), 3),
        (fit, np.sin(6.0 * CLOCK[:, 0]), 8),
    ],
)
def test_an_arm_that_warms_up_slips_nowhere(verb, course: Array, seed: int, tmp_path: Path) -> None:
    a = poses(COUNT, seed)
    assert not _told(verb(read(tmp_path, warm(a, course), a)))


@pytest.mark.parametrize(("verb", "joint"), [(fit, 2), (explain, 3), (fit, 5)])
def test_a_joint_that_creeps_does_not_slip(verb, joint: int, tmp_path: Path) -> None:
    """Its zero drifts as its encoder warms up, or evenly."""
    for course in (CLOCK, 1.0 - np.exp(-CLOCK / 0.2)):
        assert not _told(verb(read(tmp_path, slipped(joint, 6e-4, after=course), A)))


def test_a_joint_whose_gear_has_play_does_not_slip(tmp_path: Path) -> None:
    """It stands off by the side from which its torque comes, along a plan that is sorted by it."""
    a = A[np.argsort(A[:, 1])]
    arm = errors(4)
    arm.play, arm.flank = np.array([0.0, 2e-4, 2e-4, 0.0, 0.0, 0.0]), 20.0
    assert not _told(fit(read(tmp_path, tracked(arm.stands(a)[0]), a)))


def _told(found) -> list[str]:  # type: ignore[no-untyped-def]
    notes = found.final.notes if isinstance(found, Explained) else found.notes
    return [note for note in notes if "slipped" in note or "looks moved" in note]
