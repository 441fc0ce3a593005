"""What the product's parameters should read if it finds a cause: names and SI values.

Only quantities with the same meaning on both sides stand here; a tapered link has no exact EI.
"""

from __future__ import annotations

from collections.abc import Mapping

from .world import Cause

RECIPROCAL = {
    "joint_springs": {"compliance": "stiffness"},
    "joint_tilt": {"first": "stiffness_along", "second": "stiffness_across"},
    "base_rocking": {"x": "stiffness_x", "y": "stiffness_y"},
    "base_sliding": {"x": "stiffness_x", "y": "stiffness_y", "z": "stiffness_z"},
    "tool_compliance": {
        **{f"r{axis}": f"stiffness_turn_{axis}" for axis in "xyz"},
        **{f"t{axis}": f"stiffness_shift_{axis}" for axis in "xyz"},
    },
    "closure_rod": {"compliance": "stiffness"},
    "closure_coupling": {"compliance": "cross_stiffness"},
}
DIRECT = {
    "lost_motion": {"half_width": "half_width"},
    "friction_hysteresis": {"half_width": "half_width"},
    "force_scale": {axis: f"gain_{axis}" for axis in "xyz"},
    "force_bias": {axis: f"force_{axis}" for axis in "xyz"},
    "force_rotation": {axis: f"angle_{axis}" for axis in "xyz"},
    "force_crosstalk": {a + b: f"{b}_to_{a}" for a in "xyz" for b in "xyz" if a != b},
    "reading_rotation": {axis: f"angle_{axis}" for axis in "xyz"},
    "reading_scale": {"share": "scale"},
    "reading_drift": {axis: f"rate_{axis}" for axis in "xyz"},
    "joint_offset": {"offset": "offset"},
    "tool_offset": {axis: f"offset_{axis}" for axis in "xyz"},
    "link_length": {"length": "offset"},
}


def quantities(cause: Cause, springs: Mapping[str, float]) -> dict[str, float]:
    """Parameter name -> true value (SI), as the product's model file would write it."""
    out = {}
    for key, value in cause.sizes.items():
        if key in RECIPROCAL.get(cause.name, {}):
            out[RECIPROCAL[cause.name][key]] = 1.0 / value
        if key in DIRECT.get(cause.name, {}):
            out[DIRECT[cause.name][key]] = value
    if cause.name == "gear_hardening" and "cubic" in cause.sizes:
        full = float(cause.options["T"])  # type: ignore[arg-type]
        out["cubic"] = springs[cause.where] * cause.size("cubic") / (3.0 * full**2)
    return out
