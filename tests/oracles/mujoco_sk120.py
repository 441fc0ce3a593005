"""The SK120 in MuJoCo with its five-bar as a real closed loop of bodies.

Turret, upper arm, forearm on one side; crank and rod on the other; a connect constraint pins the
rod to the forearm's rear lever. The motors' springs act where the motors sit: turret on base,
upper arm on turret, crank on turret. Elbow, crank pin and lever pin turn freely. No joint of this
model reads "absolute forearm elevation": that it behaves so is for the tests to find out.

Lengths are those of the paper's Table I in metres, typed in here, not read from the URDF.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.oracles.mujoco_serial import (
    INERTIAL,
    OPTIONS,
    Spring,
    motion,
    pose_attributes,
    spring_joint,
)
from tests.oracles.mujoco_statics import Deflection, Statics
from tests.oracles.numpy_kinematics import transform

Array = NDArray[np.float64]

PAPER_SPRINGS = (1.4098e6, 4.0076e5, 9.3528e5)  # [N·m/rad] joints 1, 2, 3

SHOULDER = transform([0.215, 0, 0])
ELBOW = transform([0, 0, 1.1])
WRIST = transform([1.3, 0, 0.25])
LEVER = transform([-0.542, 0, 0])
# z out of the flange, x down when all joints read zero
FLANGE = transform([0.23, 0, 0], np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]))
REFLECTOR = (-0.20532, 0.0, 0.11265)  # in tool0 axes

UP, LEFT, RIGHT, AHEAD = np.eye(3)[2], np.eye(3)[1], -np.eye(3)[1], np.eye(3)[0]


def sk120_statics(
    angles: Sequence[float] | Array,
    springs: Sequence[float] = PAPER_SPRINGS,
    wrist: Sequence[float | None] = (None, None, None),
    point: ArrayLike = (0.0, 0.0, 0.0),
    rod: float | None = None,
    timestep: float = 1e-4,
) -> Statics:
    """The loop at the six readings `angles` [rad], spring values in N·m/rad.

    wrist: springs of joints 4, 5, 6; None holds a joint rigid.
    point: loaded and measured point in tool0 axes [m].
    rod: axial stiffness of the rod [N/m]; None for a rigid one.
    """
    t1, t2, t3, *wrist_angles = (float(a) for a in angles)
    relaxed = {"turret": t1, "arm": t2, "crank": t3, "elbow": t2 + t3, "crank_pin": t2 + t3}

    def body(place: Array, joint: str, inside: str) -> str:
        return f"<body {pose_attributes(place)}>{INERTIAL}{joint}{inside}</body>"

    def hinge(name: str, axis: Array, stiffness: float | None = None) -> str:
        angle = relaxed[name]
        return spring_joint(name, Spring(np.eye(4), axis, angle, stiffness))

    def site(name: str, place: Array) -> str:
        return f'<site name="{name}" {pose_attributes(place)}/>'

    # Wrist, from the flange backwards: each elastic joint is a body, rigid ones are folded in.
    wrist_bodies: list[tuple[Array, str]] = []
    place = WRIST
    for index, (axis, angle, stiffness) in enumerate(
        zip((AHEAD, RIGHT, AHEAD), wrist_angles, wrist, strict=True)
    ):
        spring = Spring(np.eye(4), axis, angle, stiffness)
        if stiffness is None:
            place = place @ motion(spring)
            continue
        name = f"wrist_{index + 4}"
        relaxed[name] = angle
        wrist_bodies.append((place, spring_joint(name, spring)))
        place = np.eye(4)
    inner = site("tip", place @ FLANGE @ transform(point))
    for where, joint in reversed(wrist_bodies):
        inner = body(where, joint, inner)

    forearm = body(ELBOW, hinge("elbow", RIGHT), inner + site("lever_end", LEVER))
    upper_arm = body(SHOULDER, hinge("arm", LEFT, springs[1]), forearm)
    rod_end = site("rod_end", ELBOW)
    if rod is not None:
        relaxed["rod"] = 0.0
        slide = spring_joint("rod", Spring(np.eye(4), UP, 0.0, rod, slide=True))
        rod_end = body(np.eye(4), slide, rod_end)
    rod_body = body(LEVER, hinge("crank_pin", LEFT), rod_end)
    crank = body(SHOULDER, hinge("crank", RIGHT, springs[2]), rod_body)
    turret = body(np.eye(4), hinge("turret", UP, springs[0]), upper_arm + crank)
    # solref and solimp matter for time stepping only: there the pin opens by 0.2 nm at 700 N
    pin = '<connect site1="rod_end" site2="lever_end" solref="4e-4 1" solimp="0.9999 0.9999 1"/>'
    xml = (
        f"<mujoco>{OPTIONS.format(timestep=timestep)}<worldbody>{turret}</worldbody>"
        f"<equality>{pin}</equality></mujoco>"
    )
    return Statics(xml, relaxed)


def deflect_sk120(
    angles: Sequence[float] | Array,
    wrench: ArrayLike,
    springs: Sequence[float] = PAPER_SPRINGS,
    wrist: Sequence[float | None] = (None, None, None),
    point: ArrayLike = (0.0, 0.0, 0.0),
    rod: float | None = None,
) -> Deflection:
    """Exact deflection of `point` (tool0 axes) under a base-frame wrench acting there.

    angles: six joint readings [rad]; wrench: [fx fy fz mx my mz] in N, N·m, constant in base axes.
    The loop is closed to 1e-12 m; the displacement is exact to about 1e-12 m.
    """
    return sk120_statics(angles, springs, wrist, point, rod).deflection(wrench)
