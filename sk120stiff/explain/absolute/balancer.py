"""Waves of a joint that are too large for its gear: a balancer, or other masses, make them too.

A spring that lifts an arm, or a mass that no URDF states, puts a torque on the joint that goes with
the sine of its angle once per turn. Where nothing else tells that torque, the joint's own spring
turns it into a wave that no pose tells from a gear which is not round.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.effects.gravity_compensator import GravityCompensator
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.errors import two_digits
from sk120stiff.identify.absolute.calibrate import Calibration

NO_GEAR = 1e-3  # rad once per turn: ten times what gears of robots are off (an arc minute is 3e-4)


def balancer_for(effect: Effect, final: Calibration) -> str | None:
    """The balancer at a joint whose waves are none of a gear; None where they may be."""
    told = _torque(effect, final) is not None
    return f"{GravityCompensator.name}:{effect.where}" if told else None


def balancing(final: Calibration) -> tuple[str, ...]:
    """What such waves may be instead, in sentences."""
    said = []
    for effect in final.model.effects:
        torque = _torque(effect, final)
        if torque is not None:
            wave = two_digits(1e3 * _wave(effect, final))
            said.append(
                f"Once per turn {effect.where} stands off by {wave} mrad, far more than gears do: "
                "a balancer (a spring, a gas strut) or masses of the arm that the URDF does not "
                f"state, with {two_digits(torque)} N·m at most, stand it off alike, and no pose "
                "tells which."
            )
    return tuple(said)


def _torque(effect: Effect, final: Calibration) -> float | None:
    """Torque that makes the waves of an effect with the spring of its joint [N·m].

    None where they are no larger than a gear's, or where no joint is that a balancer lifts.
    """
    if not isinstance(effect, TransmissionError) or _wave(effect, final) < NO_GEAR:
        return None
    if effect.where not in GravityCompensator.places(final.model.robot):
        return None
    springs = dict(zip(final.model.robot.actuated, final.model.joint_stiffness(), strict=True))
    stiffness = float(springs.get(effect.where, np.inf))
    return stiffness * _wave(effect, final) if np.isfinite(stiffness) else None


def _wave(effect: Effect, final: Calibration) -> float:
    """Amplitude once per turn [rad]."""
    own = {p.spec.name: p.internal for p in final.model.parameters if p.effect == effect}
    return float(np.hypot(own.get("sin_1", 0.0), own.get("cos_1", 0.0)))
