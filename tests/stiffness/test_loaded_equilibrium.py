"""The golden test: the stiffness of a loaded arm is the enhanced one, and not the conventional one.

The slope of the exact deflection over the load is measured by differences, of our own equilibrium
and of MuJoCo's, which knows nothing of K_C, of Jacobians that turn, or of coupled coordinates.
"""

import numpy as np
import pytest

from sk120stiff.robot import load_robot
from sk120stiff.stiffness import (
    cartesian_compliance,
    cartesian_stiffness,
    complementary_stiffness,
    equilibrium,
    linear_springs,
    spring_matrix,
)
from tests.oracles.mujoco_serial import serial_statics, springs_of
from tests.oracles.mujoco_sk120 import sk120_statics
from tests.oracles.numpy_kinematics import UrdfTree, transform
from tests.oracles.sample_urdfs import six_axis_arm
from tests.stiffness.arms import PAPER_SPRINGS, POINT, mixed_arm, sk120, sk120_poses

# Thirty kilonewtons are a twelfth of what is critical for the SK120: K_C matters by percents.
VAST = np.array([15e3, -18e3, 18e3, 0, 0, 0])
HEAVY = VAST / 3
TWIST = np.array([0, 0, 0, 3000.0, -2000.0, 2500.0])


def slope(position, load, step):
    """(3, k) of a position by the load along each row of `load`, by fourth-order differences."""
    columns = []
    for e in step * load:
        near, far = position(e) - position(-e), position(2 * e) - position(-2 * e)
        columns.append((8 * near - far) / (12 * step))
    return np.array(columns).T


def relative(found, expected):
    return np.max(np.abs(found - expected)) / np.max(np.abs(expected))


def at_rest(mechanism, a, load, springs):
    return equilibrium(mechanism, a, load, linear_springs(springs), point=POINT)


@pytest.mark.parametrize("load", [VAST, -VAST, VAST + TWIST])
def test_stiffness_of_the_loaded_sk120_is_the_enhanced_one(load):
    arm = sk120()
    K_theta = spring_matrix(PAPER_SPRINGS)
    for a in sk120_poses(5, seed=11):

        def position(extra, a=a):
            return at_rest(arm.mechanism, a, load + extra, arm.springs).screws.position

        measured = slope(position, np.eye(6)[:3], 50.0)  # (3, 3) [m/N]
        rest = at_rest(arm.mechanism, a, load, arm.springs)
        J = rest.screws.linear_jacobian[:, :3]
        K_C = complementary_stiffness(rest.screws, load)[:3, :3]
        assert relative(cartesian_compliance(J, K_theta - K_C), measured) < 1e-6
        K_X = np.linalg.inv(measured)
        assert relative(cartesian_stiffness(J, K_theta - K_C), K_X) < 1e-6
        without = relative(cartesian_compliance(J, K_theta), measured)
        assert without > 0.01
        # and the sign of K_C is the right one: the other way round the error about doubles
        assert relative(cartesian_compliance(J, K_theta + K_C), measured) > 1.6 * without


@pytest.mark.parametrize("seed", range(4))
def test_compliance_of_a_loaded_arm_with_slides_and_moments(seed):
    """All six directions of load; the moment makes the compliance unsymmetric."""
    arm, load = mixed_arm(seed), HEAVY + TWIST
    (a,) = arm.poses(1, seed)

    def position(extra):
        return at_rest(arm.mechanism, a, load + extra, arm.springs).screws.position

    measured = slope(position, np.eye(6), 20.0)  # (3, 6)
    rest = at_rest(arm.mechanism, a, load, arm.springs)
    K_theta, J = spring_matrix(arm.springs), rest.screws.jacobian
    K_C = complementary_stiffness(rest.screws, load)
    assert np.allclose(rest.K_C, K_C, rtol=0, atol=1e-8)
    assert relative(cartesian_compliance(J, K_theta - K_C)[:3], measured) < 1e-6
    assert relative(cartesian_compliance(J, K_theta)[:3], measured) > 0.01
    assert relative(cartesian_compliance(J, K_theta - K_C.T)[:3], measured) > 1e-4


def test_stiffness_of_the_closed_loop_of_bodies_is_the_enhanced_one():
    """MuJoCo holds the five-bar by a constraint; our arm has coupled coordinates instead."""
    arm, load = sk120(), VAST + TWIST
    for a in sk120_poses(2, seed=5):
        statics = sk120_statics(a, point=POINT)

        def position(extra, statics=statics):
            return statics.deflection(load + extra).position

        measured = slope(position, np.eye(6)[:3], 100.0)
        rest = at_rest(arm.mechanism, a, load, arm.springs)
        J = rest.screws.linear_jacobian[:, :3]
        K_C = complementary_stiffness(rest.screws, load)[:3, :3]
        K_theta = spring_matrix(PAPER_SPRINGS)
        assert relative(cartesian_compliance(J, K_theta - K_C), measured) < 1e-6
        assert relative(cartesian_compliance(J, K_theta), measured) > 0.01


def test_stiffness_of_a_serial_arm_of_bodies_is_the_enhanced_one():
    text = six_axis_arm()
    robot, tree = load_robot(text, base="base", tool="tool"), UrdfTree(text)
    springs = np.array([1e6, 5e5, 4e5, 1e5, 1e5, 5e4])
    a = np.array([0.4, -0.3, 0.6, 0.9, -0.5, 0.2])
    values = dict(zip(robot.actuated, a, strict=True))
    chain, tip = springs_of(tree, "tool", values, dict(zip(robot.actuated, springs, strict=True)))
    statics = serial_statics(chain, tip @ transform(POINT))
    load = 0.2 * (HEAVY + TWIST)
    measured = slope(lambda extra: statics.deflection(load + extra).position, np.eye(6), 50.0)
    rest = at_rest(robot.mechanism(), a, load, springs)
    K_C = complementary_stiffness(rest.screws, load)
    J = rest.screws.jacobian
    assert relative(cartesian_compliance(J, np.diag(springs) - K_C)[:3], measured) < 1e-6
    assert relative(cartesian_compliance(J, np.diag(springs))[:3], measured) > 0.002
