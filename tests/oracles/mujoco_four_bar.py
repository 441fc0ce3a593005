"""A four-bar on a turret in MuJoCo, with its loop closed by a constraint between bodies.

Driven link 0.5 m from the origin of the column, rocker 0.7 m from (0.4, −0.1), pins of the coupler
0.45 m apart; the tool is fixed to the coupler. Springs sit at the turret and at the driven link;
the other pins turn freely. The closed pose comes from two circles that meet.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.oracles.mujoco_serial import INERTIAL, OPTIONS, Spring, pose_attributes, spring_joint
from tests.oracles.mujoco_statics import Statics
from tests.oracles.numpy_kinematics import rotation, transform

Array = NDArray[np.float64]
DRIVEN, ROCKER, PINS = 0.5, 0.7, 0.45
PIVOT = np.array([0.4, -0.1])  # of the rocker: x, z in the column
COLUMN = transform([0.1, 0, 0.5])
TOOL = transform(
    [0.8, 0.05, 0.3],
    rotation([0, 0, 1], -0.3) @ rotation([0, 1, 0], 0.4) @ rotation([1, 0, 0], 0.2),
)


def closed_angles(drive: float) -> tuple[float, float]:
    """Angles of the coupler against the driven link and of the rocker, about +y, knee up."""
    end = DRIVEN * np.array([np.sin(drive), np.cos(drive)])
    gap = PIVOT - end
    distance = float(np.linalg.norm(gap))
    along = (PINS**2 - ROCKER**2 + distance**2) / (2 * distance)
    across = np.sqrt(PINS**2 - along**2)
    unit = gap / distance
    pin = end + along * unit + across * np.array([-unit[1], unit[0]])
    coupler = -np.arctan2(*(pin - end)[::-1])  # its pin lies along its own x
    rocker = np.arctan2(*(pin - PIVOT))
    return float(coupler - drive), float(rocker)


def four_bar_statics(turret: float, drive: float, springs: ArrayLike, point: ArrayLike) -> Statics:
    """The loop at two driven angles [rad]; springs (2,) in N·m/rad; point in tool axes [m]."""
    knee, rock = closed_angles(drive)
    relaxed = {"turret": turret, "drive": drive, "knee": knee, "rock": rock}
    k_turret, k_drive = np.asarray(springs, float)

    def body(place: Array, name: str, axis: Array, stiffness: float | None, inside: str) -> str:
        hinge = spring_joint(name, Spring(np.eye(4), axis, relaxed[name], stiffness))
        return f"<body {pose_attributes(place)}>{INERTIAL}{hinge}{inside}</body>"

    def site(name: str, place: Array) -> str:
        return f'<site name="{name}" {pose_attributes(place)}/>'

    up, left = np.eye(3)[2], np.eye(3)[1]
    tip = site("tip", TOOL @ transform(point))
    pin = site("coupler_end", transform([PINS, 0, 0]))
    coupler = body(transform([0, 0, DRIVEN]), "knee", left, None, tip + pin)
    driven = body(np.eye(4), "drive", left, k_drive, coupler)
    end = site("rocker_end", transform([0, 0, ROCKER]))
    rocker = body(transform([PIVOT[0], 0, PIVOT[1]]), "rock", left, None, end)
    column = body(COLUMN, "turret", up, k_turret, driven + rocker)
    xml = (
        f"<mujoco>{OPTIONS.format(timestep=1e-4)}<worldbody>{column}</worldbody><equality>"
        '<connect site1="coupler_end" site2="rocker_end" solref="4e-4 1" '
        'solimp="0.9999 0.9999 1"/></equality></mujoco>'
    )
    return Statics(xml, relaxed)
