"""Loads as a noisy sensor of force reads them: what was one load is one, what was two is two."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import Imported, import_readings
from tests.measurements.importers.holds.test_log import POSES, SIGMA, logged
from tests.measurements.importers.tracked import SHIFT, TURN, ur5

NOISE = 0.2  # N
WEIGHTS = (0.0, -40.0, -80.0)  # N, one after the other while the arm stands
PULL = 1e-5  # m/N along z: what yields


def brought(folder: Path, q: np.ndarray, x: np.ndarray, F: np.ndarray) -> Imported:
    head = ",".join(f"q{k}" for k in range(1, 7)) + ",x,y,z,fx[N],fy[N],fz[N]"
    path = folder / "read.csv"
    np.savetxt(path, np.column_stack([q, x, F]), delimiter=",", header=head, comments="",
               fmt=["%.7f"] * 9 + ["%.3f"] * 3)  # fmt: skip
    return import_readings(path, load_robot(ur5(), tool="tool0"), Told(length="m", angle="rad"))


def noisy(F: np.ndarray, seed: int = 9) -> np.ndarray:
    return F + NOISE * np.random.default_rng(seed).normal(size=F.shape)


def hung(*, dwell: int, slope: int = 0, way: int = 20) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A log of joints, positions and loads (N, 3): three weights at each of nine poses."""
    ramp = np.linspace(0.0, 1.0, slope + 2)[1:-1]
    at_pose = [WEIGHTS[0]] * dwell
    for before, after in pairwise(WEIGHTS):
        at_pose += [before + (after - before) * s for s in ramp] + [after] * dwell
    path, fz = [], []
    for k, pose in enumerate(POSES):
        if k:
            steps = np.linspace(0.0, 1.0, way + 2)[1:-1, None]
            path += list(POSES[k - 1] + (pose - POSES[k - 1]) * steps)
            fz += [0.0] * way
        path += [pose] * len(at_pose)
        fz += at_pose
    q, F = np.array(path), np.zeros((len(fz), 3))
    F[:, 2] = fz
    x = load_robot(ur5(), tool="tool0").placement(q)[:, :3, 3] + PULL * F
    return q, TURN.apply(x) + SHIFT, F


@pytest.mark.parametrize("late", [0, 3])
def test_noise_of_a_force_does_not_part_a_standstill(late: int, tmp_path: Path) -> None:
    q, x = logged(dwell=60, way=30, late=late)
    found = brought(tmp_path, q, x, noisy(np.zeros((len(q), 3))))
    assert found.readings.n_readings == len(POSES)
    assert found.fitted is not None and found.fitted.rms < SIGMA
    assert any("240 rows in which it moved are left out" in note for note in found.said)
    assert any("a noise of 0.2 N" in note for note in found.said)
    assert np.abs(found.draft.loads.wrench[:, :3]).max() < 5 * NOISE / np.sqrt(60)


@pytest.mark.parametrize(("dwell", "slope"), [(5, 0), (6, 0), (20, 0), (20, 6)])
@pytest.mark.parametrize("noise", [False, True])
def test_weights_hung_one_after_the_other_are_readings(
    dwell: int, slope: int, noise: bool, tmp_path: Path
) -> None:
    q, x, F = hung(dwell=dwell, slope=slope)
    found = brought(tmp_path, q, x, noisy(F) if noise else F)
    assert len(found.draft.pose) == 27 and len(set(found.draft.pose)) == 9
    assert found.mode == "load pairs" and found.differences == 18
    off = found.draft.loads.wrench[:, 2] - np.tile(WEIGHTS, 9)
    assert np.abs(off).max() < (4 * NOISE / np.sqrt(dwell) if noise else 1e-12)
    changing = [note for note in found.said if "in which the load changed" in note]
    assert bool(changing) == (slope > 0)


def test_of_a_recorded_ramp_each_hold_is_one_reading(tmp_path: Path) -> None:
    """Thousands of rows of a load that rises and falls slowly, the arm at rest: none is alone."""
    up = np.linspace(0.0, -80.0, 180)
    pull = np.concatenate([np.zeros(40), up, up[::-1]])
    q, F = np.repeat(POSES, len(pull), axis=0), np.zeros((9 * len(pull), 3))
    F[:, 2] = np.tile(pull, 9)
    x = load_robot(ur5(), tool="tool0").placement(q)[:, :3, 3] + PULL * F
    rng = np.random.default_rng(3)
    x = TURN.apply(x) + SHIFT + SIGMA * rng.normal(size=x.shape)
    found = brought(tmp_path, q, x, noisy(F))
    note = next(said for said in found.said if said.startswith("This is a recording"))
    assert "3600 rows" in note and "times 5 rows in turn" in note
    assert 9 * 15 < len(found.draft.pose) < 9 * 90 and len(set(found.draft.pose)) == 9
    fz, read = found.readings.wrench[:, 2], found.readings.displacement
    assert read is not None and fz.min() < -70.0
    np.testing.assert_allclose(
        np.linalg.norm(read, axis=1), PULL * np.abs(fz), atol=8.0 * SIGMA / np.sqrt(5)
    )


def test_a_knock_leaves_a_standstill_one_reading(tmp_path: Path) -> None:
    q, x, F = hung(dwell=20)
    F = noisy(F)
    F[8:10, 0] += 15.0
    found = brought(tmp_path, q, x, F)
    assert len(found.draft.pose) == 27
    assert abs(found.draft.loads.wrench[0, 0]) < 4 * NOISE / np.sqrt(18)
    assert any(" and 2 in which the load changed" in note for note in found.said)


def test_short_series_under_several_loads_are_no_log(tmp_path: Path) -> None:
    """Five readings without load and four under each weight: nothing moved, nothing is left out."""
    F = np.zeros((9 * 13, 3))
    F[:, 2] = np.tile(np.repeat(WEIGHTS, (5, 4, 4)), 9)
    q = np.repeat(POSES, 13, axis=0)
    x = load_robot(ur5(), tool="tool0").placement(q)[:, :3, 3] + PULL * F
    found = brought(tmp_path, q, TURN.apply(x) + SHIFT, F)
    assert len(found.draft.pose) == 9 * 13
    assert not any("log" in note for note in found.said)


def held(F: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`rows` readings under each of three loads (9, 3, 3) [N] at each pose, encoders wandering."""
    rng = np.random.default_rng(12)
    F = np.repeat(F.reshape(27, 3), rows, axis=0)
    q = np.repeat(POSES, 3 * rows, axis=0)
    x = load_robot(ur5(), tool="tool0").placement(q)[:, :3, 3] + PULL * F
    x = TURN.apply(x) + SHIFT + SIGMA * rng.normal(size=x.shape)
    return q + 2e-5 * rng.normal(size=q.shape), x, F


def test_rows_of_a_hold_are_repeats_under_its_mean_load(tmp_path: Path) -> None:
    true = np.random.default_rng(11).normal(0.0, 40.0, (9, 3, 3))
    q, x, F = held(true, 15)
    found = brought(tmp_path, q, x, noisy(F))
    W = found.draft.loads.wrench[:, :3].reshape(27, 15, 3)
    assert np.ptp(W, axis=1).max() == 0.0
    assert np.abs(W[:, 0] - true.reshape(27, 3)).max() < 4.5 * NOISE / np.sqrt(15)
    assert len(set(found.draft.pose)) == 9
    told = next(note for note in found.said if "27 holds" in note)
    assert "of 15 rows" in told and "0.22 N" in told and "repeats" in told
    scatter = float(told.partition("sigma: ")[2].partition(",")[0])
    assert 27.0 < scatter < 33.0


def test_loads_that_differ_from_row_to_row_stay_as_they_are(tmp_path: Path) -> None:
    """Pulls by hand, six at each pose, read by a sensor: each is a load of its own."""
    rng = np.random.default_rng(13)
    q, x, _ = held(np.zeros((9, 3, 3)), 2)
    F = rng.normal(0.0, 40.0, (len(q), 3))
    found = brought(tmp_path, q, x + PULL * TURN.apply(F), F)
    assert np.allclose(found.draft.loads.wrench[:, :3], F, atol=1e-3)
    assert not any("holds" in note for note in found.said)


def test_gauges_under_a_noisy_sensor_have_its_mean_too(tmp_path: Path) -> None:
    """Each along a direction of its own: how they scatter per axis is not told."""
    q, _, F = held(np.random.default_rng(14).normal(0.0, 40.0, (9, 3, 3)), 6)
    head = ",".join(f"q{k}" for k in range(1, 7)) + ",d[mm],ux,uy,uz,fx[N],fy[N],fz[N]"
    along = np.tile([0.1, 0.0, 0.6, 0.8], (len(q), 1))
    path = tmp_path / "gauges.csv"
    np.savetxt(path, np.column_stack([q, along, noisy(F)]), delimiter=",", header=head,
               comments="", fmt="%.6f")  # fmt: skip
    found = import_readings(path, load_robot(ur5(), tool="tool0"), Told(angle="rad"))
    assert len({tuple(row) for row in found.draft.loads.wrench}) == 27
    told = next(note for note in found.said if "27 holds" in note)
    assert "scatter" not in told
