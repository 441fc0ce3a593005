"""Orientations of a hold are the middle of its rows, as positions are."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff import load_robot
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.holds.orientations import held_orientations
from tests.measurements.importers.holds.test_log import POSES, brought, logged
from tests.measurements.importers.tracked import TURN, ur5

ROWS, NOISE = 60, 3e-3  # rad
TRUE = Rotation.from_rotvec([0.4, -0.9, 2.0])
READ = TRUE * Rotation.from_rotvec(NOISE * np.random.default_rng(3).normal(size=(ROWS, 3)))
NAMES = {
    4: ("qw", "qx", "qy", "qz"),
    9: tuple(f"orientation r{i}{j}" for i in "123" for j in "123"),
    3: ("orientation a", "orientation b", "orientation c"),
}


def held(values: np.ndarray, unit: str | None = None) -> tuple[np.ndarray, list[str]]:
    """Numbers of the one hold that all rows are, and what is said."""
    columns = tuple(
        Column(name, name, unit, "", tuple("" if np.isnan(v) else f"{v:.9f}" for v in cells))
        for name, cells in zip(NAMES[values.shape[1]], values.T, strict=True)
    )
    sheet = Sheet(Path("a.csv"), "", "", columns, tuple(range(len(values))))
    cells, said = held_orientations(sheet, [np.arange(len(values))], None)
    return np.array([float(cells[c.meaning][0]) for c in columns]), said


def test_quaternions_of_either_sign() -> None:
    values = np.roll(READ.as_quat(), 1, axis=1) * np.where(np.arange(ROWS) % 3, 1.0, -1.0)[:, None]
    values[7], values[ROWS // 2] = 0.0, np.nan  # not seen
    mid, said = held(values)
    assert np.linalg.norm(mid) == pytest.approx(1.0) and not said
    assert (TRUE.inv() * Rotation.from_quat(np.roll(mid, -1))).magnitude() < NOISE / 3


def test_matrices_stay_rotations() -> None:
    mid, said = held(READ.as_matrix().reshape(-1, 9))
    R = mid.reshape(3, 3)
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9 and not said
    assert (TRUE.inv() * Rotation.from_matrix(R)).magnitude() < NOISE / 3


def test_angles_that_jump_by_a_turn() -> None:
    true = Rotation.from_euler("ZYX", [180.0, 20.0, -30.0], degrees=True)
    read = true * (TRUE.inv() * READ)
    angles = read.as_euler("ZYX", degrees=True)
    assert np.ptp(angles[:, 0]) > 300.0
    mid, said = held(angles, "deg")
    off = true.inv() * Rotation.from_euler("ZYX", mid, degrees=True)
    assert off.magnitude() < NOISE / 3 and not said


@pytest.mark.parametrize(("unit", "tilt"), [("deg", 89.9), (None, 20.0)])
def test_angles_that_have_no_median_are_those_of_the_middle_row(
    unit: str | None, tilt: float
) -> None:
    true = Rotation.from_euler("ZYX", [10.0, tilt, -30.0], degrees=True)
    angles = (true * (TRUE.inv() * READ)).as_euler("ZYX", degrees=True)
    mid, said = held(angles, unit)
    np.testing.assert_allclose(mid, angles[ROWS // 2], atol=1e-8)
    assert len(said) == 1 and "1 of 1 holds are those of one row" in said[0]


def test_orientations_of_standstills_are_less_noisy_than_their_rows(tmp_path: Path) -> None:
    q, x = logged(dwell=60, way=20)
    robot, rng = load_robot(ur5(), tool="tool0"), np.random.default_rng(7)
    axes = Rotation.from_matrix(robot.placement(q)[:, :3, :3])
    angles = (TURN * axes * Rotation.from_rotvec(NOISE * rng.normal(size=x.shape))).as_euler("ZYX")
    found = brought(tmp_path, q, x, angles)
    assert found.orientation is not None and len(found.orientation.rotation) == len(POSES)
    true = TURN * Rotation.from_matrix(robot.placement(POSES)[:, :3, :3])
    off = (true.inv() * Rotation.from_matrix(found.orientation.rotation)).magnitude()
    assert np.median(off) < NOISE / 2  # of one row: 1.5 times the noise
