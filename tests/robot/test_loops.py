"""Closed loops: against the coupled joints they replace, differences, plane geometry and MuJoCo."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.effects import Elastic, all_effects, load_case
from sk120stiff.errors import ToolkitWarning
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import load_robot
from sk120stiff.robot.kinematics.coupling import Curvature
from sk120stiff.stiffness import complementary_stiffness
from tests.oracles.mujoco_four_bar import closed_angles, four_bar_statics
from tests.oracles.numpy_kinematics import UrdfTree
from tests.robot.loop_arms import (
    FOUR_BAR,
    cylinder,
    differences,
    four_bar,
    joint,
    sk120_loop,
    urdf,
    write_robot,
)
from tests.stiffness.arms import deflection

SPRINGS = np.array([1.4e6, 4.0e5, 9.4e5, 3e5, 2e5, 1e5])
WRENCH = np.array([300.0, -400.0, 500.0, 80.0, -60.0, 40.0])
POINT = np.array([0.1, -0.2, 0.15])


def sk120_poses(count, seed):
    """Poses on the near side of the dead points, where crank and rod never fall in line."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1, 1, (40 * count, 6)) * [np.pi, 1.22, 2.0, 3, 3, 3]
    return poses[np.abs(poses[:, 1] + poses[:, 2]) < 1.45][:count]


def dense(curvature, m, n):
    """(m, n, n) second derivatives of m joints by n coordinates, with all the zeros."""
    return np.array([curvature.contracted(torque, n) for torque in np.eye(m)])


@pytest.fixture(scope="module", params=["point", "axis"])
def loop(request, tmp_path_factory):
    return sk120_loop(tmp_path_factory.mktemp("sk120") / request.param, request.param)


@pytest.fixture(scope="module")
def coupled():
    return load_robot("motoman_sk120")


@pytest.fixture(scope="module")
def quad(tmp_path_factory):
    return four_bar(tmp_path_factory.mktemp("quad"))


def test_the_five_bar_as_a_loop_is_the_coupled_sk120(loop, coupled):
    poses = sk120_poses(60, 0)
    assert loop.actuated == coupled.actuated and len(poses) == 60
    assert set(loop.dependent) == {"joint_elbow", "joint_rod"} and loop.followers == {}
    ours, theirs = loop.screws(poses, point=POINT), coupled.screws(poses, point=POINT)
    assert np.abs(ours.position - theirs.position).max() < 1e-12
    assert np.abs(ours.jacobian - theirs.jacobian).max() < 1e-11
    K, K_there = complementary_stiffness(ours, WRENCH), complementary_stiffness(theirs, WRENCH)
    assert np.abs(K).max() > 500 and np.abs(K - K_there).max() < 1e-9
    one = deflection(loop.mechanism(), poses, WRENCH, SPRINGS, POINT)
    two = deflection(coupled.mechanism(), poses, WRENCH, SPRINGS, POINT)
    for name in ("conventional", "enhanced", "second_order", "equilibrium"):
        ours, theirs = getattr(one, name), getattr(two, name)
        assert np.abs(ours).max() > 1e-3
        assert np.abs(ours - theirs).max() < 1e-12


def test_bent_links_inside_the_loop_move_what_the_rod_holds(loop, coupled):
    """Every elastic effect of the coupled SK120, with its virtual joints now inside a real loop."""
    poses = sk120_poses(12, 1)
    names = {e.id for e in all_effects(loop)} & {e.id for e in all_effects(coupled)}
    assert any(name.startswith("link_bending:link_2_l") for name in names)
    predicted = []
    for robot in (loop, coupled):
        model = joint_spring_model(robot, SPRINGS)
        for found in all_effects(robot):
            if found.id in names and isinstance(found, Elastic) and found.name != "joint_springs":
                model = model + found
        values = np.array([0.3 * p.spec.typical for p in model.parameters])
        load_cases = load_case(robot, poses, WRENCH, point=POINT)
        predicted.append(model.predict_with_sensitivities(load_cases, values))
    (one, _), (two, _) = predicted
    assert np.abs(one).max() > 3e-4
    # to first order alike; a tilted arm shifts the rod's end across the plane, which the coupled
    # joints do not know
    assert np.abs(one - two).max() < 2e-3 * np.abs(one).max()
    small = load_case(loop, poses, 1e-4 * WRENCH, point=POINT)
    there = load_case(coupled, poses, 1e-4 * WRENCH, point=POINT)
    model_one = joint_spring_model(loop, SPRINGS)
    model_two = joint_spring_model(coupled, SPRINGS)
    for found in all_effects(loop):
        if found.id in names and isinstance(found, Elastic) and found.name != "joint_springs":
            model_one, model_two = model_one + found, model_two + found
    one = model_one.predict_with_sensitivities(small)[1]
    two = model_two.predict_with_sensitivities(there)[1]
    size = np.abs(two).max(axis=(0, 1))
    assert (size > 0).sum() > 20
    assert (np.abs(one - two).max(axis=(0, 1)) <= 1e-5 * size + 1e-30).all()


def test_four_bar_stands_where_two_circles_meet(quad):
    tree = UrdfTree(FOUR_BAR)
    for drive in (-0.3, 0.0, 0.25, 0.6):
        knee, rock = closed_angles(drive)
        values = {"turret": 0.4, "drive": drive, "knee": knee, "rock": rock}
        found = quad.joint_values([0.4, drive])
        assert all(np.isclose(found[name], values[name], atol=1e-13) for name in values)
        gap = tree.point(values, "coupler_end") - tree.point(values, "rocker_end")
        assert np.abs(gap).max() < 1e-12
        assert np.allclose(quad.placement([0.4, drive]), tree.placement(values, "tool"), atol=1e-12)


@pytest.mark.parametrize("kind", ["point", "axis"])
def test_four_bar_derivatives_are_those_of_the_circles(kind, tmp_path):
    robot = four_bar(tmp_path, kind)
    tree = UrdfTree(FOUR_BAR)

    def position(a):
        knee, rock = closed_angles(a[1])
        values = {"turret": a[0], "drive": a[1], "knee": knee, "rock": rock}
        return tree.point(values, "tool", POINT)

    for a in ([0.3, -0.2], [-1.0, 0.35], [2.0, 0.6]):
        pose = np.array(a)
        screws = robot.screws(pose, point=POINT)
        assert np.abs(screws.linear_jacobian - differences(position, pose)).max() < 1e-9
        hessian = differences(lambda x: differences(position, x), pose)  # (3, 2, 2)
        for axis in range(3):
            ours = complementary_stiffness(screws, np.eye(6)[axis])
            assert np.abs(ours - hessian[axis]).max() < 1e-7
        motion = robot.coupling.motion(pose)
        slope = differences(lambda x: robot.coupling.motion(x).q, pose)
        assert np.abs(motion.first - slope).max() < 1e-9
        bend = differences(lambda x: robot.coupling.motion(x).first, pose)
        assert np.abs(dense(motion.second, robot.coupling.m, 2) - bend).max() < 1e-8


def test_stiffness_of_the_load_needs_the_curvature_of_the_loop(quad):
    """K_C is the slope of Jᵀ W; without the loop's second derivatives it misses by a third."""
    from dataclasses import replace

    a = np.array([0.3, 0.35])
    screws = quad.screws(a, point=POINT)
    slope = differences(lambda x: quad.screws(x, point=POINT).torques(WRENCH), a)
    K_C = complementary_stiffness(screws, WRENCH)
    assert np.abs(K_C - slope).max() < 1e-7 * np.abs(slope).max()
    straight = complementary_stiffness(replace(screws, second=None), WRENCH)
    assert np.abs(straight - slope).max() > 0.1 * np.abs(slope).max()


@pytest.mark.parametrize("part", [(1, 1, 1, 0, 0, 0), (0, 0, 0, 1, 1, 1), (1, 1, 1, 1, 1, 1)])
def test_deflection_of_the_four_bar_agrees_with_mujoco(quad, part):
    springs = np.array([3e5, 2e5])
    load = WRENCH * part
    for a in ([0.3, -0.2], [-1.0, 0.35], [2.0, 0.6]):
        theirs = four_bar_statics(*a, springs, POINT).deflection(load)
        ours = deflection(quad.mechanism(), a, load, springs, POINT)
        assert theirs.closure < 1e-12 and np.linalg.norm(theirs.displacement) > 3e-5
        assert np.allclose(ours.equilibrium, theirs.displacement, rtol=0, atol=1e-10)


def test_a_cylinder_lifts_by_the_law_of_cosines(tmp_path):
    robot = cylinder(tmp_path)
    assert robot.actuated == ("swing", "wrist", "piston")
    assert robot.prismatic == (False, False, True)
    # triangle: lift pivot (0, 0.8), foot (0.3, 0.1), head 0.6 from the pivot along the boom
    side, arm = np.hypot(0.3, 0.7), 0.6
    down = np.arctan2(-0.7, 0.3)
    for stroke in (0.6, 0.76, 0.95, 1.1):
        inner = np.arccos((side**2 + arm**2 - stroke**2) / (2 * side * arm))
        values = robot.joint_values([0.2, 0.5, stroke])
        assert np.isclose(values["lift"], down + inner, atol=1e-12)
        rate = stroke / (side * arm * np.sin(inner))
        motion = robot.coupling.motion(np.array([0.2, 0.5, stroke]))
        row = robot.tree.joint_index("lift")
        assert np.allclose(motion.first[row], [0, 0, rate], atol=1e-11)
        second = (1 - side * arm * np.cos(inner) * rate**2) / (side * arm * np.sin(inner))
        assert np.isclose(dense(motion.second, robot.coupling.m, 3)[row, 2, 2], second, atol=1e-9)


def test_rules_that_follow_dependent_joints(tmp_path):
    """A gear turns the hand twice as far as the knee, against it; its angle bends with the loop."""
    mimic = '<mimic joint="knee" multiplier="-2" offset="0.1"/>'
    text = FOUR_BAR.replace("</robot>", "") + joint(
        "hand", "tool", "gripper", "0.1 0 0", "1 0 1", mimic=mimic
    ) + '<link name="gripper"/></robot>'  # fmt: skip
    write_robot(
        tmp_path, text, base_frame="base", tool_frame="gripper", actuated=["turret", "drive"],
        closures=[{"frames": ["coupler_end", "rocker_end"], "start": {"knee": 0.1}}],
    )  # fmt: skip
    with pytest.warns(ToolkitWarning, match="axis"):
        robot = load_robot(tmp_path)
    a = np.array([0.3, 0.2])
    values = robot.joint_values(a)
    assert np.isclose(values["hand"], 0.1 - 2.0 * closed_angles(0.2)[0], atol=1e-13)
    slope = differences(lambda x: robot.screws(x, point=POINT).torques(WRENCH), a)
    K_C = complementary_stiffness(robot.screws(a, point=POINT), WRENCH)
    assert np.abs(K_C - slope).max() < 1e-7 * np.abs(slope).max()


def test_two_loops_one_after_the_other(tmp_path):
    """The rocker of one four-bar drives another; both closures hold and bend together."""
    text = urdf(
        "two", joint("drive", "base", "driven", "0 0 0"),
        joint("knee", "driven", "coupler", "0 0 0.5"),
        joint("rock", "base", "rocker", "0.4 0 -0.1"),
        joint("p1", "coupler", "c_end", "0.45 0 0", kind="fixed"),
        joint("p2", "rocker", "r_end", "0 0 0.7", kind="fixed"),
        joint("link", "rocker", "bar", "0 0 0.4"),
        joint("lever", "base", "arm", "0.9 0 0"),
        joint("p3", "bar", "b_end", "0.6 0 0", kind="fixed"),
        joint("p4", "arm", "a_end", "0 0 0.45", kind="fixed"),
        joint("p5", "arm", "tool", "0.3 0 0.8", kind="fixed"),
    )  # fmt: skip
    write_robot(
        tmp_path, text, base_frame="base", tool_frame="tool", actuated=["drive"],
        closures=[{"frames": ["c_end", "r_end"], "start": {"knee": 0.1}},
                  {"frames": ["b_end", "a_end"], "start": {"lever": 0.1}}],
    )  # fmt: skip
    robot = load_robot(tmp_path)
    tree = UrdfTree(text)
    for drive in (0.0, 0.3):
        a = np.array([drive])
        values = {k: float(v) for k, v in robot.joint_values(a).items()}
        for near, far in (("c_end", "r_end"), ("b_end", "a_end")):
            assert np.abs(tree.point(values, near) - tree.point(values, far)).max() < 1e-12
        slope = differences(lambda x: robot.screws(x).torques(WRENCH), a)
        K_C = complementary_stiffness(robot.screws(a), WRENCH)
        assert np.abs(K_C - slope).max() < 1e-7 * np.abs(slope).max()


def bennett(tmp_path, **closure):
    """Bennett's spatial four-bar: overconstrained, it moves only because its lengths fit."""
    a, alpha, beta = 0.5, 0.6, 1.1
    b = float(a * np.sin(beta) / np.sin(alpha))
    back = f"{-b!r} 0 0"
    text = urdf(
        "bennett", joint("j1", "base", "l1", "0 0 0", "0 0 1"),
        joint("j2", "l1", "l2", f"{a} 0 0", "0 0 1", rpy=f"{alpha} 0 0"),
        joint("j3", "l2", "l3", f"{b!r} 0 0", "0 0 1", rpy=f"{beta} 0 0"),
        joint("p3", "l3", "end", f"{a} 0 0", kind="fixed", rpy=f"{alpha} 0 0"),
        joint("p4", "base", "pin", back, kind="fixed", rpy=f"{-beta} 0 0"),
        joint("p5", "l3", "tool", "0.3 0.2 0.1", kind="fixed"),
    )  # fmt: skip
    rule = {"frames": ["end", "pin"], "type": "axis", "axis": [0, 0, 1], **closure}
    write_robot(tmp_path, text, base_frame="base", tool_frame="tool", actuated=["j1"],
                closures=[rule])  # fmt: skip
    return load_robot(tmp_path), alpha, beta


def test_a_spatial_loop_with_redundant_equations(tmp_path):
    guess = {"j1": 1.0, "j2": 2.0, "j3": -1.0}
    robot, alpha, beta = bennett(tmp_path, start=guess)
    assert robot.coupling.closer.rows is None  # no fixed choice of rows will do
    for theta in (0.8, 1.0, 1.7):
        a = np.array([theta])
        values = robot.joint_values(a)
        # Bennett's condition, and opposite angles that are equal and opposite
        product = np.tan(theta / 2) * np.tan(values["j2"] / 2)
        assert np.isclose(abs(product), np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2))
        assert np.isclose(np.cos(values["j3"]), np.cos(theta), atol=1e-9)
        slope = differences(lambda x: robot.screws(x).torques(WRENCH), a)
        K_C = complementary_stiffness(robot.screws(a), WRENCH)
        assert np.abs(K_C - slope).max() < 1e-7 * np.abs(slope).max()


def test_the_start_chooses_the_assembly_mode(tmp_path):
    up = four_bar(tmp_path / "up", start={"knee": -0.2, "rock": 0.0})
    down = four_bar(tmp_path / "down", start={"knee": 1.6, "rock": -0.8})
    a = np.array([0.0, 0.2])
    knee_up, knee_down = up.joint_values(a)["knee"], down.joint_values(a)["knee"]
    assert np.isclose(knee_up, closed_angles(0.2)[0]) and abs(knee_up - knee_down) > 0.5
    tree = UrdfTree(FOUR_BAR)
    values = {k: float(v) for k, v in down.joint_values(a).items()}
    gap = tree.point(values, "coupler_end") - tree.point(values, "rocker_end")
    assert np.abs(gap).max() < 1e-12


def test_a_start_that_nobody_gave_is_told(tmp_path):
    with pytest.warns(ToolkitWarning, match="assembly mode.*start"):
        robot = four_bar(tmp_path, start={})
    assert np.isclose(robot.joint_values([0.0, 0.0])["knee"], closed_angles(0.0)[0])


def test_answers_do_not_depend_on_what_was_asked_before(tmp_path):
    poses = np.random.default_rng(3).uniform(-0.3, 0.7, (40, 2))
    whole = four_bar(tmp_path / "a").jacobian(poses)
    robot = four_bar(tmp_path / "b")
    for k in (7, 3, 31, 30, 8):
        one = robot.jacobian(poses[k])
        nearby = robot.jacobian(poses[k] + 1e-3)
        assert np.allclose(one, whole[k], rtol=0, atol=1e-12)
        assert not np.allclose(nearby, one, rtol=0, atol=1e-6)
    grid = robot.jacobian(poses.reshape(5, 8, 2))
    assert grid.shape == (5, 8, 6, 2)
    assert np.allclose(grid.reshape(40, 6, 2), whole, rtol=0, atol=1e-12)


def test_curvature_keeps_only_what_is_not_zero():
    hessian = np.arange(8.0).reshape(2, 2, 2) + np.arange(8.0).reshape(2, 2, 2).swapaxes(1, 2)
    bend = Curvature(np.array([1, 4]), np.array([0, 2]), hessian)
    whole = dense(bend, 5, 3)
    assert whole[4, 2, 0] == hessian[1, 1, 0]
    torques = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    assert np.array_equal(bend.contracted(torques, 3), np.einsum("k,kij->ij", torques, whole))
    order = np.array([4, 3, 1])
    assert np.array_equal(dense(bend.picked(order), 3, 3), whole[order])
    assert bend.picked(np.array([0, 2])) is None
