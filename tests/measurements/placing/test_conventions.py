"""Joints of another controller: signs and quarter turns of several joints are found together."""

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.slips import (
    Convention,
    nearer,
    oddness,
    signs_and_turns,
    to_the_floor,
)
from sk120stiff.robot import Robot

NOISE = 1e-3  # m


def cloud_of(robot: Robot, signs: np.ndarray, quarters: np.ndarray, seed: int) -> Cloud:
    """Positions of an arm whose columns are another controller's: a = signs q + quarters."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(-1.2, 1.2, (24, len(robot.actuated)))
    x = robot.screws(a, point=rng.uniform(-0.15, 0.15, 3)).position
    x = x + NOISE * rng.normal(size=x.shape)
    nothing = np.zeros(len(a), dtype=np.intp)
    columns = (a - quarters * np.pi / 2) * signs
    return Cloud(
        robot, columns, x, np.zeros((len(a), 3)), np.array([""] * len(a)), nothing, nothing
    )


@pytest.mark.parametrize("seed", range(4))
def test_several_joints_at_once(seed: int):
    robot = sk.load_robot("ur5e")
    rng = np.random.default_rng(100 + seed)
    signs = rng.choice([1.0, -1.0], len(robot.actuated))
    quarters = np.zeros(len(robot.actuated))
    quarters[1:-1] = rng.choice([-1.0, 0.0, 1.0], len(robot.actuated) - 2)
    found = signs_and_turns(cloud_of(robot, signs, quarters, seed))
    assert found.rms < 3.0 * NOISE


def test_the_plainest_of_those_that_fit_alike_is_told():
    """The wrist turned over, with the last joint the other way round, places a marker as well."""
    robot = sk.load_robot("ur5e")
    signs = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0])
    quarters = np.array([0.0, 1.0, -1.0, 0.0, 0.0, 0.0])
    found = signs_and_turns(cloud_of(robot, signs, quarters, seed=3))
    assert found.rms < 3.0 * NOISE
    assert len(found.changed(robot.actuated)) <= 5
    again = cloud_of(robot, signs, quarters, seed=3).a @ found.share.T + found.zero
    assert (again > robot.lower - 0.1).all() and (again < robot.upper + 0.1).all()


def test_joints_are_told_by_the_names_of_columns():
    share, zero = np.diag([-1.0, 1.0, 1.0]), np.array([0.0, np.pi / 2, -np.pi / 2])
    found = Convention(0.0, share, zero)
    assert found.expressions(["A1", "A2", "A3"]) == ["-A1", "A2 + 90 deg", "A3 - 90 deg"]
    assert Convention(0.0, np.eye(3), 0.0 * zero).changed(["a", "b", "c"]) == {}


def test_joints_beyond_their_limits_and_half_turns_are_odd():
    robot = replace(sk.load_robot("ur5e"), lower=np.full(6, -2.0), upper=np.full(6, 2.0))
    plain, nothing = np.eye(6), np.zeros(6)
    cloud = cloud_of(robot, np.ones(6), nothing, seed=1)
    turned = nothing.copy()
    turned[4] = np.pi
    assert oddness(cloud, plain, nothing) == (0, 0)
    assert oddness(cloud, plain, turned) == (1, 2)
    assert oddness(cloud, -plain, nothing) == (0, 6)
    coupled = plain.copy()
    coupled[2, 1] = -1.0
    assert oddness(cloud, coupled, nothing)[1] == 1


@pytest.mark.parametrize("own", [1.0, -1.0])
def test_a_joint_measured_against_the_floor_beside_a_wrist_the_other_way_round(own: float):
    """As FANUC's controllers have it: neither alone brings anything."""
    robot = sk.load_robot("ur5e")
    signs = np.array([1.0, 1.0, 1.0, -1.0, 1.0, -1.0])
    plain = cloud_of(robot, signs, np.zeros(6), seed=2)
    columns = plain.a.copy()
    columns[:, 2] = own * (plain.a[:, 2] + plain.a[:, 1])  # so the joint is own * column - J2
    found = to_the_floor(replace(plain, a=columns))
    assert found.rms < 3.0 * NOISE
    names = [f"J{k}" for k in range(1, 7)]
    told = found.expressions(names)
    assert told[2] == ("-J2 + J3" if own > 0.0 else "-J2 - J3")
    assert [told[k] for k in (0, 1, 3, 4, 5)] == ["J1", "J2", "-J4", "J5", "-J6"]


def test_signs_are_sought_once_more_about_a_sum() -> None:
    """A beam that found the sum first has the wrist the wrong way round: what is told is whole."""
    robot = sk.load_robot("ur5e")
    plain = cloud_of(robot, np.array([1.0, 1.0, 1.0, -1.0, 1.0, -1.0]), np.zeros(6), seed=2)
    columns = plain.a.copy()
    columns[:, 2] = plain.a[:, 2] + plain.a[:, 1]
    cloud = replace(plain, a=columns)
    share = np.eye(6)
    share[2, 1] = -1.0
    rough = Convention(0.1, share, np.zeros(6))
    found = nearer(cloud, rough)
    assert found.rms < 3.0 * NOISE
    told = found.expressions([f"J{k}" for k in range(1, 7)])
    assert told == ["J1", "J2", "-J2 + J3", "-J4", "J5", "-J6"]


def test_a_convention_of_sums_is_one_of_their_columns() -> None:
    first = Convention(0.0, np.array([[1.0, 0.0], [-1.0, 1.0]]), np.array([0.0, np.pi / 2]))
    again = Convention(0.0, np.diag([1.0, -1.0]), np.array([0.0, np.pi])).of(
        first.share, first.zero
    )
    assert again.expressions(["J2", "J3"]) == ["J2", "J2 - J3 + 90 deg"]
    on_a_rail = Convention(0.0, np.eye(2), np.array([0.5, 0.0]))
    assert on_a_rail.expressions(["rail", "J1"], [True, False]) == ["rail + 0.5 m", "J1"]
