"""`sk120stiff stiffness ROBOT --pose ... --wrench ...`."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import frame_at, open_model, pose_of, wrench_of
from sk120stiff.cli.options import (
    AtOption,
    BaseOption,
    ModelOption,
    PoseOption,
    RobotOrModelArgument,
    ToolOption,
    WrenchOption,
)
from sk120stiff.cli.tables import table
from sk120stiff.cli.uncertainty import plus_minus, sentences, uncertainty_keys
from sk120stiff.errors import two_digits
from sk120stiff.model import (
    LoadedStiffness,
    LoadedUncertainty,
    Model,
    loaded_stiffness,
    loaded_uncertainty,
)
from sk120stiff.model.predicted import blame_reason
from sk120stiff.stiffness import Definiteness

ROUNDING = 1e-12
UNITS = {
    "pose": "rad (m for joints that slide)",
    "wrench": "N, N*m; [force; moment], base axes",
    "jacobian": "m/rad, rad/rad; [linear; angular], base axes",
    "K_theta": "N*m/rad; null: rigid",
    "K_C": "N*m/rad",
    "K_gravity": "N*m/rad, of the arm's own weight; K_theta - K_C is meant less it everywhere",
    "K_X": "N/m; null: in a direction the arm cannot yield",
    "K_X_6x6": "N/m, N/rad, N*m/rad; null: fewer than six directions yield",
    "compliance": "m/N, rad/N, rad/(N*m)",
    "principal_stiffness": "N/m; null: rigid",
    "deflection": "m; null: none exists, see why_null",
    "critical_load_factor": "1; null: this load is never critical",
    "uncertainty": "as what it belongs to; null: unknown, or not stored",
}


def command(
    robot: RobotOrModelArgument,
    pose: PoseOption = None,
    wrench: WrenchOption = None,
    model: ModelOption = None,
    at: AtOption = None,
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """How stiff the arm is: here, this way, under this load.

    Prints the Cartesian stiffness with and without the load's own contribution (K_C), the softest
    and stiffest directions, whether the arm is stable, and how far the load bends it. With a model
    that 'identify' or 'explain' wrote, ± their standard uncertainty.

    Example: sk120stiff stiffness motoman_sk120 --pose 'joint_2_l=20 deg' --wrench '0,0,-490 N'
    """
    believed = open_model(robot, model, base=base, tool=tool)
    arm = believed.robot
    a, load = pose_of(arm, pose), wrench_of(wrench)
    frame = frame_at(arm, at)
    found = loaded_stiffness(believed, a, load, frame)
    uncertainty = loaded_uncertainty(believed, a, load, found, frame)
    document = {
        "robot": arm.name,
        "base_frame": arm.base_frame,
        "at": frame,
        "coordinates": found.coordinates,
        "soft": found.soft,
        "soft_under_load": found.soft_under_load,
        "pose": a,
        "wrench": load,
        "jacobian": found.jacobian,
        "K_theta": found.K_theta,
        "K_C": found.K_C,
        "K_gravity": found.K_gravity,
        "K_X_conventional": _if_it_exists(found.K_X_conventional),
        "K_X_enhanced": _if_it_exists(found.K_X_enhanced),
        "K_X_6x6_conventional": _if_it_exists(found.K_X_6x6_conventional),
        "K_X_6x6_enhanced": _if_it_exists(found.K_X_6x6_enhanced),
        "compliance": {
            "conventional": found.compliance_conventional,
            "enhanced": found.compliance_enhanced,
        },
        "principal_stiffness": found.principal,
        "definiteness": {
            "K_C": found.definiteness_of_K_C,
            "K_theta_minus_K_C": found.definiteness_of_K_theta_minus_K_C,
        },
        "deflection": {
            "conventional": found.deflection_conventional,
            "enhanced": _if_it_exists(found.deflection_enhanced),
            "equilibrium": _if_it_exists(found.deflection_equilibrium),
            "why_null": found.no_deflection,
        },
        "critical_load_factor": found.critical_factor,
        "uncertainty": _uncertainty(believed, uncertainty),
        "units": UNITS,
    }
    parts = _parts(arm.name, frame, found, load, uncertainty)
    return Answer(document, parts=[*parts, *_uncertainty_notes(believed, uncertainty, load)])


def _uncertainty(model: Model, uncertainty: LoadedUncertainty | None) -> dict[str, object]:
    keys = uncertainty_keys(model)
    if uncertainty is None:
        return keys
    bent = uncertainty.deflection
    return {
        **keys,
        "principal_stiffness": {
            "std": uncertainty.principal,
            "interval_95": uncertainty.principal_interval,
        },
        "deflection": {
            "std_parameters": None if bent is None else _single(bent.std_parameters),
            "std_remainder": None if bent is None else _single(bent.std_remainder),
        },
        "unknown_because": blame_reason(uncertainty.blame) or None,
    }


def _single(std: Array | None) -> Array | None:
    return None if std is None else std[0]


def _uncertainty_notes(
    model: Model, uncertainty: LoadedUncertainty | None, load: Array
) -> list[str]:
    if uncertainty is None:
        return sentences(model, None, None)
    bent = uncertainty.deflection
    said = []
    if load.any() and bent is not None:
        said += sentences(model, bent.std_parameters, bent.std_remainder)
    if uncertainty.blame:
        said.append(f"A ± of '?' {blame_reason(uncertainty.blame)}.")
    return said


def _with(value: float, std: float | None, factor: float) -> object:
    return value * factor if std is None else plus_minus(value * factor, std * factor)


def _cells(std: Array) -> list[str]:
    return [two_digits(x * 1e6) if np.isfinite(x) else "?" for x in std]


def _seen(values: Array) -> Array:
    """The same without what is rounding beside the largest known of them."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    return np.where(np.abs(values) > ROUNDING * largest, values, 0.0)


def _if_it_exists(matrix: Array) -> Array | None:
    return matrix if np.isfinite(matrix).all() else None


def _parts(
    name: str,
    frame: str,
    found: LoadedStiffness,
    load: Array,
    uncertainty: LoadedUncertainty | None,
) -> list[object]:
    axes = ("x", "y", "z")
    stiffness: object = "K_X does not exist here: in a direction the arm cannot yield."
    if np.isfinite(found.K_X_enhanced).all() and np.isfinite(found.K_X_conventional).all():
        both = np.hstack([_seen(found.K_X_conventional), _seen(found.K_X_enhanced)])
        stiffness = table(
            "Stiffness K_X [N/µm], conventional | enhanced",
            ["", *axes, *axes],
            [(axis, *row) for axis, row in zip(axes, both * 1e-6, strict=True)],
        )
    principal = table(
        "Principal stiffness, softest first, unstable last",
        ["", "N/µm", *axes],
        [
            (
                str(k + 1),
                _with(value, None if uncertainty is None else uncertainty.principal[k], 1e-6),
                *(f"{round(component, 4) + 0.0:.4f}" for component in direction),
            )
            for k, (value, direction) in enumerate(
                zip(found.principal.values, found.principal.directions, strict=True)
            )
        ],
    )
    deflections = {
        "conventional": found.deflection_conventional,
        "enhanced": found.deflection_enhanced,
        "at equilibrium": found.deflection_equilibrium,
    }
    rows: list[tuple[object, ...]] = [
        (label, *(1e6 * component for component in (*_seen(x), np.linalg.norm(x))))
        for label, x in deflections.items()
        if np.isfinite(x).all()
    ]
    if (
        uncertainty is not None
        and uncertainty.deflection is not None
        and uncertainty.deflection.std is not None
    ):
        rows.append(
            ("  ± (one standard deviation)", *_cells(_seen(uncertainty.deflection.std[0])), "")
        )
    deflection = table("Deflection [µm]", ["", *axes, "length"], rows)
    besides = "; under this load also: " if found.soft_under_load else ""
    parts: list[object] = [
        f"{name}, {frame}; what yields: {', '.join(found.soft)}{besides}"
        + ", ".join(found.soft_under_load),
        stiffness,
        principal,
    ]
    if not load.any():
        return [*parts, "No load was given: K_C is zero and nothing deflects."]
    classes = (
        f"K_C is {found.definiteness_of_K_C}, "
        f"K_theta - K_C is {found.definiteness_of_K_theta_minus_K_C}."
    )
    if found.definiteness_of_K_theta_minus_K_C != Definiteness.POSITIVE_DEFINITE:
        classes += " The unloaded pose is not stable under this load."
    lost = "equilibrium" in found.no_deflection
    growth = (
        "The springs alone are indefinite here: the arm is unstable before any load."
        if found.critical_factor == 0.0
        else f"The unloaded pose, before it bends, becomes unstable at {found.critical_factor:.4g} "
        "times this load."
        if lost and np.isfinite(found.critical_factor)
        else f"{found.critical_factor:.4g} times this load would make the arm unstable."
        if np.isfinite(found.critical_factor)
        else "No multiple of this load makes the unloaded pose unstable."
        if lost
        else "No multiple of this load makes the arm unstable."
    )
    missing = [f"No {label} deflection: {why}." for label, why in found.no_deflection.items()]
    if lost:
        missing.append(
            "The conventional deflection takes the springs alone, as if the load were small: here "
            "it is no place where the arm can be."
        )
    if "enhanced" in found.no_deflection and not lost:
        missing.append(
            "Followed from zero load, the arm bends away from its pose and comes to rest where the "
            "last row says; K_X holds at the unloaded pose, not there."
        )
    return [*parts, deflection, *missing, classes, growth]
