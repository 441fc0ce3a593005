"""Sound readings are not doubted: other arms, missing effects, foreign causes, messy noise.

The long table is scripts/11_data_checks.py.
"""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.data_checks.search import find_slip
from sk120stiff.data_checks.sheet import sheet_of
from sk120stiff.measurements import Measurements
from tests.data_checks.readings import ur5
from tests.data_checks.table import blind_readings, sound_readings


def test_drawn_readings_of_other_arms_are_not_doubted() -> None:
    outcomes = list(sound_readings(range(3), ["ur10", "panda", "z1"]))
    assert len(outcomes) == 9
    assert [each for each in outcomes if not each.right] == []


@pytest.mark.parametrize("level", ["L1", "L6", "L7", "L8"])
def test_blind_cases_are_not_doubted(level: str) -> None:
    """Another generator: effects stronger than noise, foreign ones, several at once, outliers."""
    (only,) = blind_readings([level], 1, 4711)
    assert only.said == ""


def uneven(seed: int, poses: int, loads: int) -> Measurements:
    """A dial gauge at few poses: gears a third softer at some angles, loads along one line each."""
    robot, rng = ur5().robot, np.random.default_rng(seed)
    n, rows = robot.n, poses * loads
    q = np.repeat(rng.uniform(-2.3, 2.3, (poses, n)), loads, axis=0)
    way = np.repeat(rng.normal(size=(poses, 3)), loads, axis=0)
    force = way / np.linalg.norm(way, axis=1, keepdims=True)
    force *= np.tile(np.linspace(30.0, 90.0, loads), poses)[:, None]
    J = robot.screws(q).linear_jacobian
    softer = (1.0 + 0.3 * np.sin(3.0 * q + rng.uniform(0.0, 6.0, n))) / (1e4 * rng.uniform(1, 6, n))
    moved = (J @ (softer * (np.swapaxes(J, 1, 2) @ force[:, :, None])[:, :, 0])[:, :, None])[
        :, :, 0
    ]
    moved[:, :2] = np.nan
    return Measurements(
        pose=tuple(f"p{k // loads}" for k in range(rows)),
        joint_names=robot.actuated,
        joints=q,
        wrench=np.hstack([force, np.zeros_like(force)]),
        displacement=moved + 2e-6 * rng.normal(size=moved.shape),
    )


def test_loads_along_one_line_tell_no_more_than_one() -> None:
    """Readings of one axis at seven poses are seven numbers, whatever the law, and no proof."""
    sheet = sheet_of(ur5().robot, uneven(0, poses=7, loads=3))
    assert sheet is not None and sheet.told == 7
    other = sheet_of(ur5().robot, ur5().readings)  # loads in other directions, three axes
    assert other is not None and other.told == other.measured.size


@pytest.mark.parametrize("seed", range(12))
def test_few_readings_of_uneven_gears_are_not_doubted(seed: int) -> None:
    assert find_slip(ur5().robot, uneven(seed, poses=7, loads=4)) is None


def ladders(seed: int, poses: int, zeros: bool) -> Measurements:
    """Weights put on and taken off again; the elbow rubs, its friction a row of sliding blocks."""
    robot, rng = ur5().robot, np.random.default_rng(seed)
    masses = np.array([0.0, 2.0, 4.0, 6.0, 8.0, 6.0, 4.0, 2.0, 0.0])
    low, high = [-1.0, -1.9, 0.3, -2.1, -2.1, -1.5], [1.0, -0.5, 1.9, 0.3, -0.7, 1.5]
    q = rng.uniform(low, high, (poses, 6))
    J = robot.screws(q).linear_jacobian
    parts = []
    for k in range(poses):
        blocks, began = np.zeros(3), None
        for mass in masses:
            torque = J[k].T @ [0.0, 0.0, -9.81 * mass]
            blocks = np.clip(blocks, torque[2] - RUBS[0], torque[2] + RUBS[0])
            turn = torque / (1e4 * np.array([4.2, 3.8, 3.6, 1.3, 1.2, 1.1]))
            turn[2] += blocks @ RUBS[1]
            began = J[k] @ turn if began is None else began
            parts.append(J[k] @ turn - began)
    moved = np.array(parts) + 8e-6 * rng.normal(size=(len(parts), 3))
    load = np.zeros((len(moved), 6))
    load[:, 2] = -9.81 * np.tile(masses, poses)
    return Measurements(
        pose=tuple(f"p{k}" for k in range(poses) for _ in masses),
        joint_names=robot.actuated,
        joints=np.repeat(q, len(masses), axis=0),
        wrench=load,
        displacement=moved,
        use=np.full(len(moved), True) if zeros else load.any(axis=1),
    )


RUBS = np.array([2.0, 6.0, 14.0]), np.array([6e-6, 9e-6, 1.1e-5])  # N·m; rad/(N·m)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("zeros", [True, False])
def test_ladders_of_a_gear_that_rubs_are_no_shifted_rows(seed: int, zeros: bool) -> None:
    """Rows without load part the poses: a move of rows drops what it would have to explain."""
    assert find_slip(ur5().robot, ladders(seed, 9, zeros)) is None


def test_ladders_whose_joints_were_moved_are_told() -> None:
    found = ladders(2, 16, True)
    for shift in (2, -2):  # by one row it would be those without load alone
        joints = np.roll(found.joints, shift, axis=0)
        rows = np.arange(len(joints))
        names = tuple(f"row{k}" for k in rows)
        moved = replace(found, joints=joints, pose=names, zero_group=rows)
        slip = find_slip(ur5().robot, moved)
        assert slip is not None and "the joints seem to stand 2 rows" in slip.said
