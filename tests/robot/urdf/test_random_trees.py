"""Random trees against matrices that share nothing with the product."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import ToolkitWarning
from sk120stiff.robot import STANDARD_GRAVITY, Robot, load_robot
from sk120stiff.stiffness import complementary_stiffness
from tests.oracles.numpy_kinematics import GRAVITY, UrdfTree
from tests.robot.urdf.trees import random_tree

SEEDS = st.integers(0, 2**32 - 1)


def loaded(text: str, tool: str | None = None) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        return load_robot(text, tool=tool)


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_any_tree_is_placed_and_weighed_right(seed: int) -> None:
    text = random_tree(seed)
    robot, oracle = loaded(text), UrdfTree(text)
    a = np.random.default_rng(seed).uniform(-2.0, 2.0, robot.n)
    values = dict(zip(robot.actuated, map(float, a), strict=True))
    for frame in robot.frames:
        error = robot.placement(a, frame) - oracle.placement(values, frame)
        assert np.abs(error).max() < 1e-11, (seed, frame)
    expected = -oracle.gravity_torque(values, list(robot.actuated))
    expected *= STANDARD_GRAVITY / np.linalg.norm(GRAVITY)
    scale = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(robot.gravity_torque(a), expected, atol=1e-8 * scale)


@settings(max_examples=40, deadline=None)
@given(SEEDS)
def test_any_tree_has_the_right_derivatives(seed: int) -> None:
    text = random_tree(seed)
    robot, oracle = loaded(text), UrdfTree(text)
    rng = np.random.default_rng(seed)
    a, point, wrench = rng.uniform(-2.0, 2.0, robot.n), rng.normal(size=3), rng.normal(size=6) * 50
    values = dict(zip(robot.actuated, map(float, a), strict=True))
    expected = oracle.jacobian(values, robot.tool_frame, list(robot.actuated), point)
    np.testing.assert_allclose(robot.jacobian(a, point=point), expected, atol=1e-7)
    K_C = complementary_stiffness(robot.screws(a, point=point), wrench)
    step = 1e-3
    for j in range(robot.n):
        moved = a + step * np.array([[1.0], [-1.0], [2.0], [-2.0]]) * np.eye(robot.n)[j]
        torques = np.einsum("pij,i->pj", robot.jacobian(moved, point=point), wrench)
        slope = (8 * (torques[0] - torques[1]) - (torques[2] - torques[3])) / (12 * step)
        np.testing.assert_allclose(K_C[:, j], slope, atol=1e-5)


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_one_pose_is_a_batch_of_one(seed: int) -> None:
    robot = loaded(random_tree(seed))
    a = np.random.default_rng(seed).uniform(-2.0, 2.0, (2, 3, robot.n))
    batch = robot.placement(a)
    for k in np.ndindex(2, 3):
        np.testing.assert_allclose(batch[k], robot.placement(a[k]), atol=1e-13)


CHAINED = """<robot name="followers"><link name="l0"/><link name="l1"/><link name="l2"/>
<link name="l3"/><link name="l4"/><link name="s1"/><link name="s2"/>
<joint name="a" type="revolute"><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/>
  <mimic joint="b" multiplier="-2" offset="0.1"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<joint name="b" type="continuous"><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
  <mimic joint="c" multiplier="0.5"/></joint>
<joint name="c" type="revolute"><parent link="s1"/><child link="s2"/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="d" type="prismatic"><parent link="l2"/><child link="l3"/><axis xyz="1 0 0"/>
  <mimic joint="b" multiplier="0.2" offset="-0.3"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="e" type="revolute"><parent link="l3"/><child link="l4"/><axis xyz="1 0 0"/>
  <mimic joint="c" multiplier="0" offset="0.7"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="f" type="fixed"><parent link="l0"/><child link="s1"/></joint></robot>"""


def test_followers_in_any_order_across_branches_and_types() -> None:
    robot = loaded(CHAINED, tool="l4")
    assert robot.actuated == ("c",)  # the driver sits on another branch
    joints = robot.joint_values(np.array([0.8]))
    expected = {"a": -2 * 0.4 + 0.1, "b": 0.4, "c": 0.8, "d": 0.2 * 0.4 - 0.3, "e": 0.7}
    assert {name: float(value) for name, value in joints.items()} == pytest.approx(expected)
    oracle = UrdfTree(CHAINED)
    np.testing.assert_allclose(
        robot.placement([0.8]), oracle.placement({"c": 0.8}, "l4"), atol=1e-14
    )


def test_a_chosen_set_is_actuated_and_the_rest_is_locked_where_told() -> None:
    text = random_tree(7, joints=6)
    everything = loaded(text)
    first, *rest = everything.actuated
    held = dict.fromkeys(rest, 0.4)
    robot = load_robot(text, actuated=[first], lock=held)
    a = np.full(everything.n, 0.4)
    a[0] = -1.1
    frame = everything.tool_frame
    np.testing.assert_allclose(
        robot.placement([-1.1], frame), everything.placement(a, frame), atol=1e-14
    )
