"""What the parameters of a gear's law amount to together, where none of them says it alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import two_digits
from sk120stiff.explain.judge.budget import internal_covariance
from sk120stiff.explain.judge.gear_curve import STEPS, gear_curves
from sk120stiff.identify import Fit

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation
    from sk120stiff.explain.findings import Finding

JUMPS = 2.0  # standard errors from which on a play that is crossed at once counts as found


@dataclass(frozen=True)
class Whole:
    """The size of one effect as a whole.

    Attributes:
        name: What it is the size of.
        value, std: It and its standard error; None where nothing tells that.
        unit: Of both.
        sentence: The same for people.
    """

    name: str
    value: float
    std: float | None
    unit: str
    sentence: str


def whole_size(answer: Explanation, finding: Finding) -> Whole | None:
    """The size of a named gear law as a whole; None where its parameters say it."""
    tell: Callable[[Fit, Any], Whole | None] | None = TOLD.get(finding.effect.name)
    return None if tell is None else tell(answer.final, finding.effect)


def _play(fit: Fit, effect: Any) -> Whole | None:
    """From one flank to the other: 2 b of each part, b of a part that one side alone has."""
    own = [k for k, p in enumerate(fit.model.parameters) if p.effect == effect]
    sided = [fit.model.parameters[k].spec.name.split("_flank")[0] for k in own]
    weight = np.array([2.0 if name == "half_width" else 1.0 for name in sided])
    values, covariance = fit.model.values[own], internal_covariance(fit)[np.ix_(own, own)]
    value, std = float(weight @ values), _std(weight, covariance)
    said = (
        f"In all it gives way by {_microradians(value, std)} from one flank to the other (twice "
        "the half width)"
    )
    at_once = np.array(["_flank" not in fit.model.parameters[k].spec.name for k in own])
    if not at_once.any():
        return Whole("lost_motion", value, std, "rad", f"{said}, and nowhere at once.")
    jump = float(weight[at_once] @ values[at_once])
    error = _std(weight[at_once], covariance[np.ix_(at_once, at_once)])
    if jump <= JUMPS * (error or 0.0):
        return Whole("lost_motion", value, std, "rad", f"{said}; no jump was found in it.")
    part = ", all of it in a jump" if at_once.all() else f", {_microradians(jump, error)} in a jump"
    return Whole("lost_motion", value, std, "rad", f"{said}{part}.")


def _loop(fit: Fit, effect: Any) -> Whole | None:
    """The whole width of the loop, 2 h of all its parts."""
    own = [k for k, p in enumerate(fit.model.parameters) if p.effect == effect]
    weight, covariance = np.full(len(own), 2.0), internal_covariance(fit)[np.ix_(own, own)]
    value, std = float(weight @ fit.model.values[own]), _std(weight, covariance)
    said = f"Its loop is {_microradians(value, std)} wide in all."
    return Whole("loop", value, std, "rad", said)


def _bend(fit: Fit, effect: Any) -> Whole | None:
    """How much stiffer the gear is at its largest torque than about none, or one way."""
    if effect.sided:
        return _sided(fit, effect)
    curves = gear_curves(fit, [effect.id])
    if not curves:
        return None
    torque, twist = curves[0].torque[:STEPS], curves[0].twist[:STEPS]
    slopes = np.diff(twist) / np.maximum(np.diff(torque), 1e-300)
    first, last = float(slopes[0]), float(slopes[-1])
    if not (first > 0.0 and last > 0.0):
        return None
    ratio = first / last
    said = (
        f"Spring and gear together: {1e-3 / first:.4g} kN·m/rad about no torque, {1e-3 / last:.4g} "
        f"at {torque[-1]:.4g} N·m ({ratio:.3g} times). Its parameters act together: the sign of "
        "one alone says nothing."
    )
    return Whole("stiffening", ratio, None, "1", said)


def _sided(fit: Fit, effect: Any) -> Whole | None:
    """How much softer the gear is under negative torque than under positive."""
    parameters = fit.model.parameters
    extra = sum(p.internal for p in parameters if p.effect == effect)
    spring = sum(
        p.internal for p in parameters if p.effect.joint_spring and p.effect.where == effect.where
    )
    if not (spring > 0.0 and spring + extra > 0.0):
        return None
    ratio = 1.0 + extra / spring
    said = (
        f"Spring and gear together: {1e-3 / spring:.4g} kN·m/rad under positive torque, "
        f"{1e-3 / (spring + extra):.4g} under negative ({ratio:.3g} times as soft)."
    )
    return Whole("softening", ratio, None, "1", said)


TOLD: dict[str, Callable[[Fit, Any], Whole | None]] = {
    "lost_motion": _play,
    "friction_hysteresis": _loop,
    "gear_hardening": _bend,
}


def _std(weight: Array, covariance: Array) -> float | None:
    if not np.isfinite(covariance).all():
        return None
    return float(np.sqrt(max(float(weight @ covariance @ weight), 0.0)))


def _microradians(value: float, std: float | None) -> str:
    micro = f"{1e6 * value:.0f}" if value >= 1e-4 else f"{1e6 * value:.3g}"
    return f"{micro} µrad" if std is None else f"{micro} ± {two_digits(1e6 * std)} µrad"
