"""K_C against differences of torques that matrices alone produce, and against a column by hand."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.robot import LinearCoupling, Mechanism, load_robot
from sk120stiff.robot.kinematics.coupling import Curvature, JointMotion
from sk120stiff.stiffness import complementary_stiffness, gravity_stiffness, symmetric_part
from tests.stiffness.arms import (
    POINT,
    critical_load,
    mixed_arm,
    mixed_urdf,
    sk120,
    sk120_poses,
    uncoupled,
)

FORCE = np.array([300, -400, 500, 0, 0, 0.0])
MOMENT = np.array([0, 0, 0, 80, -60, 140.0])
arms = st.integers(0, 5).map(mixed_arm)
numbers = st.floats(-1.0, 1.0, allow_subnormal=False)


wrenches = st.lists(numbers, min_size=6, max_size=6).map(
    lambda w: np.array([500.0] * 3 + [200.0] * 3) * np.array(w)
)


def test_a_column_under_compression_by_hand():
    """A bar of 2 m on a hinge, pressed towards the hinge by 1 kN: torque F L sin q, slope + F L."""
    text = (
        '<robot name="column"><link name="ground"/><link name="bar"/><link name="tip"/>'
        '<joint name="hinge" type="revolute"><parent link="ground"/><child link="bar"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        '<joint name="end" type="fixed"><parent link="bar"/><child link="tip"/>'
        '<origin xyz="0 0 2"/></joint></robot>'
    )
    robot = load_robot(text, base="ground", tool="tip")
    press = np.array([0, 0, -1000, 0, 0, 0.0])
    for q in (0.0, 0.4, -1.2):
        K_C = complementary_stiffness(robot.screws([q]), press)
        assert K_C.shape == (1, 1)
        assert K_C[0, 0] == pytest.approx(2000 * np.cos(q), rel=1e-12)
    upright = robot.screws([0.0])
    # It buckles at K / L under compression, and never under tension.
    assert critical_load(upright, np.array([5e4]), press / 1000) == pytest.approx(25e3)
    assert critical_load(upright, np.array([5e4]), -press / 1000) == np.inf


@settings(max_examples=25, deadline=None)
@given(arm=arms, seed=st.integers(0, 10_000), wrench=wrenches)
def test_slope_of_the_torques(arm, seed, wrench):
    (a,) = arm.poses(1, seed)
    K_C = complementary_stiffness(arm.robot.screws(a, point=POINT), wrench)
    assert np.allclose(K_C, arm.torque_slope(a, wrench), rtol=0, atol=1e-3)


@pytest.mark.parametrize("wrench", [FORCE, MOMENT, FORCE + MOMENT])
def test_slope_of_the_torques_on_the_parallelogram(wrench):
    arm = sk120()
    for a in sk120_poses(3, seed=2):
        K_C = complementary_stiffness(arm.robot.screws(a, point=POINT), wrench)
        slope = arm.torque_slope(a, wrench)
        assert np.allclose(K_C, slope, rtol=0, atol=1e-5)
        assert np.max(np.abs(K_C)) > 50


@settings(max_examples=25, deadline=None)
@given(arm=arms, seed=st.integers(0, 10_000), wrench=wrenches)
def test_a_force_gives_a_symmetric_part_and_a_moment_a_skew_one_with_it(arm, seed, wrench):
    (a,) = arm.poses(1, seed)
    screws = arm.robot.screws(a, point=POINT)
    force, moment = wrench * ([1] * 3 + [0] * 3), wrench * ([0] * 3 + [1] * 3)
    of_force, of_moment = (complementary_stiffness(screws, w) for w in (force, moment))
    assert np.allclose(of_force, of_force.T, rtol=0, atol=1e-10)
    whole = complementary_stiffness(screws, wrench)
    assert np.allclose(whole, of_force + of_moment, rtol=0, atol=1e-10)
    assert np.allclose(symmetric_part(whole), (whole + whole.T) / 2, rtol=0, atol=1e-12)


def test_a_moment_has_no_symmetric_stiffness():
    arm = mixed_arm(0)
    K_C = complementary_stiffness(arm.robot.screws(arm.poses(1, 3)[0]), MOMENT)
    assert np.max(np.abs(K_C - K_C.T)) > 10


def test_the_force_part_has_a_potential():
    """dK_C[i,j]/dq_k is the same for every order of i, j, k: third derivatives of -F.x."""
    arm, step = mixed_arm(1), 1e-4
    (a,) = arm.poses(1, 8)
    third = np.array(
        [
            complementary_stiffness(arm.robot.screws(a + e), FORCE)
            - complementary_stiffness(arm.robot.screws(a - e), FORCE)
            for e in step * np.eye(arm.n)
        ]
    ) / (2 * step)
    assert np.max(np.abs(third)) > 50
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1)):
        assert np.allclose(third, third.transpose(order), rtol=0, atol=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_coupling_is_a_congruence(seed):
    """K_C of the coupled arm is A^T K_C A, with K_C of the arm that has a motor in every joint."""
    arm = mixed_arm(seed)
    free = load_robot(uncoupled(mixed_urdf(seed)), base="l0", tool="l7")
    assert (arm.n, free.n) == (5, 7)
    A = np.array(  # columns j0 j1 j2 j4 j6; rows j0..j6, j3 = 0.2 - j0, j5 = 0.7 j4 - 0.1
        [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [-1, 0, 0, 0, 0],
         [0, 0, 0, 1, 0], [0, 0, 0, 0.7, 0], [0, 0, 0, 0, 1]]
    )  # fmt: skip
    b = np.array([0, 0, 0, 0.2, 0, -0.1, 0])
    for a in arm.poses(4, seed):
        ours = complementary_stiffness(arm.robot.screws(a, point=POINT), FORCE + MOMENT)
        whole = complementary_stiffness(free.screws(A @ a + b, point=POINT), FORCE + MOMENT)
        assert np.allclose(ours, A.T @ whole @ A, rtol=0, atol=1e-9)


@dataclass(frozen=True)
class Cam:
    """A closure that is not linear: the second joint follows sin of the first, with a slide."""

    n: int = 3

    def motion(self, a: np.ndarray) -> JointMotion:
        q = np.stack([a[..., 0], np.sin(a[..., 0]) + a[..., 1], a[..., 1] * a[..., 2]], axis=-1)
        first, second = np.zeros((*a.shape[:-1], 3, 3)), np.zeros((*a.shape[:-1], 3, 3, 3))
        first[..., 0, 0] = first[..., 1, 1] = 1.0
        first[..., 1, 0] = np.cos(a[..., 0])
        first[..., 2, 1], first[..., 2, 2] = a[..., 2], a[..., 1]
        second[..., 1, 0, 0] = -np.sin(a[..., 0])
        second[..., 2, 1, 2] = second[..., 2, 2, 1] = 1.0
        everything = np.arange(3)
        return JointMotion(q, first, Curvature(everything, everything, second))


def test_a_curved_closure_adds_torque_times_curvature():
    chain = load_robot(uncoupled(mixed_urdf(2)), base="l0", tool="l3").mechanism().chain
    cam = Mechanism(chain, Cam())
    straight = Mechanism(chain, LinearCoupling(np.eye(3), np.zeros(3)))
    wrench, step = FORCE + MOMENT, 1e-5
    for a in np.random.default_rng(0).uniform(-1, 1, (4, 3)):
        slope = np.array(
            [
                (cam.screws(a + e).torques(wrench) - cam.screws(a - e).torques(wrench)) / (2 * step)
                for e in step * np.eye(3)
            ]
        ).T
        K_C = complementary_stiffness(cam.screws(a), wrench)
        assert np.allclose(K_C, slope, rtol=0, atol=1e-5)
        motion = Cam().motion(a)
        bare = complementary_stiffness(straight.screws(motion.q), wrench)
        assert np.max(np.abs(K_C - motion.first.T @ bare @ motion.first)) > 1.0


def test_batch_is_the_loop():
    arm = mixed_arm(3)
    poses = arm.poses(6, 1).reshape(2, 3, arm.n)
    loads = np.random.default_rng(4).normal(size=(2, 3, 6)) * 300
    whole = complementary_stiffness(arm.robot.screws(poses, point=POINT), loads)
    assert whole.shape == (2, 3, arm.n, arm.n)
    for index in np.ndindex(2, 3):
        one = complementary_stiffness(arm.robot.screws(poses[index], point=POINT), loads[index])
        assert np.allclose(whole[index], one, rtol=0, atol=1e-11)
    one_pose = complementary_stiffness(arm.robot.screws(poses[0, 0], point=POINT), loads[0])
    assert np.allclose(one_pose[0], whole[0, 0], rtol=0, atol=1e-11)


def test_no_load_no_stiffness():
    arm = mixed_arm(0)
    assert not complementary_stiffness(arm.robot.screws(arm.poses(3, 0)), np.zeros(6)).any()


@cache
def _seen(kind: str):
    """Joints that several coordinates move, some that one moves and that weigh, a bent closure."""
    if kind == "cam":
        chain = load_robot(uncoupled(mixed_urdf(2)), base="l0", tool="l3").mechanism().chain
        return Mechanism(chain, Cam()).screws(np.array([0.4, -0.3, 0.7]))
    robot = load_robot("ur5e") if kind == "ur5e" else mixed_arm(3).robot
    return robot.screws(np.linspace(-0.7, 0.9, robot.n), point=POINT)


@given(st.sampled_from(["mixed", "ur5e", "cam"]), wrenches, st.data())
def test_some_rows_are_those_of_the_whole(kind, wrench, data):
    screws = _seen(kind)
    n = screws.first.shape[-1]
    rows = np.array(data.draw(st.lists(st.integers(0, n - 1), min_size=1, unique=True)))
    assert (screws.second is not None, screws.carried is not None) == (
        kind == "cam",
        kind == "ur5e",
    )
    for whole, some in (
        (complementary_stiffness(screws, wrench), complementary_stiffness(screws, wrench, rows)),
        (gravity_stiffness(screws, [0, 2, -9.81]), gravity_stiffness(screws, [0, 2, -9.81], rows)),
    ):
        assert some.shape == (len(rows), n)
        assert np.allclose(some, whole[rows], rtol=0, atol=1e-12 * np.abs(whole).max(initial=1.0))
