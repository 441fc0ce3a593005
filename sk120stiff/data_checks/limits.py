"""Poses beyond the joint limits."""

from __future__ import annotations

import numpy as np

from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

FAR = 0.05  # share of a joint's range, beyond which a pose is no matter of calibration


def limits_doubt(robot: Robot, measurements: Measurements) -> str | None:
    """A sentence where readings were taken far beyond the robot's joint limits; or None."""
    joints = measurements.with_joints(robot.actuated, robot.kinds).joints[measurements.use]
    slack = FAR * np.where(np.isfinite(robot.upper - robot.lower), robot.upper - robot.lower, 0.0)
    out = (joints < robot.lower - slack - 1e-9) | (joints > robot.upper + slack + 1e-9)
    if not out.any():
        return None
    parts = []
    for k in np.flatnonzero(out.any(axis=0)):
        worst = joints[out[:, k], k]
        worst = worst[np.argmax(np.abs(worst - 0.5 * (robot.lower[k] + robot.upper[k])))]
        low, here, high = robot.lower[k], worst, robot.upper[k]
        if not robot.prismatic[k]:
            low, here, high = np.degrees((low, here, high))
        unit = "m" if robot.prismatic[k] else "deg"
        parts.append(f"{robot.actuated[k]} stands at {here:.4g} {unit} ({low:.4g} .. {high:.4g})")
    return (
        f"{int(out.any(axis=1).sum())} of {len(joints)} readings stand beyond the joint limits: "
        f"{', '.join(parts)}. Check the unit, the zero and the order of the joint columns."
    )
