"""A tracker pushed by tenths of a millimetre, or a marker that slipped, between two rows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.model import Model
from tests.positions.arm import NAMES, Arm, Array, errors, poses, tracked, write

SIGMA = 2e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
COUNT = 80
CLOCK = np.linspace(0.0, 1.0, COUNT)[:, None]


def read(
    folder: Path, x: Array, a: Array, *, noise: str = NOISE, more: str = "",
    cells: list[str] | None = None,
) -> Path:  # fmt: skip
    x = x + SIGMA * np.random.default_rng(5).normal(size=x.shape)
    return write(folder, a, x, FIT + noise, more=more, cells=cells)


def pushed(x: Array, rows: Array) -> Array:
    """By a third of a millimetre and a tenth of a milliradian from some rows on."""
    turn = Rotation.from_rotvec([5e-5, 0.0, 1e-4])
    return np.where(rows[:, None], turn.apply(x) + np.array([2e-4, -1e-4, 3e-4]), x)


def fit(path: Path) -> Calibration:
    model = sk.base_model(sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool"))
    assert model is not None
    found = sk.fit(model, sk.read(path))
    assert isinstance(found, Calibration)
    return found


def explain(path: Path) -> sk.Explained:
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    return explain_positions(Model(robot), sk.read(path).with_joints(NAMES))


A = poses(COUNT, 3)
X = tracked(errors(4).stands(A)[0])


def told(found: Calibration | sk.Explained) -> str:
    """The one note of what moved."""
    calibration = found if isinstance(found, Calibration) else found.final
    said = [note for note in calibration.notes if "looks moved" in note or "looks slipped" in note]
    assert len(said) == 1
    return said[0]


@pytest.mark.parametrize("noise", [NOISE, ""])
@pytest.mark.parametrize("verb", [fit, explain])
def test_a_pushed_tracker_is_told_with_the_lines(verb, noise: str, tmp_path: Path) -> None:
    path = read(tmp_path, pushed(X, np.arange(COUNT) >= 37), A, noise=noise)
    said = told(verb(path))
    assert said.startswith("The tracker looks moved between lines 38 and 39:")
    assert "Taken so here: a frame of its own for each part of the campaign." in said
    assert "Add a column station" in said


def test_what_was_taken_for_granted_is_the_first_thing_to_do(tmp_path: Path) -> None:
    moved, still = (
        explain(read(tmp_path, x, A)).document().next_step
        for x in (pushed(X, np.arange(COUNT) >= 37), X)
    )
    assert moved.startswith("Before anything else make sure that tracker, marker or joint moved")
    assert "moved" not in still


@pytest.mark.parametrize("verb", [fit, explain])
def test_a_wild_reading_is_no_push(verb, tmp_path: Path) -> None:
    """By less than the rigid arm leaves, so that placing does not set it aside."""
    x = X.copy()
    x[33] += np.array([2e-3, -1.5e-3, 1e-3])
    assert verb(read(tmp_path, x, A)) is not None
    x = pushed(x, np.arange(COUNT) >= 60)
    assert "he tracker looks moved between lines 61 and 62" in told(verb(read(tmp_path, x, A)))


@pytest.mark.parametrize("labelled", [True, False])
def test_with_stations_the_arm_comes_out(labelled: bool, tmp_path: Path) -> None:
    """Whether the file names them or they are found."""
    cells = ["before" if k < 37 else "after" for k in range(COUNT)] if labelled else None
    more = ",station" if labelled else ""
    found = fit(read(tmp_path, pushed(X, np.arange(COUNT) >= 37), A, more=more, cells=cells))
    assert found.rms < 1.2 * SIGMA
    assert found.model.parameter("joint_springs:j2.stiffness").value == pytest.approx(8e5, rel=0.03)


def test_a_label_that_is_the_same_for_all_lets_it_be(tmp_path: Path) -> None:
    x = pushed(X, np.arange(COUNT) >= 37)
    path = read(tmp_path, x, A, more=",station,series", cells=["x,y"] * COUNT)
    assert fit(path).rms > 3.0 * SIGMA


def test_two_pushes_are_both_told(tmp_path: Path) -> None:
    x = pushed(pushed(X, np.arange(COUNT) >= 25), np.arange(COUNT) >= 58)
    found = fit(read(tmp_path, x, A))
    assert "lines 26 and 27 and 59 and 60" in told(found) and found.rms < 1.2 * SIGMA


def test_the_order_of_the_file_is_not_that_of_reading(tmp_path: Path) -> None:
    """A column order says when each was read."""
    when = np.random.default_rng(8).permutation(COUNT)
    x = pushed(X, when >= 40)
    path = read(tmp_path, x, A, more=",order", cells=[str(k + 1) for k in when])
    before, after = (int(np.flatnonzero(when == k)[0]) + 2 for k in (39, 40))
    found = fit(path)
    assert f"between lines {before} and {after}:" in told(found) and found.rms < 1.2 * SIGMA


def test_a_marker_that_slipped_is_told(tmp_path: Path) -> None:
    slipped = replace(errors(4), marker=errors(4).marker + np.array([3e-4, -2e-4, 1e-4]))
    x = np.where((np.arange(COUNT) >= 50)[:, None], tracked(slipped.stands(A)[0]), X)
    found = fit(read(tmp_path, x, A))
    said = told(found)
    assert said.startswith("The marker looks moved between lines 51 and 52:")
    assert "Add a column series" in said and found.rms < 1.2 * SIGMA


def test_what_creeps_is_no_push(tmp_path: Path) -> None:
    assert fit(read(tmp_path, X + 4e-4 * CLOCK * np.array([1.0, -0.5, 0.5]), A)).rms > 2.0 * SIGMA


def test_a_push_beside_larger_errors_of_the_model_is_told_and_stops_nothing(tmp_path: Path) -> None:
    """Waves of the second order that nothing in the model has leave more than the push does."""
    a = poses(200, 11)
    rough = errors(4).stands(a + 6e-4 * np.sin(3.0 * a))[0]
    x = tracked(rough)
    path = read(tmp_path, pushed(x, np.arange(200) >= 90), a)
    found = fit(path)
    said = [note for note in found.notes if "looks moved" in note]
    assert len(said) == 1 and "The tracker looks moved between lines 91 and 92" in said[0]
    assert not any("looks moved" in note for note in fit(read(tmp_path, x, a)).notes)


def test_what_changes_with_a_joint_is_no_push_of_poses_in_its_order(tmp_path: Path) -> None:
    """A law that jumps where joint 2 crosses zero, along a plan that is sorted by joint 2."""
    a = poses(200, 11)
    a = a[np.argsort(a[:, 1])]
    x = tracked(errors(4).stands(a + 6e-4 * np.sin(3.0 * a))[0])
    found = fit(read(tmp_path, pushed(x, a[:, 1] > 0.0), a))
    assert not any("looks moved" in note for note in found.notes)


@pytest.mark.parametrize("seed", range(3))
def test_an_arm_of_other_laws_along_a_sorted_plan_is_not_taken_for_a_push(
    seed: int, tmp_path: Path
) -> None:
    """Waves and hardening that nothing is asked for, poses in the order of two joints."""
    rng, a = np.random.default_rng(seed), poses(COUNT, seed)
    a = a[np.lexsort((a[:, 1], np.round(a[:, 0])))]
    arm: Arm = replace(
        errors(seed), waves=2e-4 * rng.normal(size=(6, 2)), hardens=1e-9 * rng.normal(size=6)
    )
    path = read(tmp_path, tracked(arm.stands(a)[0]), a)
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    model = sk.base_model(robot)
    assert model is not None
    found = sk.fit(model, sk.read(path), waves=False)
    assert found.rms > 1.5 * SIGMA
    assert isinstance(found, Calibration) and not any("looks moved" in n for n in found.notes)


def test_a_second_push_is_found_beside_the_first_which_was_large(tmp_path: Path) -> None:
    """The placing finds the large one, the fit the small one; labels of the file are none here."""
    away = Rotation.from_rotvec([0.2, -0.1, 0.4]).apply(X) + [0.3, -0.2, 0.1]
    x = np.where((np.arange(COUNT) >= 25)[:, None], away, X)
    x = pushed(x, np.arange(COUNT) >= 60)
    found = fit(read(tmp_path, x, A))
    said = " ".join(note for note in found.notes if "looks moved" in note)
    assert "between lines 26 and 27" in said and "between lines 61 and 62" in said
    assert found.rms < 1.2 * SIGMA
    assert found.model.parameter("joint_springs:j2.stiffness").value == pytest.approx(8e5, rel=0.03)


def test_rows_read_at_one_time_are_cut_where_they_stand(tmp_path: Path) -> None:
    """Blocks of ten rows share a time, as a log of the day has it."""
    times = [f"{60.0 * (k // 10)}" for k in range(COUNT)]
    path = read(tmp_path, pushed(X, np.arange(COUNT) >= 37), A, more=",time[s]", cells=times)
    found = fit(path)
    assert "between lines 38 and 39" in told(found)
    assert found.rms < 1.2 * SIGMA and not found.wild.any()


def test_masked_rows_are_of_the_part_they_stand_in(tmp_path: Path) -> None:
    use = ["0" if k in (10, 36, 37, 50) else "1" for k in range(COUNT)]
    path = read(tmp_path, pushed(X, np.arange(COUNT) >= 37), A, more=",use", cells=use)
    found = fit(path)
    assert "between lines 37 and 40" in told(found) and found.rms < 1.2 * SIGMA


def test_one_label_for_all_stands_though_the_tracker_moved_far(tmp_path: Path) -> None:
    away = Rotation.from_rotvec([0.2, -0.1, 0.4]).apply(X) + [0.3, -0.2, 0.1]
    x = np.where((np.arange(COUNT) >= 25)[:, None], away, X)
    path = read(tmp_path, x, A, more=",station", cells=["all"] * COUNT)
    with pytest.raises(InputError, match="not where this robot's marker goes"):
        fit(path)
