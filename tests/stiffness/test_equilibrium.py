"""The exact rest: against a plain fixed-point iteration on matrices, and its own special cases."""

import numpy as np
import pytest

from sk120stiff.errors import Refusal
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import (
    complementary_stiffness,
    equilibrium,
    linear_springs,
)
from tests.oracles.mujoco_serial import deflect_urdf
from tests.oracles.numpy_kinematics import UrdfTree
from tests.stiffness.arms import (
    POINT,
    critical_load,
    mixed_arm,
    mixed_urdf,
    sk120,
    sk120_poses,
    uncoupled,
)

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


def column_at_rest(weight: float, push: float) -> float:
    """Angle of a column of 2 m on a spring of 1000 N·m/rad: P on its top, and a side force."""
    mechanism = load_robot(COLUMN).mechanism()
    load = np.array([push, 0, -weight, 0, 0, 0])
    top = np.array([0.0, 0.0, 2.0])
    return equilibrium(mechanism, np.zeros(1), load, linear_springs([1000.0]), point=top).z[0]


def test_a_column_stands_up_to_its_critical_load_and_not_beyond():
    """A weight P on a column of length L on a spring k stands up to P = k / L."""
    for weight in (450.0, 499.9):
        assert column_at_rest(weight, 0.0) == 0.0
    for weight in (500.1, 600.0, 5000.0):
        with pytest.raises(Refusal, match=f"gives way at {500 / weight:.3g} of this load"):
            column_at_rest(weight, 0.0)


def test_springs_between_whose_lengths_no_balance_lies_are_refused():
    """A law that jumps over the balance sends Newton's method back and forth for ever."""
    mechanism, top = load_robot(COLUMN).mechanism(), np.array([0.0, 0.0, 2.0])
    load = np.array([100.0, 0, 0, 0, 0, 0])

    def law(torques):
        long = torques > 200.0 * np.cos(0.1)  # of the side force, whose lever is 2 m cos θ
        return np.where(long, 0.2, 0.0), np.zeros((*torques.shape, 1))

    with pytest.raises(Refusal, match=r"gives way at 0\.995"):
        equilibrium(mechanism, np.zeros(1), load, law, point=top)


@pytest.mark.parametrize("push", [-1e-3, 1e-3, 1e-5, 0.3])
@pytest.mark.parametrize("weight", [450.0, 500.0, 510.0, 600.0, 900.0, 1200.0])
def test_a_column_that_leans_follows_its_load_to_its_own_side(weight, push):
    """Pushed a little, the column bends away and holds at k θ = P L (sin θ + push cos θ).

    That balance grows from zero with the load and never breaks; the mirrored one and the upright
    one, to which Newton's method may lead from the unloaded pose, are not on its way.
    """
    from scipy.optimize import brentq

    found = column_at_rest(weight, push * weight)

    def off(angle):
        return 1000.0 * angle - 2.0 * weight * (np.sin(angle) + push * np.cos(angle))

    # the one root on the side of the push, where the spring wins at the far end
    side = np.sign(push)
    expected = brentq(off, side * 1e-9, side * np.pi, xtol=1e-14)
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 2, 3, 4, 5])
def test_beyond_buckling_arms_come_to_rest_where_bodies_do(seed):
    """K_θ − K_C indefinite at the unloaded pose, yet stable on the way from zero: as in MuJoCo."""
    text = uncoupled(mixed_urdf(seed)).replace('type="prismatic"', 'type="revolute"')
    robot, tree = load_robot(text, base="l0", tool="l7"), UrdfTree(text)
    rng = np.random.default_rng(seed)
    a, springs = rng.uniform(-0.5, 0.5, 7), rng.uniform(2e3, 4e3, 7)
    mechanism = robot.mechanism()
    screws = mechanism.screws(a, POINT)
    # The load that bends the arm least at first of those that make it unstable soonest.
    forces = rng.normal(size=(200, 3))
    forces /= np.linalg.norm(forces, axis=1, keepdims=True)
    loads = np.concatenate([forces, np.zeros((200, 3))], axis=1)
    critical = critical_load(screws, springs, loads)
    load = loads[np.argmin(critical)] * 1.15 * critical.min()
    K_C = complementary_stiffness(screws, load)
    assert np.linalg.eigvalsh(np.diag(springs) - 0.5 * (K_C + K_C.T))[0] < 0.0
    rest = equilibrium(mechanism, a, load, linear_springs(springs), point=POINT)
    values = dict(zip(robot.actuated, a, strict=True))
    elastic = dict(zip(robot.actuated, springs, strict=True))
    bodies = deflect_urdf(tree, "l7", values, elastic, load, POINT)
    assert np.linalg.norm(bodies.displacement) > 0.1
    assert np.allclose(rest.screws.position - screws.position, bodies.displacement, atol=1e-7)
