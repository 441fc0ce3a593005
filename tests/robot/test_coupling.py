"""Mimic rules composed into q = A a + b, against values traced by hand and by plain matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.errors import InputError
from sk120stiff.robot import VirtualJoint, load_robot
from sk120stiff.robot.kinematics.coupling import Follower, linear_coupling
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.sample_urdfs import mimic_tree

NAMES = ["a", "b", "c", "d"]


def test_rules_in_any_order_are_composed():
    rules = {"a": Follower("b", -2.0, 0.5), "b": Follower("d", 3.0, 0.1)}
    found = linear_coupling(NAMES, ["d"], rules, {"c": 0.7})
    # a = −2 b + 0.5 with b = 3 d + 0.1; c is locked
    assert np.allclose(found.A, [[-6.0], [3.0], [0.0], [1.0]])
    assert np.allclose(found.b, [0.3, 0.1, 0.7, 0.0])
    assert (found.n, found.m) == (1, 4)
    motion = found.motion(np.array([[0.2], [-1.0]]))
    assert np.allclose(motion.q, [[-0.9, 0.7, 0.7, 0.2], [6.3, -2.9, 0.7, -1.0]])
    assert motion.second is None and motion.first.shape == (4, 1)


def test_followers_of_a_locked_joint_stand_still():
    found = linear_coupling(NAMES, ["d"], {"a": Follower("b", 2.0, 1.0)}, {"b": 0.25})
    assert np.allclose(found.A[0], 0.0) and np.isclose(found.b[0], 1.5)


def test_a_multiplier_of_zero_holds_the_joint():
    found = linear_coupling(NAMES, ["d"], {"a": Follower("d", 0.0, 0.4)}, {})
    assert np.allclose(found.motion(np.array([9.0])).q, [0.4, 0, 0, 9.0])


def test_actuated_joints_keep_their_order():
    found = linear_coupling(NAMES, ["c", "a"], {"b": Follower("c", 1.0, 0.0)}, {})
    assert np.allclose(found.motion(np.array([1.0, 2.0])).q, [2.0, 1.0, 1.0, 0.0])


def test_circles_are_named():
    rules = {"a": Follower("b", 1.0, 0.0), "b": Follower("c", 1.0, 0.0), "c": Follower("b", 1, 0)}
    with pytest.raises(InputError, match="circle: b → c → b") as caught:
        linear_coupling(NAMES, ["d"], rules, {})
    assert caught.value.remedy


def test_unknown_drivers_are_named():
    with pytest.raises(InputError, match="mimics 'x'") as caught:
        linear_coupling(NAMES, ["d"], {"a": Follower("x", 1.0, 0.0)}, {})
    assert "a, b, c, d" in caught.value.remedy


def test_chained_mimics_of_a_urdf_agree_with_matrices():
    robot, tree = load_robot(mimic_tree(), base="a", tool="f"), UrdfTree(mimic_tree())
    assert set(robot.actuated) == {"z", "s"}
    for pose in np.random.default_rng(0).uniform(-2, 2, (10, 2)):
        values = dict(zip(robot.actuated, pose, strict=True))
        for name, value in robot.joint_values(pose).items():
            assert np.isclose(value, tree.value(name, values), atol=1e-14)
        assert np.allclose(robot.placement(pose), tree.placement(values, "f", "a"), atol=1e-13)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_forest_of_rules_is_linear(data):
    """Each joint follows an earlier one or nothing; values are those of the rules one by one."""
    count = data.draw(st.integers(2, 9))
    names = [f"j{k}" for k in range(count)]
    order = data.draw(st.permutations(names))
    number = st.floats(-3, 3)
    rules, values, free = {}, {}, []
    for k, name in enumerate(order):
        if k and data.draw(st.booleans()):
            driver = data.draw(st.sampled_from(order[:k]))
            rules[name] = Follower(driver, data.draw(number), data.draw(number))
            values[name] = rules[name].multiplier * values[driver] + rules[name].offset
        else:
            values[name] = data.draw(number)
            free.append(name)
    found = linear_coupling(names, free, rules, {})
    q = found.motion(np.array([values[name] for name in free])).q
    assert np.allclose(q, [values[name] for name in names], rtol=1e-12, atol=1e-9)


def test_virtual_joints_join_the_coordinates_and_are_passed_on():
    rules = {"a": Follower("d", -1.0, 0.2)}
    plain = linear_coupling(NAMES, ["d"], rules, {})
    bend = VirtualJoint("bend", 0, np.eye(4), np.eye(3)[1], followers=((0, -1.0),))
    slide = VirtualJoint("slide", 0, np.eye(4), np.eye(3)[0], revolute=False)
    elastic = plain.with_virtual_joints([bend, slide], NAMES)
    q = elastic.motion(np.array([0.5, 0.01, 0.02])).q
    assert np.allclose(q, [0.2 - 0.5 - 0.01, 0.0, 0.0, 0.5, 0.01, 0.02])
