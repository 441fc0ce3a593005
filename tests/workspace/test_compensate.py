"""Compensation, checked by MuJoCo and by the model's own equilibrium."""

import numpy as np
import pinocchio as pin
import pytest

from sk120stiff.effects import effect
from sk120stiff.errors import InputError
from sk120stiff.model import Model, base_model, joint_spring_model
from sk120stiff.robot import load_robot
from sk120stiff.workspace import compensate, standing
from tests.oracles.mujoco_sk120 import deflect_sk120
from tests.oracles.sample_urdfs import six_axis_arm

SPRINGS = (1.4098e6, 4.0076e5, 9.3528e5)
WRIST = (2.5e5, 3e5, 2e5)
LOADS = np.array(
    [
        [0.0, 0.0, -490.0, 0.0, 0.0, 0.0],
        [300.0, -250.0, -300.0, 0.0, 0.0, 0.0],
        [-400.0, 200.0, 200.0, 40.0, -30.0, 20.0],
    ]
)
POSES = np.random.default_rng(8).uniform(
    [-2.5, -0.9, -1.5, -1.0, -1.5, -1.0], [2.5, 0.9, 0.4, 1.0, -0.4, 1.0], (3, 6)
)


def tool(a: np.ndarray) -> np.ndarray:
    return load_robot("motoman_sk120").placement(a)[:3, 3]


@pytest.mark.parametrize("wrist", [False, True], ids=["rigid wrist", "soft wrist"])
def test_mujoco_agrees_that_the_loaded_tool_stands_where_it_was_meant_to(wrist: bool) -> None:
    robot = load_robot("motoman_sk120")
    model = joint_spring_model(robot, [*SPRINGS, *(WRIST if wrist else (np.inf,) * 3)])
    found = compensate(model, POSES, LOADS)
    assert found.reasons == ("", "", "")
    for k, (meant, command, load) in enumerate(zip(POSES, found.a, LOADS, strict=True)):
        oracle = deflect_sk120(command, load, SPRINGS, WRIST if wrist else (None, None, None))
        left = tool(command) + oracle.displacement - tool(meant)
        assert np.linalg.norm(left) < 1e-9  # a nanometre; a micrometre was asked for
        uncorrected = deflect_sk120(meant, load, SPRINGS, WRIST if wrist else (None, None, None))
        assert np.linalg.norm(uncorrected.displacement) > 2e-4
        np.testing.assert_allclose(found.before.away[k], uncorrected.displacement, atol=1e-9)


def test_orientation_is_restored_too() -> None:
    robot = load_robot("motoman_sk120")
    model = joint_spring_model(robot, [*SPRINGS, *WRIST])
    found = compensate(model, POSES, LOADS, orientation=True)
    assert np.linalg.norm(found.before.turned, axis=1).min() > 1e-4
    assert np.abs(found.after.turned).max() < 1e-10
    assert found.after.distance.max() < 1e-10
    only_position = compensate(model, POSES, LOADS)
    assert np.linalg.norm(only_position.after.turned, axis=1).max() > 1e-5
    for meant, command, load in zip(POSES, found.a, LOADS, strict=True):
        oracle = deflect_sk120(command, load, SPRINGS, WRIST)
        assert np.linalg.norm(tool(command) + oracle.displacement - tool(meant)) < 1e-9


def test_a_wrong_model_leaves_what_it_got_wrong() -> None:
    """Springs 10 % too stiff: a tenth of the deflection stays, and `standing` says so."""
    robot = load_robot("motoman_sk120")
    true = joint_spring_model(robot, [*SPRINGS, np.inf, np.inf, np.inf])
    wrong = joint_spring_model(robot, [*(1.1 * np.array(SPRINGS)), np.inf, np.inf, np.inf])
    found = compensate(wrong, POSES, LOADS)
    assert found.after.distance.max() < 1e-10  # as the wrong model sees it
    seen = standing(true, found.a, POSES, LOADS)
    for k, (meant, command, load) in enumerate(zip(POSES, found.a, LOADS, strict=True)):
        oracle = deflect_sk120(command, load, SPRINGS)
        left = tool(command) + oracle.displacement - tool(meant)
        np.testing.assert_allclose(seen.away[k], left, atol=1e-9)
        share = np.linalg.norm(left) / np.linalg.norm(found.before.away[k])
        assert share == pytest.approx(0.1, rel=0.15)


def test_the_point_may_be_beside_the_tool_frame() -> None:
    robot = load_robot("motoman_sk120")
    model = joint_spring_model(robot, [*SPRINGS, *WRIST])
    point = (-0.06, 0.04, 0.15)
    found = compensate(model, POSES, LOADS, point=point)
    for meant, command, load in zip(POSES, found.a, LOADS, strict=True):
        oracle = deflect_sk120(command, load, SPRINGS, WRIST, point=point)
        where = [robot.placement(a, point=point)[:3, 3] for a in (command, meant)]
        assert np.linalg.norm(where[0] + oracle.displacement - where[1]) < 1e-9


def test_weight_and_wrong_geometry_are_corrected() -> None:
    robot = load_robot(six_axis_arm())
    model = joint_spring_model(robot, np.full(6, 2e5))
    found = compensate(model, POSES, np.zeros(6))
    assert found.before.distance.min() > 1e-4  # it sags
    assert found.after.distance.max() < 1e-10


def test_the_weight_turns_a_gear_with_play_and_that_is_corrected_too() -> None:
    """A load that pulls the way the weight does finds the flank taken up, and the arm off by it."""
    half, joint = 3e-4, 1
    source = six_axis_arm()
    robot, arm = load_robot(source), pin.buildModelFromXML(source)
    play = effect(robot, "lost_motion", robot.actuated[joint])
    model = (Model(robot) + play).with_values(np.array([half]))
    found = compensate(model, POSES, np.zeros(6))
    for k, a in enumerate(POSES):
        weight = -pin.computeGeneralizedGravity(arm, arm.createData(), a)[joint]
        stands = a + half * np.sign(weight) * np.eye(6)[joint]
        way = robot.placement(stands)[:3, 3] - robot.placement(a)[:3, 3]
        assert np.linalg.norm(way) > 5e-5
        np.testing.assert_allclose(found.before.away[k], way, atol=1e-9)
    assert found.after.distance.max() < 1e-9


def test_what_cannot_be_corrected_is_told() -> None:
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    few = np.array([True, True, False, False, False, False])
    found = compensate(model, POSES, LOADS, movable=few)
    assert all("2 joints cannot correct 3 directions" in reason for reason in found.reasons)
    assert (found.after.distance < found.before.distance).all()
    np.testing.assert_array_equal(found.a[:, 2:], POSES[:, 2:])

    at_limit = np.array([[0.3, robot.upper[1], 0.1, 0.0, -1.2, 0.0]])
    up = np.array([[0.0, 0.0, 490.0, 0.0, 0.0, 0.0]])
    three = np.array([True, True, True, False, False, False])
    stuck = compensate(model, at_limit, up, movable=three)
    other = compensate(model, at_limit, -up, movable=three)
    assert {bool(stuck.reasons[0]), bool(other.reasons[0])} == {True, False}
    told = stuck.reasons[0] or other.reasons[0]
    assert told == "at the limit of joint_2_l"
    for one in (stuck, other):
        assert (one.a <= robot.upper + 1e-15).all()


def test_loads_that_no_spring_holds_are_told_row_by_row() -> None:
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    loads = LOADS.copy()
    loads[1] = (0.0, 0.0, 0.0, 0.0, 1e9, 0.0)
    found = compensate(model, POSES, loads)
    assert found.reasons[1] == "the springs cannot hold this load"
    assert np.isnan(found.after.away[1]).all()
    np.testing.assert_array_equal(found.a[1], POSES[1])
    assert found.reasons[0] == found.reasons[2] == ""
    assert found.after.distance[[0, 2]].max() < 1e-10


def test_bad_input() -> None:
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    with pytest.raises(InputError, match="load"):
        compensate(model, POSES, np.full((3, 6), np.nan))
    with pytest.raises(InputError, match="actuated"):
        compensate(model, POSES[:, :5], LOADS)
    nothing = compensate(model, np.zeros((0, 6)), np.zeros(6))
    assert nothing.a.shape == (0, 6)
    assert nothing.reasons == ()


def test_no_point_stands_farther_off_than_before() -> None:
    """Beside a singular pose steps lead astray: a point was off by 1 mm, and 30 mm 'corrected'."""
    robot = load_robot(six_axis_arm())
    model = joint_spring_model(robot, np.full(6, 3e3))
    rng = np.random.default_rng(3)
    poses = rng.uniform(-1.0, 1.0, (60, 6))
    poses[:, 4] = 10.0 ** rng.uniform(-4.0, -1.5, 60)  # the wrist is nearly stretched
    found = compensate(model, poses, [0.0, 0.0, -60.0, 0.0, 0.0, 0.0], orientation=True)
    assert (found.after.distance <= found.before.distance + 1e-8).all()
    stay = [k for k, reason in enumerate(found.reasons) if "stays as it was" in reason]
    assert stay
    np.testing.assert_array_equal(found.a[stay], poses[stay])
