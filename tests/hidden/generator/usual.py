"""Sizes beyond which nobody would believe a cause, however visible it had to be made."""

from __future__ import annotations

from .arm import Arm
from .world import Cause

LARGEST = {
    "force_scale": 0.04,
    "force_rotation": 0.06,
    "force_crosstalk": 0.05,
    "reading_rotation": 0.02,
    "reading_drift": 2e-5,
    "zero_offset": 1e-4,
    "lost_motion": 5e-4,
    "friction_hysteresis": 3e-4,
    "joint_offset": 0.012,
    "tool_offset": 0.012,
    "link_length": 0.012,
    "gravity_compensator": 0.12,
}  # SI; rad, m, shares


def unusual(cause: Cause, arm: Arm) -> bool:
    """Whether one of the sizes is beyond belief."""
    largest = LARGEST.get(cause.name, float("inf"))
    if cause.name == "force_bias":
        largest = 0.06 * arm.typical.force
    return any(abs(value) > largest for value in cause.sizes.values())
