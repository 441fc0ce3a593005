"""The closed-loop oracle against plane geometry, the rod's law, and time stepping."""

import numpy as np
import pytest

from tests.oracles.mujoco_sk120 import PAPER_SPRINGS, REFLECTOR, deflect_sk120, sk120_statics
from tests.oracles.table2_reference import jacobian, reach

WRENCH = np.array([300, -400, 500, 80, -60, 40.0])


def straight_arm(angles, wrench):
    """Equilibrium with the wrist straight and rigid, in the coordinates (t1, t2, t3)."""
    loaded = angles.copy()
    for _ in range(40):
        t1 = loaded[0]
        J = jacobian(loaded) * 1e-3
        raises = np.array([np.sin(t1), -np.cos(t1), 0])  # axis of positive elevation
        J = np.vstack([J, np.array([[0.0, 0, 1], [0, 0, 0], raises]).T])
        loaded = angles + J.T @ wrench / np.array(PAPER_SPRINGS)

    def position(q):
        r, z = reach(q[1], q[2])
        return np.array([r * np.cos(q[0]), r * np.sin(q[0]), z]) * 1e-3

    return position(loaded) - position(angles)


def random_poses(count, seed):
    rng = np.random.default_rng(seed)
    poses = []
    while len(poses) < count:
        pose = rng.uniform(np.radians([-180, -70, -115]), np.radians([180, 70, 35]))
        # where crank and rod fall into one line the loop has no unique rest
        if abs(np.cos(pose[1] + pose[2])) > 0.1:
            poses.append(pose)
    return poses


@pytest.mark.parametrize(
    "wrench", [WRENCH, WRENCH * [1, 1, 1, 0, 0, 0], WRENCH * [0, 0, 0, 1, 1, 1]]
)
def test_the_loop_acts_like_a_spring_on_absolute_elevation(wrench):
    for pose in random_poses(12, seed=1):
        result = deflect_sk120([*pose, 0, 0, 0], wrench)
        assert result.closure < 1e-12
        assert np.linalg.norm(result.displacement) > 1e-5
        assert np.allclose(result.displacement, straight_arm(pose, wrench), atol=1e-10)


def test_motors_torques_are_not_those_of_a_serial_elbow():
    # A spring at the elbow itself would give something else: the oracle tells the two apart.
    pose = np.radians([20.0, 30, -20])
    loop = deflect_sk120([*pose, 0, 0, 0], WRENCH).displacement
    J = jacobian(pose) * 1e-3
    relative = J @ np.array([[1.0, 0, 0], [0, 1, 0], [0, -1, 1]])  # elbow angle = t3 + t2 kept
    serial = relative @ (relative.T @ WRENCH[:3] / np.array(PAPER_SPRINGS))
    assert np.linalg.norm(loop - serial) > 1e-4


def test_time_stepping_comes_to_the_same_rest():
    angles = [0.3, 0.5, -0.4, 0.2, -1, 0.4]
    statics = sk120_statics(angles, wrist=(2e5, 3e5, 4e5), point=REFLECTOR)
    exact = statics.deflection(WRENCH)
    stepped = statics.deflection(WRENCH, statics.settle(WRENCH, steps=6000))
    assert np.allclose(stepped.displacement, exact.displacement, atol=1e-8)
    assert np.allclose(stepped.rotation, exact.rotation, atol=1e-8)


def test_wrist_springs_reach_the_rigid_wrist():
    angles = [0.3, 0.5, -0.4, 0.2, -1, 0.4]
    rigid = deflect_sk120(angles, WRENCH, point=REFLECTOR).displacement
    stiff = deflect_sk120(angles, WRENCH, wrist=(1e14,) * 3, point=REFLECTOR).displacement
    soft = deflect_sk120(angles, WRENCH, wrist=(2e5,) * 3, point=REFLECTOR).displacement
    assert np.allclose(rigid, stiff, atol=1e-9)
    assert np.linalg.norm(rigid - soft) > 1e-5


def test_soft_rod_follows_its_law():
    # c_rod / sin^2(gamma) j3 j3^T F, sin(gamma) = cos(t2 + t3), c_rod = 1 / (k 0.542^2)
    pose, force, rod = np.radians([20.0, 30, -50]), np.array([20.0, -30, 40]), 1e8
    wrench = np.append(force, [0, 0, 0])
    soft = deflect_sk120([*pose, 0, 0, 0], wrench, rod=rod).displacement
    rigid = deflect_sk120([*pose, 0, 0, 0], wrench).displacement
    j3 = jacobian(pose)[:, 2] * 1e-3
    law = j3 * (j3 @ force) / (rod * 0.542**2 * np.cos(pose[1] + pose[2]) ** 2)
    assert np.linalg.norm(law) > 1e-6
    assert np.allclose(soft - rigid, law, rtol=1e-3, atol=1e-10)
