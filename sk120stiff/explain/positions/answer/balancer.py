"""Waves of a joint once per turn: of its gear, or of a balancer or weight that put a torque on it.

A spring that lifts an arm, or a mass that no URDF states, puts a torque on the joint that goes with
the sine of its angle once per turn. So does the whole arm where its URDF states no masses. Where
nothing else tells that torque, the joint's own spring turns it into a wave that neither pose nor
payload tells from a gear which is not round. Only its size does: with lognormal sizes p of either,
that which was read with its error speaks for one over the other by the ratio of
∫ p(A) N(A; read, error) dA (Bayes).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.effects.gravity_compensator import GravityCompensator
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.errors import two_digits
from sk120stiff.explain.positions.answer.explained import SURE, Named
from sk120stiff.explain.priors import USUAL
from sk120stiff.identify.positions.calibrate import Calibration

GEARS = (1e-4, 3e-4)  # rad once per turn: two of three gears of robots (an arc minute is 3e-4)
BALANCERS = (3e-4, 3e-3)  # rad: the same of torques that nobody stated, over springs of joints
BALANCED = USUAL  # probability of such a torque at a joint that it could lift, beforehand
LEAST, MOST, STEPS = 1e-6, 1e-1, 2000  # rad: sizes over which is summed, in even ratios
ROUNDED = 0.01  # of the wave, its error at least


def or_balancer(item: Named, final: Calibration) -> Named:
    """The name with the balancer that may stand behind it; as it is where its gear may make it."""
    name = _behind(item.effect, final)
    if name is None or name in item.others:  # poses tell it
        return item
    known = (*item.alternatives, name), (*item.exact, name)
    more, exact = (tuple(dict.fromkeys(names)) for names in known)
    return replace(item, alternatives=more, exact=exact, untold=(name,))


def shared(
    probabilities: dict[str, float], named: Sequence[Named], final: Calibration
) -> dict[str, float]:
    """Probabilities in which gear and balancer share that of their wave, by its size."""
    out = dict(probabilities)
    for item in named:
        for name in item.untold:
            own = out.get(item.effect.id, item.probability)
            share = chance_of_gear(*_wave(item.effect, final))
            out[item.effect.id], out[name] = own * share, own * (1.0 - share)
    return out


def balancing(final: Calibration) -> tuple[str, ...]:
    """What such waves may be instead, in sentences."""
    said = []
    for effect in final.model.effects:
        if _behind(effect, final) is None:
            continue
        wave = two_digits(1e3 * _wave(effect, final)[0])
        low, high = (two_digits(1e3 * size) for size in GEARS)
        torque = _torque(effect, final)
        what = (
            "the arm's own weight, which the URDF does not state, stands it off alike on the "
            "joint's spring, and no pose tells which. State masses and their centres."
            if torque is None
            else "a balancer (a spring, a gas strut) or masses of the arm that the URDF does not "
            f"state, with {two_digits(torque)} N·m at most, stand it off alike, and neither pose "
            "nor payload tells which."
        )
        said.append(
            f"Once per turn {effect.where} stands off by {wave} mrad, where gears usually do by "
            f"{low} to {high}: {what}"
        )
    return tuple(said)


def tell_apart(named: Sequence[Named]) -> tuple[str, ...]:
    """What tells a gear from a balancer or from weight, in sentences."""
    return tuple(
        f"To tell the gear of {item.effect.where} from the arm's weight on its spring: write the "
        "maker's masses and centres of mass into the URDF, or read some of these poses under a "
        "payload too, which tells the spring. Until then either foretells positions alike."
        if item.untold[0].startswith("joint_springs")
        else f"To tell the gear of {item.effect.where} from a balancer or masses: read some of "
        "these poses again with the balancer's pressure or spring released, or the joint without "
        "the arm on it, or compare the torque of its motor at rest with that of the URDF's "
        "masses. A balancer or masses that are known belong into the URDF or the payload. Until "
        "then either foretells positions alike."
        for item in named
        if item.untold
    )


def chance_of_gear(wave: float, error: float) -> float:
    """Probability that a gear alone makes a wave of such an amplitude, read with an error [rad]."""
    sizes = np.geomspace(LEAST, MOST, STEPS)
    read = np.exp(-0.5 * ((sizes - wave) / max(error, ROUNDED * wave, LEAST)) ** 2)
    gear, other = (float(_usual(sizes, *of) @ read) for of in (GEARS, BALANCERS))
    gear, other = (1.0 - BALANCED) * gear, BALANCED * other
    return gear / max(gear + other, 1e-300)


def _usual(sizes: Array, low: float, high: float) -> Array:
    """Lognormal density of sizes per ratio, of which two thirds lie between two."""
    spread = 0.5 * np.log(high / low)
    off = np.log(sizes / np.sqrt(low * high)) / spread
    return np.asarray(np.exp(-0.5 * off**2) / spread)


def _behind(effect: Effect, final: Calibration) -> str | None:
    """Id of what may make the waves of an effect instead of the gear of its joint.

    None where its gear surely makes them, or nothing can: what hangs beyond another joint goes with
    the angles of both, and is no wave of one; and loads under which a joint did not yield say that
    weight does not turn it.
    """
    if not isinstance(effect, TransmissionError) or chance_of_gear(*_wave(effect, final)) >= SURE:
        return None
    if _torque(effect, final) is not None:
        return f"{GravityCompensator.name}:{effect.where}"
    robot = final.model.robot
    weighs = robot.mechanism().chain.weighs or not robot.gravity_in_base.any()
    loaded = final.problem.said.payload.any() or final.problem.measurements.wrench.any()
    if weighs or loaded or effect.where not in GravityCompensator.places(robot)[:1]:
        return None
    return f"joint_springs:{effect.where}"


def _torque(effect: Effect, final: Calibration) -> float | None:
    """Torque that makes the waves of an effect with the spring of its joint [N·m].

    None where no spring is known, or no joint is that a balancer lifts.
    """
    if effect.where not in GravityCompensator.places(final.model.robot):
        return None
    springs = dict(zip(final.model.robot.actuated, final.model.joint_stiffness(), strict=True))
    stiffness = float(springs.get(effect.where, np.inf))
    return stiffness * _wave(effect, final)[0] if np.isfinite(stiffness) else None


def _wave(effect: Effect, final: Calibration) -> tuple[float, float]:
    """Amplitude once per turn and its standard error [rad]."""
    own = {p.spec.name: p for p in final.model.parameters if p.effect == effect}
    parts = [own[name] for name in ("sin_1", "cos_1") if name in own]
    error = max((part.internal_std or 0.0 for part in parts), default=0.0)
    return float(np.linalg.norm([part.internal for part in parts])), error
