"""Three formulas and the exact deflection: how far each is off, and how the load matters."""

import numpy as np
import pytest

from sk120stiff.errors import Refusal
from sk120stiff.model import joint_spring_model, loaded_stiffness
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import ConstantCompliance, equilibrium, linear_springs, under_load
from tests.oracles.mujoco_serial import deflect_urdf
from tests.oracles.mujoco_sk120 import deflect_sk120
from tests.oracles.numpy_kinematics import UrdfTree
from tests.stiffness.arms import (
    POINT,
    deflection,
    mixed_arm,
    mixed_urdf,
    sk120,
    sk120_poses,
    uncoupled,
)

FORMULAS = ("conventional", "enhanced", "second_order")


def rms_um(x):
    return 1e6 * float(np.sqrt(np.mean(x**2)))


def industrial_loads(seed):
    """20 poses of the SK120's range, five loads up to 490 N (50 kg) each, in random directions."""
    rng = np.random.default_rng(seed)
    poses = np.repeat(sk120_poses(20, seed), 5, axis=0)
    directions = np.repeat(rng.normal(size=(20, 3)), 5, axis=0)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    sizes = np.tile(9.80665 * np.array([10, 20, 30, 40, 50]), 20)
    return poses, np.concatenate([sizes[:, None] * directions, np.zeros((100, 3))], axis=1)


def test_what_each_formula_leaves_out_at_industrial_loads():
    """Micrometres: about 0.28 without K_C, 0.21 with it, 0.0003 with the path's curvature."""
    off = {name: [] for name in FORMULAS}
    for seed in range(5):
        found = deflection(sk120().mechanism, *industrial_loads(seed), sk120().springs)
        assert np.max(np.abs(found.equilibrium)) > 5e-4
        for name in FORMULAS:
            off[name].append(rms_um(getattr(found, name) - found.equilibrium))
    conventional, enhanced, second = (float(np.mean(off[name])) for name in FORMULAS)
    assert conventional == pytest.approx(0.28, abs=0.1)
    assert enhanced == pytest.approx(0.21, abs=0.1)
    assert second < 0.0006
    assert enhanced < conventional


@pytest.mark.parametrize("arm", [sk120(), mixed_arm(0), mixed_arm(3)], ids=["sk120", "a", "b"])
def test_orders_of_the_errors(arm):
    """Half the load: a quarter of the first-order formulas' error, an eighth of the second's."""
    poses = sk120_poses(6, 2) if arm.n == 6 else arm.poses(6, 2)
    load = np.array([600.0, -700.0, 500.0, 150.0, -80.0, 90.0])
    large, small = (deflection(arm.mechanism, poses, f * load, arm.springs, POINT) for f in (2, 1))
    for name, order in zip(FORMULAS, (2, 2, 3), strict=True):
        ratio = rms_um(getattr(large, name) - large.equilibrium) / rms_um(
            getattr(small, name) - small.equilibrium
        )
        assert np.log2(ratio) == pytest.approx(order, abs=0.1)


def test_sk120_against_the_closed_loop_of_bodies():
    """Loads of the paper and ten times as much, with moments, at two points."""
    arm = sk120()
    for wrench, limit in (
        ([300, -400, 500, 0, 0, 0], 1e-10),
        ([4e3, 3e3, -5e3, 900, 800, -700], 1e-9),
    ):
        load = np.array(wrench, dtype=float)
        for a in sk120_poses(3, seed=21):
            for point in (np.zeros(3), POINT):
                bodies = deflect_sk120(a, load, point=point)
                ours = deflection(arm.mechanism, a, load, arm.springs, point)
                assert bodies.closure < 1e-12
                assert np.allclose(ours.equilibrium, bodies.displacement, rtol=0, atol=limit)
                assert np.max(np.abs(ours.second_order - bodies.displacement)) < np.max(
                    np.abs(ours.conventional - bodies.displacement)
                )


@pytest.mark.parametrize("seed", range(3))
def test_slides_and_hinges_against_bodies(seed):
    text = uncoupled(mixed_urdf(seed))
    robot, tree = load_robot(text, base="l0", tool="l7"), UrdfTree(text)
    assert sum(robot.prismatic) == 3
    rng = np.random.default_rng(seed)
    springs = rng.uniform(1e5, 1e6, 7)
    for wrench in ([3000, -2000, 1000, 0, 0, 0], [300, -200, 100, 400, 500, -600]):
        a = rng.uniform(-1, 1, 7)
        values = dict(zip(robot.actuated, a, strict=True))
        elastic = dict(zip(robot.actuated, springs, strict=True))
        bodies = deflect_urdf(tree, "l7", values, elastic, wrench, POINT)
        ours = deflection(robot.mechanism(), a, wrench, springs, POINT)
        assert np.linalg.norm(bodies.displacement) > 1e-4
        assert np.allclose(ours.equilibrium, bodies.displacement, rtol=0, atol=1e-9)
        assert np.max(np.abs(ours.conventional - bodies.displacement)) > 1e-8


def test_equilibrium_balances_springs_and_load():
    """K (z - z_0) = J^T W, with the torques from matrices alone; coupled joints and slides."""
    for arm in (mixed_arm(1), mixed_arm(5)):
        (a,) = arm.poses(1, 9)
        load = np.array([2000.0, 1500.0, -1000.0, 300.0, -200.0, 100.0])
        rest = equilibrium(arm.mechanism, a, load, linear_springs(arm.springs), point=POINT)
        torques = arm.torques(rest.z, load)
        assert np.allclose(arm.springs * (rest.z - a), torques, rtol=0, atol=1e-5)
        assert np.max(np.abs(torques - arm.torques(a, load))) > 1.0
        assert np.allclose(rest.screws.position, arm.position(rest.z), rtol=0, atol=1e-12)
        found = deflection(arm.mechanism, a, load, arm.springs, POINT)
        moved = arm.position(rest.z) - arm.position(a)
        assert np.allclose(found.equilibrium, moved, rtol=0, atol=1e-12)


def test_units_by_hand():
    """1 N·m/rad, 1 m, 1 N: one radian per newton-metre, metres out; nothing is in mm or degrees."""
    text = (
        '<robot name="bar"><link name="ground"/><link name="bar"/><link name="tip"/>'
        '<joint name="hinge" type="revolute"><parent link="ground"/><child link="bar"/>'
        '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        '<joint name="end" type="fixed"><parent link="bar"/><child link="tip"/>'
        '<origin xyz="1 0 0"/></joint></robot>'
    )
    robot = load_robot(text, base="ground", tool="tip")
    found = deflection(robot.mechanism(), [0.0], [0, 1e-3, 0, 0, 0, 2e-3], [1.0])
    assert found.conventional == pytest.approx([0, 3e-3, 0], abs=1e-15)
    # the table's numbers, as the paper prints them: 0.8023 mm under 364.5 N across the arm
    row = np.radians([-33.2004, 15.9, -55.5957, 0, 0, 0])
    force = np.array([45.524, 364.5018, 211.3439, 0, 0, 0])
    moved = deflection(sk120().mechanism, row, force, sk120().springs).equilibrium
    assert moved == pytest.approx([-0.1494e-3, 0.8023e-3, 0.2282e-3], abs=1e-6)


def test_batch_is_the_loop():
    poses, loads = industrial_loads(1)
    arm = sk120()
    whole = deflection(arm.mechanism, poses.reshape(4, 25, 6), loads.reshape(4, 25, 6), arm.springs)
    for k in (0, 17, 61, 99):
        one = deflection(arm.mechanism, poses[k], loads[k], arm.springs)
        for name in (*FORMULAS, "equilibrium"):
            assert np.allclose(
                getattr(whole, name).reshape(100, 3)[k], getattr(one, name), rtol=0, atol=1e-14
            )


def test_a_load_that_springs_cannot_hold_is_refused():
    arm = mixed_arm(0)
    with pytest.raises(Refusal, match="equilibrium"):
        deflection(arm.mechanism, arm.poses(1, 0)[0], np.array([0, 0, 1e9, 0, 0, 0]), arm.springs)


def test_an_exactly_critical_load_is_refused():
    """A bar of 1 m on a spring of 1000 N·m/rad, pressed along itself by 1 kN."""
    text = (
        '<robot name="column"><link name="ground"/><link name="bar"/><link name="tip"/>'
        '<joint name="hinge" type="revolute"><parent link="ground"/><child link="bar"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        '<joint name="end" type="fixed"><parent link="bar"/><child link="tip"/>'
        '<origin xyz="0 0 1"/></joint></robot>'
    )
    mechanism = load_robot(text, base="ground", tool="tip").mechanism()
    arm = ConstantCompliance.of_springs(mechanism, [1000.0])
    press = [0, 0, -1000.0, 0, 0, 0]
    found = under_load(arm, [0.0], press, ("compliance", "deflection_enhanced", "critical"))
    assert np.isnan(found.compliance).all() and np.isnan(found.deflection_enhanced).all()
    assert found.critical == pytest.approx(1.0)
    model = joint_spring_model(load_robot(text, base="ground", tool="tip"), [1000.0])
    with pytest.raises(Refusal, match="exactly critical"):
        loaded_stiffness(model, [0.0], press)
    below = deflection(mechanism, [0.0], [1.0, 0, -999.0, 0, 0, 0], [1000.0])
    assert below.enhanced[0] == pytest.approx(1.0)  # a thousand times the 1 mm of the spring alone
