"""A joint, the tracker or the marker? Several markers, and an arm with errors that no model has."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.positions.arm import Array, errors, poses, tracked, write
from tests.positions.checks.test_slips import SIGMA, explain, fit, told

COUNT = 60
A = poses(COUNT, 3)
AFTER = (np.arange(COUNT) >= 22)[:, None]
SLIP = 1.2e-3
POINT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
MARKERS = np.array([[0.20, 0.06, 0.20], [-0.05, -0.20, 0.20], [-0.15, 0.15, 0.20]])


def ways(a: Array, seed: int, size: float) -> Array:
    """Joints (N, 6) as they stand: each off by waves of its own, as no model has them."""
    phase = np.random.default_rng(seed).uniform(0.0, 6.0, (2, 6))
    return a + size * (np.sin(3.0 * a + phase[0]) + np.sin(5.0 * a + phase[1]))


def seen(a: Array, *, seed: int = 4, size: float = 1e-4, moved: Array | None = None) -> Array:
    """Three markers (N, 3, 3) of such an arm, each off by `moved` (N, 3) on the tool."""
    off = np.zeros((len(a), 3)) if moved is None else moved
    arms = (replace(errors(seed), marker=np.zeros(3)), errors(seed))
    x, R = arms[0].stands(ways(a, seed, size))
    return np.stack([x + np.einsum("nij,nj->ni", R, point + off) for point in MARKERS], axis=1)


def file(folder: Path, x: Array, *, a: Array = A, labels: str = "") -> Path:
    """Three rows a pose."""
    y = tracked(x.reshape(-1, 3)) + SIGMA * np.random.default_rng(5).normal(size=(3 * len(a), 3))
    names = [f"P{k},{m}{',x' * labels.count(',')}" for k in range(len(a)) for m in (1, 2, 3)]
    more = f",pose,marker{labels}"
    return write(folder, np.repeat(a, 3, axis=0), y, POINT + "massless", more=more, cells=names)


FIRST = SLIP * AFTER * np.eye(6)[0]


@pytest.mark.parametrize(("verb", "seed"), [(fit, 6), (explain, 9)])
def test_one_number_of_a_joint_is_named_first_and_what_explains_as_much_beside_it(
    verb, seed: int, tmp_path: Path
) -> None:
    """Both verbs say the same: what poses have in common hid it from `fit`."""
    said = told(verb(file(tmp_path, seen(A + FIRST, seed=seed))))
    assert said.startswith("J1 looks slipped by +1.")
    assert "between lines 67 and 68" in said
    assert "the tracker moved there" in said and "(6 numbers)" in said
    assert "Taken here as if the tracker had moved, which leaves least" in said
    assert "add to values of j1 +0.0" in said and "from line 68 on" in said
    assert "If the tracker moved instead, add a column station" in said
    assert "station" in said.split("Or write")[1] and "series" in said.split("Or write")[1]


def by_joints() -> Array:
    """(60, 6) ten poses for every joint, which goes from end to end."""
    ends = np.array([1.5, 0.85, 0.95, 2.0, 1.5, 2.5])
    a = np.array([0.2, 0.1, 0.2, 0.5, 0.6, 0.3]) + 0.05 * np.random.default_rng(0).normal(
        size=(COUNT, 6)
    )
    for k in range(6):
        a[10 * k : 10 * k + 10, k] = np.linspace(-ends[k], ends[k], 10)
    return a


@pytest.mark.parametrize(("verb", "seed"), [(fit, 4), (explain, 6)])
def test_poses_joint_by_joint_whose_errors_go_together_from_row_to_row(
    verb, seed: int, tmp_path: Path
) -> None:
    """Further moves take off errors of the model then: neither they nor more numbers count."""
    a = by_joints()
    said = told(verb(file(tmp_path, seen(a + FIRST, seed=seed, size=2e-4), a=a)))
    assert "J1 looks slipped by +1." in said and "between lines 67 and 68:" in said


@pytest.mark.parametrize("verb", [fit, explain])
def test_such_poses_alone_did_not_move(verb, tmp_path: Path) -> None:
    a = by_joints()
    found = verb(file(tmp_path, seen(a, size=3e-4), a=a))
    notes = getattr(found, "final", found).notes
    assert not [note for note in notes if "slipped" in note or "looks moved" in note]


def test_by_how_much_is_told(tmp_path: Path) -> None:
    said = told(fit(file(tmp_path, seen(A + FIRST))))
    size = 1e-3 * float(said.split("slipped by ")[1].split(" mrad")[0])
    assert size == pytest.approx(SLIP, rel=0.1)


@pytest.mark.parametrize("verb", [fit, explain])
def test_a_tracker_that_moved_freely_is_the_tracker(verb, tmp_path: Path) -> None:
    turn = Rotation.from_rotvec([8e-4, -5e-4, 3e-4])
    x = seen(A)
    there = turn.apply(x.reshape(-1, 3)).reshape(x.shape) + [1e-3, -2e-3, 1e-3]
    said = told(verb(file(tmp_path, np.where(AFTER[:, None], there, x))))
    assert "The tracker looks moved between lines 67 and 68" in said
    assert "slipped" not in said and "marker" not in said


@pytest.mark.parametrize("verb", [fit, explain])
def test_a_plate_that_moved_on_the_tool_is_the_marker(verb, tmp_path: Path) -> None:
    x = seen(A, moved=AFTER * [2e-3, 1e-3, -1e-3])
    said = told(verb(file(tmp_path, x)))
    assert "The marker looks moved between lines 67 and 68" in said
    assert "off by 2.4 mm" in said and "tracker" not in said


@pytest.mark.parametrize("verb", [fit, explain])
def test_where_the_file_says_that_nothing_moved_it_is_told_and_stops_nothing(
    verb, tmp_path: Path
) -> None:
    found = verb(file(tmp_path, seen(A + FIRST), labels=",series,station"))
    notes = getattr(found, "final", found).notes
    assert any(note.startswith("J1 looks slipped") for note in notes)


@pytest.mark.parametrize(("verb", "seed"), [(fit, 6), (explain, 9)])
def test_an_arm_with_such_errors_alone_is_not_taken_for_one_that_moved(
    verb, seed: int, tmp_path: Path
) -> None:
    a = A[np.argsort(A[:, seed % 3])]
    found = verb(file(tmp_path, seen(a, seed=seed, size=3e-4), a=a))
    notes = getattr(found, "final", found).notes
    assert not [note for note in notes if "slipped" in note or "looks moved" in note]
