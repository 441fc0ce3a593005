"""Why a place is out of reach: the arm is too short, or a joint's limit stands in the way."""

from __future__ import annotations

import numpy as np

from sk120stiff.workspace.arm import ElasticArm
from sk120stiff.workspace.inverse import Task, middle_of, near, solve_inverse, starting_poses

STARTS = 64


def why_unreached(arm: ElasticArm, target: Task) -> str:
    """Why the arm does not reach a target, in words; it is sought again without joint limits.

    Args:
        arm: The arm, its limits less their margins.
        target: One position, with an axis or a rotation or without.
    """
    many = target.rows(np.zeros(STARTS, dtype=np.intp))
    rest = np.clip(np.zeros(arm.n), arm.lower, arm.upper)
    free = solve_inverse(arm, many, starting_poses(arm, STARTS, rest), limits=False)
    if not free.found.any():
        return "no posture puts the tool there, whatever the joint limits"
    a = near(arm, free.a[free.found], middle_of(arm))
    beyond = np.maximum(arm.lower - a, a - arm.upper)
    nearest = int(np.argmin(beyond.max(axis=1)))
    joint = int(np.argmax(beyond[nearest]))
    value, unit = (1e3, "mm") if arm.slides[joint] else (180.0 / np.pi, "deg")
    low, high, stands = (value * x[joint] for x in (arm.lower, arm.upper, a[nearest]))
    return (
        f"{arm.joints[joint]} would have to stand at {stands:.4g} {unit}, and has "
        f"{low:.4g} to {high:.4g} {unit}"
    )
