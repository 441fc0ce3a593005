"""The serial oracle against hand arithmetic, a plain fixed-point iteration, and time stepping."""

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.oracles.mujoco_serial import (
    Spring,
    deflect_urdf,
    pose_attributes,
    serial_statics,
    springs_of,
)
from tests.oracles.numpy_kinematics import UrdfTree, rotation, rotation_vector, transform
from tests.oracles.sample_urdfs import mimic_tree, six_axis_arm

STIFFNESS = (1e6, 5e5, 4e5, 1e5, 1e5, 5e4)
WRENCH = np.array([300, -400, 500, 80, -60, 40.0])
POINT = (0.1, 0.2, 0.3)


def test_one_hinge_by_hand():
    # 2 m bar along x, turning about z, 1 kN along y and 300 N·m about z: K a = 2000 cos a + 300
    hinge = Spring(np.eye(4), np.array([0.0, 0, 1]), 0.0, 2e4)
    result = serial_statics([hinge], transform([2, 0, 0])).deflection([0, 1000, 0, 0, 0, 300])
    angle = brentq(lambda a: 2e4 * a - 2000 * np.cos(a) - 300, 0, 1, xtol=1e-15)
    by_hand = [2 * np.cos(angle) - 2, 2 * np.sin(angle), 0]
    assert np.allclose(result.displacement, by_hand, atol=1e-12)
    assert np.allclose(result.rotation, [0, 0, angle], atol=1e-12)


def test_one_slide_by_hand():
    axis = np.array([0, 0.6, 0.8])
    slide = Spring(np.eye(4), axis, 0.3, 1e6, slide=True)
    result = serial_statics([slide], np.eye(4)).deflection([0, 0, 500, 1, 2, 3])
    assert np.allclose(result.displacement, axis * 400 / 1e6, atol=1e-15)
    assert np.allclose(result.unloaded[:3, 3], 0.3 * axis, atol=1e-15)


def test_quaternion_survives_half_turns():
    for axis in np.eye(3):
        for angle in (0.0, 1.0, np.pi, -np.pi / 2):
            text = pose_attributes(transform(turn=rotation(axis, angle)))
            w, *v = (float(x) for x in text.split('quat="')[1].rstrip('"').split())
            turn = rotation(axis, 2 * np.arctan2(float(np.dot(v, axis)), w))
            assert np.allclose(turn, rotation(axis, angle), atol=1e-14)


@pytest.mark.parametrize("seed", [None, 1, 2, 3])
@pytest.mark.parametrize(
    "wrench", [WRENCH, WRENCH * [1, 1, 1, 0, 0, 0], WRENCH * [0, 0, 0, 1, 1, 1]]
)
def test_six_axes_against_a_fixed_point_iteration(seed, wrench):
    tree = UrdfTree(six_axis_arm(seed))
    names = tree.independent
    rng = np.random.default_rng(seed)
    start = rng.uniform(-2, 2, 6)
    values = dict(zip(names, start, strict=True))
    stiffness = dict(zip(names, STIFFNESS, strict=True))
    result = deflect_urdf(tree, "tool", values, stiffness, wrench, POINT)

    loaded = start.copy()
    for _ in range(25):  # q = q0 + J(q)^T W / K contracts: the load is small beside the springs
        J = tree.jacobian(dict(zip(names, loaded, strict=True)), "tool", names, POINT)
        loaded = start + J.T @ wrench / np.array(STIFFNESS)
    there = dict(zip(names, loaded, strict=True))
    moved = tree.point(there, "tool", POINT) - tree.point(values, "tool", POINT)
    turned = tree.placement(there, "tool")[:3, :3] @ tree.placement(values, "tool")[:3, :3].T
    assert np.linalg.norm(moved) > 1e-5
    assert np.allclose(result.displacement, moved, atol=1e-12)
    assert np.allclose(result.rotation, rotation_vector(turned), atol=1e-12)
    assert np.allclose(result.unloaded[:3, 3], tree.point(values, "tool", POINT), atol=1e-12)


def test_rigid_joints_do_not_yield():
    tree = UrdfTree(six_axis_arm())
    values = dict(zip(tree.independent, (0.3, 0.2, -0.4, 0.5, 0.6, 0.7), strict=True))
    soft = dict(zip(tree.independent[:3], STIFFNESS, strict=False))
    stiff = {**soft, **dict.fromkeys(tree.independent[3:], 1e15)}
    a = deflect_urdf(tree, "tool", values, soft, WRENCH, POINT)
    b = deflect_urdf(tree, "tool", values, stiff, WRENCH, POINT)
    assert np.allclose(a.displacement, b.displacement, atol=1e-9)


def test_time_stepping_comes_to_the_same_rest():
    tree = UrdfTree(six_axis_arm(3))
    values = dict(zip(tree.independent, (0.3, 0.2, -0.4, 0.5, 0.6, 0.7), strict=True))
    springs, tip = springs_of(
        tree, "tool", values, dict(zip(tree.independent, STIFFNESS, strict=True))
    )
    statics = serial_statics(springs, tip)
    stepped = statics.deflection(WRENCH, statics.settle(WRENCH, steps=6000))
    assert np.allclose(stepped.displacement, statics.deflection(WRENCH).displacement, atol=1e-9)


def test_coupled_joints_are_refused():
    with pytest.raises(NotImplementedError, match="not a serial arm"):
        springs_of(UrdfTree(mimic_tree()), "f", {}, {"z": 1e5})
