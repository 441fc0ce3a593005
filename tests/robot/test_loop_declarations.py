"""Closures in robot.yaml: what they say, what is refused and with which words."""

from __future__ import annotations

import numpy as np
import pytest

from sk120stiff.errors import InputError, Refusal
from sk120stiff.robot import load_robot
from sk120stiff.robot.loops.coupling import LoopCoupling, OpenLoop
from tests.oracles.mujoco_four_bar import closed_angles
from tests.robot.loop_arms import (
    FOUR_BAR,
    SK120_LOOP,
    SK120_MOTORS,
    cylinder,
    four_bar,
    joint,
    sk120_loop,
    write_robot,
)


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    return sk120_loop(tmp_path_factory.mktemp("sk120"))


@pytest.fixture(scope="module")
def quad(tmp_path_factory):
    return four_bar(tmp_path_factory.mktemp("quad"))


def test_poses_that_cannot_be_closed_are_refused_by_name(quad, loop):
    with pytest.raises(OpenLoop, match=r"drive = 143.239 deg: the loop 'quad'") as caught:
        quad.jacobian([[0.0, 0.1], [0.3, 2.5], [0.2, 2.6]])
    assert isinstance(caught.value, Refusal) and list(caught.value.rows) == [1, 2]
    assert "2 of 3 poses" in str(caught.value)
    dead = [0.3, np.pi / 4, np.pi / 4, 0, 0, 0]
    with pytest.raises(OpenLoop, match=r"dead point.*not determined"):
        loop.jacobian(dead)
    with pytest.raises(OpenLoop, match=r"only through a dead point.*start"):
        loop.jacobian([0.3, 1.0, 1.0, 0, 0, 0])
    mask = loop.closes([dead, [0.3, 1.0, 1.0, 0, 0, 0], [0, 0.1, 0.2, 0, 0, 0]])
    assert list(mask) == [False, False, True]
    # the margin shrinks with the transmission angle's sine, here cos(θ2 + θ3)
    folded = [[0, 0.5 * s, 0.5 * s, 0, 0, 0] for s in (0.0, 1.2, 1.5)]
    assert list(loop.closes(folded)) == [True, True, True]
    assert list(loop.closes(folded, 0.02)) == [True, True, False]
    assert list(loop.closes(folded, 0.1)) == [True, False, False]


def test_robots_that_cannot_stand_at_zero_have_a_rest(tmp_path, quad):
    robot = cylinder(tmp_path)
    assert np.allclose(robot.rest, [0, 0, 0.76]) and robot.closes(robot.rest)
    assert not quad.rest.any() and not load_robot("motoman_sk120").rest.any()


def test_a_pose_out_of_reach_is_told_from_a_dead_point(tmp_path):
    with pytest.raises(OpenLoop, match=r"piston = 0 mm.*a link would have to be longer"):
        cylinder(tmp_path).jacobian([0.3, 0, 0.0])


def load_with(tmp_path, closure, text=FOUR_BAR, **keys):
    keys = {"base_frame": "base", "tool_frame": "tool", "actuated": ["turret", "drive"], **keys}
    keys = {name: value for name, value in keys.items() if value is not None}
    write_robot(tmp_path, text, closures=[closure], **keys)
    return load_robot(tmp_path)


GOOD = {"name": "quad", "frames": ["coupler_end", "rocker_end"], "start": {"knee": 0.1}}
BAD = {
    "unknown frame": ({"frames": ["coupler_end", "rocker"[:-1]]}, {}, "no frame 'rocke'.*Frames"),
    "one body": ({"frames": ["coupler_end", "tool"]}, {}, "on one body"),
    "unknown joint": ({"dependent": ["elbow"]}, {}, "no moving joint 'elbow'"),
    "actuated": ({"dependent": ["drive"]}, {}, "'drive' cannot depend .* it is actuated"),
    "not in a loop": ({"dependent": ["turret"]}, {"actuated": ["drive"]}, "it is in no loop"),
    "locked": ({"dependent": ["knee"]}, {"lock": {"knee": 0.1}}, "'knee' .* it is locked"),
    "nothing free": ({}, {"actuated": ["turret", "drive", "knee", "rock"]}, "nothing can close"),
    "too few": ({"dependent": ["knee"]}, {"lock": {"rock": 0.3}}, "a gap of .* mm stays"),
    "too many": ({}, {"actuated": ["turret"]}, "determine 2 joints, but 3 are left.*dependent:"),
    "who drives": ({}, {"actuated": None}, "which joints .* have a motor.*drive, knee, rock"),
    "no direction": ({"type": "axis", "axis": [0, 0, 0]}, {}, "no direction"),
    "wrong axis": ({"type": "axis", "axis": [1, 0, 0]}, {}, "a gap of .* mm stays"),
    "unknown start": ({"start": {"elbow": 0.1}}, {}, "no moving joint 'elbow'"),
    "far start": ({"start": {"drive": 2.5}}, {}, "a gap of .* mm stays.*start:"),
    "unknown key": ({"depends": ["knee"]}, {}, "closures.0.depends"),
    "unknown type": ({"type": "ball"}, {}, "closures.0.type"),
}  # fmt: skip


@pytest.mark.parametrize("why", BAD)
def test_closures_that_make_no_sense_are_refused(why, tmp_path):
    change, keys, message = BAD[why]
    with pytest.raises(InputError, match=message) as caught:
        load_with(tmp_path, {**GOOD, **change}, **keys)
    assert caught.value.remedy and caught.value.where
    assert load_with(tmp_path / "good", GOOD).dependent == ("knee", "rock")


def test_two_closures_of_one_name_are_refused(tmp_path):
    write_robot(tmp_path, FOUR_BAR, base_frame="base", tool_frame="tool",
                actuated=["turret", "drive"], closures=[GOOD, GOOD])  # fmt: skip
    with pytest.raises(InputError, match="two closures have this name"):
        load_robot(tmp_path)


def test_locked_and_driven_joints_share_a_loop(tmp_path):
    """A five-bar whose fifth joint is held is a four-bar."""
    text = FOUR_BAR.replace('link="rocker"', 'link="foot"', 1).replace(
        '<link name="rocker"/>', '<link name="rocker"/><link name="foot"/>'
    )
    text = text.replace("</robot>", joint("fold", "foot", "rocker", "0 0 0") + "</robot>")
    robot = load_with(tmp_path, GOOD, text, lock={"fold": 0.0})
    assert robot.locked == {"fold": 0.0}
    assert np.isclose(robot.joint_values([0.0, 0.3])["knee"], closed_angles(0.3)[0])


def test_actuated_joints_follow_from_dependent_ones(tmp_path):
    robot = load_with(tmp_path, {**GOOD, "dependent": ["knee", "rock"]}, actuated=None)
    assert robot.actuated == ("turret", "drive")
    assert isinstance(robot.coupling, LoopCoupling)
    assert [closure.name for closure in robot.closures] == ["quad"]
    other = load_with(tmp_path / "b", {**GOOD, "dependent": ["drive", "rock"]}, actuated=None)
    assert other.actuated == ("turret", "knee")
    knee = closed_angles(0.3)[0]
    assert np.isclose(other.joint_values([0.0, knee])["drive"], 0.3, atol=1e-12)


def test_the_loops_joints_are_found_without_being_named(tmp_path):
    write_robot(tmp_path, SK120_LOOP, base_frame="base_link", tool_frame="tool0",
                actuated=SK120_MOTORS,
                closures=[{"frames": ["rod_end", "forearm_lever_end"]}])  # fmt: skip
    robot = load_robot(tmp_path)
    assert set(robot.dependent) == {"joint_elbow", "joint_rod"}
    assert robot.closures[0].name == "rod_end = forearm_lever_end"
    assert robot.locked == {}
