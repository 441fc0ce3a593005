"""Logs that went on while the arm moved: a reading for each standstill, none on the way."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff import load_robot
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import Imported, import_readings
from tests.measurements.importers.tracked import SHIFT, TURN, ur5

POSES = np.random.default_rng(5).uniform(-1.2, 1.2, (9, 6))
SIGMA, JITTER = 3e-5, 2e-5  # m of a position, rad of an encoder at rest


def logged(*, dwell: int, way: int, late: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Joints (N, 6) and positions (N, 3), `late` rows behind, of a tracker at a fixed rate."""
    path = [POSES[0]] * dwell
    for here, there in pairwise(POSES):
        path += [here + (there - here) * s for s in np.linspace(0.0, 1.0, way + 2)[1:-1]]
        path += [there] * dwell
    q, rng = np.array(path), np.random.default_rng(6)
    T = load_robot(ur5(), tool="tool0").placement(q)
    x = TURN.apply(T[:, :3, 3]) + SHIFT + SIGMA * rng.normal(size=(len(q), 3))
    return q + JITTER * rng.normal(size=q.shape), np.roll(x, late, axis=0)[: len(q)]


def brought(folder: Path, q: np.ndarray, x: np.ndarray, more: np.ndarray | None = None) -> Imported:
    head = "time[s]," + ",".join(f"q{k}" for k in range(1, 7)) + ",x,y,z"
    rows = np.column_stack([0.01 * np.arange(len(q)), q, x])
    if more is not None:
        head, rows = head + ",A,B,C", np.column_stack([rows, more])
    path = folder / "log.csv"
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.7f")
    return import_readings(path, load_robot(ur5(), tool="tool0"), Told(length="m", angle="rad"))


def test_every_standstill_is_one_reading(tmp_path: Path) -> None:
    """The tracker is late: on the way nothing fits, and at rest it does not matter."""
    found = brought(tmp_path, *logged(dwell=80, way=40, late=3))
    assert found.readings.n_readings == len(POSES)
    assert np.abs(found.readings.joints - POSES).max() < JITTER
    assert found.fitted is not None and found.fitted.rms < SIGMA
    told = next(note for note in found.said if note.startswith("This is a log"))
    assert "9 standstills" in told and "320 rows in which it moved" in told
    clock = [float(cell) for cell in dict(found.columns)["time[s]"]]
    assert np.allclose(np.diff(clock), 1.2, atol=0.05)


def test_orientations_come_with_the_standstills(tmp_path: Path) -> None:
    q, x = logged(dwell=30, way=20)
    axes = Rotation.from_matrix(load_robot(ur5(), tool="tool0").placement(q)[:, :3, :3])
    noise = Rotation.from_rotvec(3e-4 * np.random.default_rng(7).normal(size=x.shape))
    angles = (TURN * axes * noise).as_euler("ZYX")
    found = brought(tmp_path, q, x, angles)
    assert found.orientation is not None and "KUKA" in found.orientation.way
    assert found.readings.n_readings == len(POSES)


@pytest.mark.parametrize("repeats", [[6] * 9, [6, 1, 6, 1, 1, 6, 1, 1, 6]])
def test_poses_that_were_repeated_are_no_log(repeats: list[int], tmp_path: Path) -> None:
    q = np.repeat(np.tile(POSES, (4, 1)), repeats * 4, axis=0)
    x = TURN.apply(load_robot(ur5(), tool="tool0").placement(q)[:, :3, 3])
    x += SIGMA * np.random.default_rng(8).normal(size=x.shape)
    found = brought(tmp_path, q, x)
    assert found.readings.n_readings == len(q)
    assert not any("log" in note for note in found.said)


def test_a_way_without_a_standstill_is_taken_as_it_is(tmp_path: Path) -> None:
    found = brought(tmp_path, *logged(dwell=1, way=40))
    assert found.readings.n_readings == 9 + 8 * 40
