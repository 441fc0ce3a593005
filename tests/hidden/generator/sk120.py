"""The Motoman SK120 by hand from its published dimensions, with its five-bar as a real loop."""

from __future__ import annotations

import numpy as np

from .arm import Arm, ArmJoint, Loop, Typical
from .rotations import placement

AHEAD = 0.215  # joint 1 axis to joint 2 axis
UPPER = 1.100
FOREARM = 1.300
RISE = 0.250  # wrist centre above the forearm line
LEVER = 0.542
FLANGE = 0.230


def sk120() -> Arm:
    """x forward, z up, base frame at shoulder height. Zero: upper arm up, forearm forward."""
    x, y, z = np.eye(3)
    turn = np.pi

    def joint(name: str, xyz: tuple[float, float, float], axis: np.ndarray, link: str) -> ArmJoint:
        return ArmJoint(name, placement(xyz), axis, False, -turn, turn, link)

    joints = (
        joint("joint_1_s", (0, 0, 0), z, "link_1_s"),
        joint("joint_2_l", (AHEAD, 0, 0), y, "link_2_l"),
        joint("elbow", (0, 0, UPPER), -y, "link_3_u"),  # passive: the rod sets its angle
        joint("joint_4_r", (FOREARM, 0, RISE), x, "link_4_r"),
        joint("joint_5_b", (0, 0, 0), -y, "link_5_b"),
        joint("joint_6_t", (0, 0, 0), x, "link_6_t"),
    )
    flange = placement((FLANGE, 0, 0), np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]))
    degrees = np.pi / 180.0
    limits = {
        "joint_1_s": (-120 * degrees, 120 * degrees),
        "joint_2_l": (-45 * degrees, 60 * degrees),
        "joint_3_u": (-70 * degrees, 30 * degrees),
        "joint_4_r": (-150 * degrees, 150 * degrees),
        "joint_5_b": (-110 * degrees, 110 * degrees),
        "joint_6_t": (-180 * degrees, 180 * degrees),
    }
    loop = Loop(
        follower=2,
        pivot=1,
        driver="joint_3_u",
        crank_axis=-y,
        crank=np.array([-LEVER, 0.0, 0.0]),
        lever=np.array([-LEVER, 0.0, 0.0]),
        rod=UPPER,
    )
    typical = Typical(
        joint={"joint_1_s": 1.41e6, "joint_2_l": 4.0e5, "joint_3_u": 9.4e5},
        wrist={"joint_4_r": 3.0e5, "joint_5_b": 3.0e5, "joint_6_t": 3.0e5},
    )
    return Arm(
        name="sk120",
        reference="motoman_sk120",
        base_frame="base_link",
        tool_frame="tool0",
        joints=joints,
        tool=flange,
        actuated=tuple(limits),
        limits=limits,
        typical=typical,
        loop=loop,
    )
