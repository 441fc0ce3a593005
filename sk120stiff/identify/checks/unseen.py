"""Why the readings say nothing of a parameter, and what to do about it."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.polish import FAINTEST
from sk120stiff.model import Parameter
from sk120stiff.robot.anatomy import arm_length

ON_AXIS = 1e-6  # share of the arm's length below which a lever is rounding of the URDF's numbers

NOT_SHOWN = "it does not show in these readings"
SHARED = "these readings tell it together with others only"


def unseen_reasons(fit: Fit) -> dict[str, str]:
    """Full name → reason, for every estimated parameter that the readings do not determine."""
    load_cases = fit.problem.load_cases
    alone = np.linalg.norm(fit.jacobian, axis=0) * fit.problem.span > FAINTEST
    return {
        p.name: why_unseen(load_cases, p) or (SHARED if shows else NOT_SHOWN)
        for p, shown, shows in zip(fit.parameters, fit.identifiable, alone, strict=True)
        if not shown
    }


def why_unseen(load_cases: LoadCases, parameter: Parameter) -> str | None:
    """The geometric reason why no such reading can show a joint's spring; None: there is none.

    A spring turns the point about its joint's axis by c τ. Nothing of it shows where the point lies
    on that axis in every pose, or where every load passes through it.

    Args:
        load_cases: Poses (N, n), loads and points of the readings, taken or planned.
        parameter: The parameter; only a joint's spring has a reason of this kind.
    """
    if not parameter.effect.joint_spring or not load_cases.count:
        return None
    robot, joint = load_cases.robot, parameter.effect.where
    k = robot.actuated.index(joint)
    small = ON_AXIS * arm_length(robot)
    moved = np.linalg.norm(load_cases.nominal.jacobian[:, :3, k], axis=1)
    if not robot.prismatic[k] and moved.max() <= small:
        return (
            f"the point lies on the axis of {joint}; give a point off the axis (--point of 'plan', "
            "point: in the YAML file of the readings)"
        )
    if _torques(load_cases)[:, k].max() <= small * _largest_load(load_cases):
        return f"every load passes through the axis of {joint}; push beside it, or add a moment"
    return None


def _torques(load_cases: LoadCases) -> Array:
    """(N, n) size of the torque that each load puts on each actuated joint [N·m or N]."""
    at_load = load_cases.robot.screws(load_cases.a, point=load_cases.force_point)
    return np.asarray(np.abs(np.einsum("nij,ni->nj", at_load.jacobian, load_cases.wrench)))


def _largest_load(load_cases: LoadCases) -> float:
    return float(np.linalg.norm(load_cases.wrench, axis=1).max())
