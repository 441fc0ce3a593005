"""Repeats tell the noise of positions, whatever the model leaves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import next_step_of_positions
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.residuals.pure_error import pure_error
from sk120stiff.identify.positions.words import gap_sentence
from tests.positions.arm import Arm, errors, poses, tracked, write
from tests.positions.loaded_arm import MARKERS, SPRINGS, rests
from tests.positions.test_distances import POINTS, UNKNOWN, A
from tests.positions.test_forms import FINELY, rows

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
SIGMA = 5e-5


def seen(folder: Path, times: int) -> sk.Measurements:
    """Positions under a payload or none, each read so many times; every pose is off by 0.3 mm."""
    bare = np.repeat(poses(30, 3), 2, axis=0)
    mass = np.tile([0.0, 40.0], 30)
    force = np.zeros((60, 3))
    force[:, 2] = -9.80665 * mass
    origin, axes = rests(Arm(compliance=SPRINGS), bare, force)
    x = tracked(origin + np.einsum("nij,j->ni", axes, MARKERS["A"]))
    rng = np.random.default_rng(1)
    x = np.repeat(x + np.repeat(3e-4 * rng.normal(size=(30, 3)), 2, axis=0), times, axis=0)
    x = x + SIGMA * rng.normal(size=x.shape)
    cells = [f"P{k // 2},0,0,{f:g}" for k, f in enumerate(np.repeat(force[:, 2], 1))]
    cells = [cell for cell in cells for _ in range(times)]
    settings = FIT + "force: {frame: base, point: {xyz: [0, 0, 100], unit: mm}}\n"
    a = np.repeat(bare, times, axis=0)
    return sk.read(write(folder, a, x, settings, more=",pose,fx[N],fy[N],fz[N]", cells=cells))


@pytest.mark.parametrize("times", [6, 1])
def test_repeats_tell_what_one_reading_is_worth(tmp_path: Path, times: int) -> None:
    data = seen(tmp_path, times)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = sk.explain(sk.Model(robot), data)
    assert isinstance(found, Explained)
    again = pure_error(found.final)
    said, step = gap_sentence(found.final), next_step_of_positions(found)
    if times == 1:
        assert again is None
        assert "Repeats of one pose" not in said
        assert "Write 'noise:" not in step
        return
    assert again is not None
    assert again.freedom == 60 * 3 * (times - 1)
    assert again.sigma == pytest.approx(SIGMA, rel=0.1)
    assert "Repeat a few poses" not in step


def test_wires_to_three_points_at_one_pose_are_no_repeats(tmp_path: Path) -> None:
    """Each point is read once: how their gaps differ is the model's, not the instrument's."""
    a = np.repeat(A[:24], 3, axis=0)
    X = np.repeat(errors(1).stands(A[:24])[0], 3, axis=0)
    at = np.tile(POINTS, (24, 1))
    far = np.linalg.norm(X - at, axis=1) + 2e-5 * np.random.default_rng(8).normal(size=72)
    cells = rows(np.column_stack([1e3 * far, tracked(at)]))
    more = ",l[mm],ax[m],ay[m],az[m]"
    for times in (1, 3):
        path = write(
            tmp_path, np.repeat(a, times, axis=0), np.full((72 * times, 3), np.nan),
            UNKNOWN + FINELY, more=more, cells=[c for c in cells for _ in range(times)],
        )  # fmt: skip
        data = sk.read(path)
        robot = sk.load_robot(data.robot, base="base", tool="tool")
        found = pure_error(calibrate(sk.Model(robot), data.with_joints(robot.actuated)))
        assert (found is None) == (times == 1)
        assert found is None or (found.freedom, found.sigma) == (144, pytest.approx(0.0, abs=1e-9))
