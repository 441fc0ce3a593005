"""Placement, Jacobian and torques of chains: against 4×4 matrices, Pinocchio and differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot, VirtualJoint, load_robot
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.pinocchio_jacobian import pinocchios
from tests.oracles.sample_urdfs import mimic_tree, six_axis_arm

POINT = np.array([0.1, -0.2, 0.3])
WRENCH = np.array([300.0, -400.0, 500.0, 80.0, -60.0, 40.0])


def cases() -> list[tuple[Robot, UrdfTree, str, str]]:
    texts = [(six_axis_arm(), "base", "tool"), (mimic_tree(), "a", "f"), (mimic_tree(), "b", "e")]
    out = []
    for text, base, tool in texts:
        out.append((load_robot(text, base=base, tool=tool), UrdfTree(text), base, tool))
    return out


CASES = cases()


def values_of(robot: Robot, pose: np.ndarray) -> dict[str, float]:
    """Values of all joints: those below the base frame stand where the robot's rules put them."""
    return {name: float(value) for name, value in robot.joint_values(pose).items()}


def free(tree: UrdfTree) -> UrdfTree:
    tree.joints = {name: replace(joint, mimic=None) for name, joint in tree.joints.items()}
    tree.by_child = {joint.child: joint for joint in tree.joints.values()}
    return tree


@pytest.mark.parametrize(("robot", "tree", "base", "tool"), CASES)
def test_placement_of_any_point_agrees_with_matrices(robot, tree, base, tool):
    poses = np.random.default_rng(0).uniform(-2, 2, (5, robot.n))
    found = robot.placement(poses, point=POINT)
    for pose, ours in zip(poses, found, strict=True):
        theirs = free(tree).placement(values_of(robot, pose), tool, base)
        assert np.allclose(ours[:3, :3], theirs[:3, :3], atol=1e-13)
        assert np.allclose(ours[:, 3], theirs @ np.append(POINT, 1.0), atol=1e-13)


@pytest.mark.parametrize(("robot", "tree", "base", "tool"), CASES)
def test_jacobian_is_the_slope_of_the_placement(robot, tree, base, tool):
    step = 1e-3
    for pose in np.random.default_rng(1).uniform(-2, 2, (4, robot.n)):
        J = robot.jacobian(pose, point=POINT)
        here = robot.placement(pose, point=POINT)
        for k in range(robot.n):
            e = step * np.eye(robot.n)[k]

            def twist(by, e=e, pose=pose, here=here):
                there = robot.placement(pose + by * e, point=POINT)
                turn = (there[:3, :3] @ here[:3, :3].T - (there[:3, :3] @ here[:3, :3].T).T) / 2
                sine = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
                length = np.linalg.norm(sine)
                angle = np.arcsin(length) / length if length else 1.0
                return np.concatenate([there[:3, 3], sine * angle])

            slope = (8 * (twist(1) - twist(-1)) - twist(2) + twist(-2)) / (12 * step)
            assert np.allclose(J[:, k], slope, atol=1e-9)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_jacobian_of_a_skew_arm_is_pinocchios(seed):
    with pytest.warns(UserWarning, match="axis"):
        robot = load_robot(six_axis_arm(seed), base="base", tool="tool")
    for pose in np.random.default_rng(seed).uniform(-3, 3, (5, 6)):
        ours = robot.jacobian(pose, point=POINT)
        q = robot.coupling.motion(pose).q
        assert np.allclose(ours, pinocchios(robot.tree, q, "tool", POINT), atol=1e-12)


@pytest.mark.parametrize(
    "frame", ["crank_end", "rod", "forearm_lever_end", "reflector", "link_4_r"]
)
def test_every_frame_of_the_sk120_has_its_own_chain(frame):
    robot = load_robot("motoman_sk120")
    for pose in np.random.default_rng(5).uniform(-1, 1, (4, 6)):
        q = robot.coupling.motion(pose).q
        theirs = pinocchios(robot.tree, q, frame, POINT) @ robot.coupling.motion(pose).first
        assert np.allclose(robot.jacobian(pose, frame, POINT), theirs, atol=1e-12)


def test_torques_are_the_jacobians_transpose():
    robot = CASES[0][0]
    screws = robot.screws(np.random.default_rng(2).uniform(-1, 1, (3, 4, 6)), point=POINT)
    assert screws.jacobian.shape == (3, 4, 6, 6)
    expected = np.swapaxes(screws.jacobian, -1, -2) @ WRENCH
    assert np.allclose(screws.torques(WRENCH), expected, atol=1e-10)
    assert np.allclose(screws.linear_jacobian, screws.jacobian[..., :3, :], atol=0)
    elsewhere = screws.at([0.0, 0.0, 1.0])
    shift = np.einsum("...ij,j->...i", screws.rotation, np.array([0.0, 0.0, 1.0]) - POINT)
    assert np.allclose(elsewhere.position - screws.position, shift, atol=1e-13)


def test_batches_of_any_shape_are_loops():
    for robot, *_ in CASES:
        poses = np.random.default_rng(3).uniform(-1, 1, (2, 3, robot.n))
        whole = robot.placement(poses, point=POINT)
        for index in np.ndindex(2, 3):
            assert np.allclose(whole[index], robot.placement(poses[index], point=POINT), atol=1e-15)
        assert robot.placement(poses[:0]).shape == (0, 3, 4, 4)


def test_weight_presses_as_its_potential_says():
    robot = CASES[0][0]
    fresh = UrdfTree(six_axis_arm())
    for pose in np.random.default_rng(4).uniform(-1, 1, (3, 6)):
        values = dict(zip(robot.actuated, pose, strict=True))
        held = fresh.gravity_torque(values, list(robot.actuated)) * 9.80665 / 9.81
        assert np.allclose(robot.gravity_torque(pose), -held, atol=1e-6)
    assert np.isclose(robot.total_mass, sum(60 - 9 * k for k in range(6)))


def test_virtual_joints_move_what_lies_beyond_them():
    """A chain with virtual joints equals one whose URDF has those joints as fixed steps."""
    robot = CASES[0][0]
    rigid = robot.mechanism()
    place = np.eye(4)
    place[:3, 3] = [0.3, 0.1, -0.2]
    turn = VirtualJoint("turn", 1, place, np.array([0.6, 0.0, 0.8]))
    shift = VirtualJoint("shift", 1, np.eye(4), np.eye(3)[0], revolute=False)
    base = VirtualJoint("base", -1, place, np.eye(3)[2])
    soft = rigid.with_virtual_joints([turn, shift, base])
    assert soft.n == 9
    pose = np.random.default_rng(6).uniform(-1, 1, 6)
    still = soft.screws(np.concatenate([pose, np.zeros(3)]), POINT)
    assert np.allclose(still.position, rigid.screws(pose, POINT).position, atol=1e-14)
    assert np.allclose(still.jacobian[:, :6], rigid.screws(pose, POINT).jacobian, atol=1e-13)
    z = np.concatenate([pose, [0.2, 0.05, -0.3]])
    J = soft.screws(z, POINT).linear_jacobian
    step = 1e-3
    for k in range(9):
        e = step * np.eye(9)[k]

        def at(by, e=e):
            return soft.screws(z + by * e, POINT).position

        assert np.allclose(
            J[:, k], (8 * (at(1) - at(-1)) - at(2) + at(-2)) / (12 * step), atol=1e-9
        )
    with pytest.raises(ValueError, match="once"):
        soft.with_virtual_joints([turn])


def test_a_link_weighs_where_it_did_behind_joints_of_a_turned_frame():
    """Several joints at a link's origin, in the axes of the next joint, as errors of its frame."""
    rng = np.random.default_rng(9)
    bare = CASES[0][0].mechanism().chain
    chain = replace(bare, masses=rng.uniform(1, 9, 6), centres=rng.normal(size=(6, 3)))
    place = np.eye(4)
    place[:3, :3] = Rotation.from_rotvec([1.4, -0.3, 0.5]).as_matrix()
    q = rng.uniform(-1, 1, 6)
    before = chain.sweep(q)
    axes = [VirtualJoint(f"v{k}", 2, place, np.eye(3)[k]) for k in range(3)]
    wide = chain.with_virtual_joints(axes, 6)
    after = wide.sweep(np.concatenate([q, np.zeros(3)])[wide.coordinates])
    assert before.centres is not None and after.centres is not None
    moments = wide.masses @ after.centres
    assert np.allclose(moments, chain.masses @ before.centres, atol=1e-12)


def test_a_mechanism_needs_no_robot():
    chain = CASES[0][0].mechanism().chain
    assert isinstance(CASES[0][0].mechanism(), Mechanism)
    assert chain.m == 6 and len(chain.placements) == 7


@pytest.mark.parametrize(
    ("a", "frame", "message"),
    [
        ([0.0] * 5, None, "5 coordinates given, but six_axis has 6"),
        ([0.0] * 5 + [np.nan], None, "not a finite number"),
        ([0.0] * 6, "tol", "no frame 'tol'.*did you mean 'tool'"),
    ],
)
def test_wrong_questions_are_refused(a, frame, message):
    with pytest.raises(InputError, match=message):
        CASES[0][0].jacobian(a, frame)


def test_frames_below_the_base_are_refused():
    robot = load_robot(six_axis_arm(), base="link_3", tool="tool")
    assert robot.actuated == ("j4", "j5", "j6")
    with pytest.raises(InputError, match="not carried by"):
        robot.jacobian([0.0, 0.0, 0.0], "link_1")
