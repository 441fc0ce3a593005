import numpy as np
import pytest

from sk120stiff.robot.rotations import rotation_from_rpy, rotation_vector
from sk120stiff.workspace import Task, solve_inverse, starting_poses
from tests.oracles.numpy_kinematics import rotation
from tests.workspace.arms import sk120, skew_arm


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 2.0, np.pi - 1e-7, np.pi])
def test_rotation_vector_inverts_rodrigues_formula(angle: float) -> None:
    rng = np.random.default_rng(1)
    for axis in rng.normal(size=(20, 3)):
        unit = axis / np.linalg.norm(axis)
        found = rotation_vector(rotation(unit, angle))
        np.testing.assert_allclose(rotation(unit, angle), _exponential(found), atol=1e-8)
        assert np.linalg.norm(found) == pytest.approx(angle, abs=1e-7)


def _exponential(vector: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(vector)
    return np.eye(3) if angle == 0.0 else rotation(vector / angle, float(angle))


def test_roll_pitch_yaw_are_a_urdfs() -> None:
    by_axes = rotation([0, 0, 1], 0.5) @ rotation([0, 1, 0], -0.4) @ rotation([1, 0, 0], 0.3)
    np.testing.assert_allclose(rotation_from_rpy(np.array([0.3, -0.4, 0.5])), by_axes, atol=1e-15)


@pytest.mark.parametrize("arm", [sk120, skew_arm])
@pytest.mark.parametrize("kind", ["position", "axis", "orientation"])
def test_postures_that_exist_are_found(arm, kind: str) -> None:
    arm = arm()
    lower, upper = np.maximum(arm.lower, -2.5), np.minimum(arm.upper, 2.5)
    goal = np.random.default_rng(4).uniform(lower, upper, (60, arm.n))
    where = arm.kinematics(goal)
    task = Task(
        where.position,
        axis=where.rotation[:, :, 2] if kind == "axis" else None,
        rotation=where.rotation if kind == "orientation" else None,
    )
    found = np.zeros(60, dtype=bool)
    for start in starting_poses(arm, 16, np.zeros(arm.n)):
        tried = solve_inverse(arm, task, np.tile(start, (60, 1)))
        met = tried.found
        there = arm.kinematics(tried.a[met])
        assert arm.within_limits(tried.a[met]).all()
        np.testing.assert_allclose(there.position, where.position[met], atol=2e-9)
        if kind == "axis":
            np.testing.assert_allclose(
                there.rotation[..., 2], where.rotation[met][..., 2], atol=1e-8
            )
        if kind == "orientation":
            np.testing.assert_allclose(there.rotation, where.rotation[met], atol=1e-8)
        found |= met
    assert found.mean() > 0.95


def test_nothing_is_found_where_nothing_is() -> None:
    arm = sk120()
    task = Task(np.array([[5.0, 0.0, 0.0], [1.8, 0.0, 0.3]]))
    tried = solve_inverse(arm, task, np.zeros((2, arm.n)))
    assert tried.found.tolist() == [False, True]
