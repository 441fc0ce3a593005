"""Parameters that readings do not determine, and the geometric reason."""

from __future__ import annotations

from collections import Counter

import numpy as np

from sk120stiff.effects import LoadCases
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.polish import FAINTEST
from sk120stiff.model import Parameter
from sk120stiff.robot.anatomy import arm_length

ON_AXIS = 1e-6  # share of the arm's length below which a lever is rounding of the URDF's numbers

EACH = 3  # parameters of one effect up to which each has a sentence

NOT_SHOWN = "it does not show in these readings"
SHARED = "these readings tell it together with others only"
OF_SEVERAL = {
    NOT_SHOWN: "they do not show in these readings",
    SHARED: "these readings tell them together with others only",
}


def unseen_reasons(fit: Fit) -> dict[str, str]:
    """Full name → reason, for every estimated parameter that the readings do not determine."""
    load_cases = fit.problem.load_cases
    alone = np.linalg.norm(fit.jacobian, axis=0) * fit.problem.span > FAINTEST
    return {
        p.name: why_unseen(load_cases, p) or (SHARED if shows else NOT_SHOWN)
        for p, shown, shows in zip(fit.parameters, fit.identifiable, alone, strict=True)
        if not shown
    }


def unseen_sentences(fit: Fit) -> list[str]:
    """Each of these parameters in a sentence; many of one effect, on one ground, in one."""
    reasons = unseen_reasons(fit)
    grounds = [(p.effect.id, reasons[p.name]) for p in fit.parameters if p.name in reasons]
    count = Counter(ground for ground in grounds if ground[1] in OF_SEVERAL)
    said: dict[str, None] = {}  # in order, each once
    for (effect, why), name in zip(grounds, reasons, strict=True):
        number = count[effect, why]
        many = f"{number} values of {effect} cannot be seen: {OF_SEVERAL.get(why)}."
        said[many if number > EACH else f"{name} cannot be seen: {why}."] = None
    return list(said)


def why_unseen(load_cases: LoadCases, parameter: Parameter) -> str | None:
    """The geometric reason why no such reading can show a joint's spring; None: there is none.

    A spring turns the point about its joint's axis by c τ. Nothing of it shows where the point lies
    on that axis in every pose, or where no load has a torque about it.

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
    screw = robot.screws(load_cases.a, point=load_cases.force_point).jacobian[:, :, k]
    load = load_cases.wrench
    most = float(np.linalg.norm(load, axis=1).max())
    if np.abs(np.einsum("ni,ni->n", screw, load)).max() > small * most:
        return None
    if robot.prismatic[k]:
        return f"every load is square to the slide of {joint}; push along it"
    across = np.linalg.norm(np.cross(screw[:, 3:], load[:, :3]), axis=1).max()
    if across <= ON_AXIS * most:
        return f"every load is parallel to the axis of {joint}; push across it, or add a moment"
    return f"every load passes through the axis of {joint}; push beside it, or add a moment"
