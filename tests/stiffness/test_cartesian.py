"""Stiffness and compliance of a point: inverses of each other where both exist."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import Refusal
from sk120stiff.stiffness import (
    cartesian_compliance,
    cartesian_stiffness,
    complementary_stiffness,
    definiteness,
    principal_stiffness,
    spring_matrix,
)
from tests.stiffness.arms import PAPER_SPRINGS, sk120, sk120_poses

LOAD = np.array([3000.0, -4000.0, 5000.0, 0, 0, 0])


def sk120_parts(poses):
    screws = sk120().robot.screws(poses)
    K_C = complementary_stiffness(screws, LOAD)[..., :3, :3]
    return screws.linear_jacobian[..., :3], spring_matrix(PAPER_SPRINGS), K_C


def test_stiffness_and_compliance_are_inverses():
    J, K_theta, K_C = sk120_parts(sk120_poses(20, 1))
    for K in (K_theta, K_theta - K_C):
        K_X, C_X = cartesian_stiffness(J, K), cartesian_compliance(J, K)
        assert np.allclose(K_X @ C_X, np.eye(3), rtol=0, atol=1e-9)


def test_a_planar_arm_by_hand():
    """Two links at a right angle, 1 m and 0.5 m: J = [[-0.5, -0.5], [1, 0]]."""
    J, K = np.array([[-0.5, -0.5], [1.0, 0.0]]), np.diag([2e5, 1e5])
    by_hand = np.array([[0.25 / 2e5 + 0.25 / 1e5, -0.5 / 2e5], [-0.5 / 2e5, 1 / 2e5]])
    assert np.allclose(cartesian_compliance(J, K), by_hand, rtol=1e-14)
    assert np.allclose(cartesian_stiffness(J, K), np.linalg.inv(by_hand), rtol=1e-12)


def test_singular_poses_have_a_compliance_and_no_stiffness():
    # upper arm and forearm's line from elbow to flange fall into one line: the arm is stretched
    t2 = 0.3
    t3 = np.pi / 2 - t2 - np.arctan2(0.25, 1.53)
    poses = np.zeros((3, 6))
    poses[:, 1], poses[:, 2] = t2, [t3, t3 - 0.3, t3]
    J, K_theta, K_C = sk120_parts(poses)
    smallest = np.linalg.svd(J, compute_uv=False)[:, -1]
    assert (smallest[[0, 2]] < 1e-12).all() and smallest[1] > 0.05
    C_X = cartesian_compliance(J, K_theta - K_C)
    assert np.isfinite(C_X).all()
    assert np.linalg.matrix_rank(C_X[0], tol=1e-15) == 2
    K_X = cartesian_stiffness(J, K_theta - K_C)
    assert np.isnan(K_X[[0, 2]]).all() and np.isfinite(K_X[1]).all()
    alone = cartesian_stiffness(J[1], (K_theta - K_C)[1])
    assert np.allclose(K_X[1], alone, rtol=1e-12)
    principal = principal_stiffness(C_X)
    assert np.isinf(principal.values[[0, 2], -1]).all()
    assert np.isfinite(principal.values[:, :2]).all() and np.isfinite(principal.values[1]).all()


def test_six_directions_of_three_springs_have_a_compliance_only():
    arm = sk120()
    J = arm.robot.jacobian(sk120_poses(4, 3))[..., :3]  # (4, 6, 3)
    C_X = cartesian_compliance(J, spring_matrix(PAPER_SPRINGS))
    assert C_X.shape == (4, 6, 6)
    assert np.allclose(C_X[:, :3, :3], cartesian_compliance(J[:, :3], spring_matrix(PAPER_SPRINGS)))
    with pytest.raises(ValueError, match="square"):
        cartesian_stiffness(J, spring_matrix(PAPER_SPRINGS))


def test_the_full_six_by_six_of_six_springs():
    arm = sk120()
    poses = sk120_poses(5, 4)
    poses[:, 4] = -0.8  # away from the wrist's own singularity
    springs = np.array([*PAPER_SPRINGS, 3e5, 2e5, 1e5])
    screws = arm.robot.screws(poses)
    load = np.array([300, -400, 500, 80, -60, 140.0])
    K = spring_matrix(springs) - complementary_stiffness(screws, load)
    K_X = cartesian_stiffness(screws.jacobian, K)
    C_X = cartesian_compliance(screws.jacobian, K)
    assert K_X.shape == (5, 6, 6)
    # rows in N/m and N·m/rad: each identity is checked in the units of its own rows
    assert np.allclose(K_X @ C_X, np.eye(6), rtol=0, atol=1e-6)


def test_an_exactly_critical_load_is_refused():
    J = np.array([[2.0, 0.0], [0.0, 1.0]])
    with pytest.raises(Refusal, match="critical"):
        cartesian_compliance(J, np.diag([1e5, 1e5]) - np.diag([1e5, 0.0]))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), size=st.floats(1e3, 1e7))
def test_definiteness_survives_the_change_of_coordinates(seed, size):
    """Appendix II: K_X has the class of K_theta - K_C, however large the load."""
    rng = np.random.default_rng(seed)
    screws = sk120().robot.screws(sk120_poses(10, seed % 7))
    load = np.concatenate([size * rng.normal(size=3), np.zeros(3)])
    K = spring_matrix(PAPER_SPRINGS) - complementary_stiffness(screws, load)[:, :3, :3]
    K_X = cartesian_stiffness(screws.linear_jacobian[..., :3], K)
    assert np.array_equal(definiteness(K_X), definiteness(K))


def test_one_spring_matrix_for_many_poses_and_many_for_one():
    J, K_theta, K_C = sk120_parts(sk120_poses(4, 6))
    whole = cartesian_compliance(J, K_theta)
    assert np.allclose(whole[2], cartesian_compliance(J[2], K_theta), rtol=1e-13)
    many = cartesian_compliance(J[0], K_theta - K_C)
    assert np.allclose(many[3], cartesian_compliance(J[0], (K_theta - K_C)[3]), rtol=1e-13)
    assert spring_matrix(np.ones((2, 5, 3))).shape == (2, 5, 3, 3)
