"""The exact rest: against a plain fixed-point iteration on matrices, and its own special cases."""

import numpy as np
import pytest

from sk120stiff.errors import Refusal
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import complementary_stiffness, equilibrium, linear_springs
from tests.stiffness.arms import POINT, mixed_arm, sk120, sk120_poses

LOAD = np.array([2000.0, 1500.0, -1000.0, 300.0, -200.0, 100.0])
ELSEWHERE = np.array([-0.3, 0.1, 0.2])


def iterated(arm, a, elongation, point):
    """z = a + e(J(z)^T W) by plain iteration, which contracts: the loads are small."""
    z = a.copy()
    for _ in range(60):
        z = a + elongation(arm.torques(z, LOAD, point))
    return z


@pytest.mark.parametrize("seed", range(3))
def test_rest_of_springs(seed):
    arm = mixed_arm(seed)
    (a,) = arm.poses(1, seed)
    rest = equilibrium(arm.mechanism, a, LOAD, linear_springs(arm.springs), point=POINT)
    plain = iterated(arm, a, lambda t: t / arm.springs, POINT)
    assert np.linalg.norm(plain - a) > 1e-3
    assert np.allclose(rest.z, plain, rtol=0, atol=1e-11)
    assert np.allclose(rest.torques, arm.torques(plain, LOAD), rtol=0, atol=1e-6)


def test_the_force_may_act_elsewhere():
    arm = mixed_arm(1)
    (a,) = arm.poses(1, 4)
    law = linear_springs(arm.springs)
    rest = equilibrium(arm.mechanism, a, LOAD, law, point=POINT, force_point=ELSEWHERE)
    plain = iterated(arm, a, lambda t: t / arm.springs, ELSEWHERE)
    assert np.allclose(rest.z, plain, rtol=0, atol=1e-11)
    assert np.allclose(rest.screws.position, arm.position(plain, POINT), rtol=0, atol=1e-11)
    there = complementary_stiffness(arm.robot.screws(rest.z, point=ELSEWHERE), LOAD)
    assert np.allclose(rest.K_C, there, rtol=0, atol=1e-8)
    same = equilibrium(arm.mechanism, a, LOAD, law, point=POINT)
    assert np.max(np.abs(same.z - rest.z)) > 1e-5


def test_springs_that_harden():
    """e = t / K - c t^3: any law will do, Newton takes its slope from the law itself."""
    arm = mixed_arm(2)
    (a,) = arm.poses(1, 7)
    softening = 2e-14

    def law(torques):
        slope = 1.0 / arm.springs - 3 * softening * torques**2
        return torques / arm.springs - softening * torques**3, slope[..., None] * np.eye(arm.n)

    rest = equilibrium(arm.mechanism, a, LOAD, law, point=POINT)
    plain = iterated(arm, a, lambda t: t / arm.springs - softening * t**3, POINT)
    assert np.allclose(rest.z, plain, rtol=0, atol=1e-11)
    linear = equilibrium(arm.mechanism, a, LOAD, linear_springs(arm.springs), point=POINT)
    assert np.max(np.abs(linear.z - rest.z)) > 1e-6


def test_rigid_coordinates_do_not_move():
    arm = sk120()
    poses = sk120_poses(4, 8)
    rest = equilibrium(arm.mechanism, poses, LOAD, linear_springs(arm.springs), point=POINT)
    assert np.array_equal(rest.z[:, 3:], poses[:, 3:])
    nearly = np.where(np.isfinite(arm.springs), arm.springs, 1e16)
    stiff = equilibrium(arm.mechanism, poses, LOAD, linear_springs(nearly), point=POINT)
    assert np.allclose(rest.z, stiff.z, rtol=0, atol=1e-11)
    only = equilibrium(
        arm.mechanism, poses, LOAD, linear_springs(arm.springs), point=POINT, soft=np.arange(3)
    )
    assert np.allclose(only.z, rest.z, rtol=0, atol=1e-14)


def test_no_load_no_motion():
    arm = mixed_arm(0)
    a = arm.poses(3, 0)
    rest = equilibrium(arm.mechanism, a, np.zeros(6), linear_springs(arm.springs))
    assert np.array_equal(rest.z, a) and rest.iterations == 0


def test_batch_is_the_loop():
    arm = mixed_arm(3)
    poses = arm.poses(6, 2).reshape(2, 3, arm.n)
    loads = LOAD * np.linspace(-1, 1, 6).reshape(2, 3, 1)
    law = linear_springs(arm.springs)
    whole = equilibrium(arm.mechanism, poses, loads, law, point=POINT)
    for index in np.ndindex(2, 3):
        one = equilibrium(arm.mechanism, poses[index], loads[index], law, point=POINT)
        assert np.allclose(whole.z[index], one.z, rtol=0, atol=1e-13)
        assert np.allclose(whole.K_C[index], one.K_C, rtol=0, atol=1e-8)


def test_no_rest_is_a_refusal_and_not_a_number():
    arm = mixed_arm(0)
    with pytest.raises(Refusal, match="no static equilibrium"):
        equilibrium(arm.mechanism, arm.poses(1, 0)[0], 1e6 * LOAD, linear_springs(arm.springs))


COLUMN = """<robot name="column"><link name="floor"/><link name="top"/>
<joint name="hinge" type="revolute"><parent link="floor"/><child link="top"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint></robot>"""


@pytest.mark.parametrize("push", [0.0, 1e-3])
def test_a_column_that_would_tip_over_is_no_rest(push):
    """A weight P on a column of 2 m on a spring k stands up to P = k / 2 m and not beyond."""
    mechanism = load_robot(COLUMN).mechanism()
    top, spring = np.array([0.0, 0.0, 2.0]), linear_springs([1000.0])

    def rest(weight):
        load = np.array([push * weight, 0, -weight, 0, 0, 0])
        return equilibrium(mechanism, np.zeros(1), load, spring, point=top).z[0]

    assert abs(rest(450.0)) < 0.1
    with pytest.raises(Refusal, match="not stable"):
        rest(600.0)
