"""What gears do beyond a linear spring: they harden, they have lost motion, they rub."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.base import Elastic, Elongation, ParameterSpec
from sk120stiff.effects.situation import Situation
from sk120stiff.robot import Robot
from sk120stiff.robot.coupling import Array


@dataclass(frozen=True)
class GearEffect(Elastic):
    """A law of the total torque of one turning actuated joint, its weight's share included."""

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every actuated joint that turns."""
        slides = dict(zip(robot.actuated, robot.prismatic, strict=True))
        return tuple(name for name in robot.actuated if not slides[name])

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        """The actuated joint itself."""
        return (self.where,)

    def weight_torque(self, situation: Situation) -> Array:
        """(N, 1) torque of the arm's weight on the joint, before the load came [N·m]."""
        index = situation.robot.actuated.index(self.where)
        return situation.gravity_torque[:, index : index + 1]


@dataclass(frozen=True)
class GearHardening(GearEffect):
    """e = −κ [(τ + τ_g)³ − τ_g³]: the gear yields less than in proportion."""

    name: ClassVar[str] = "gear_hardening"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Cubic coefficient κ."""
        unit = "rad/(N*m)**3"
        return (ParameterSpec("cubic", unit, unit, plausible=1e-11, typical=3e-13, lower=0.0),)

    def sentence(self) -> str:
        """What happens."""
        return f"The gear of {self.where} gets stiffer as its torque grows."

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        weight = self.weight_torque(situation)
        total = torques + weight
        shape = -(total**3 - weight**3)
        return Elongation(
            value=values[0] * shape,
            by_torque=(-3.0 * values[0] * total**2)[..., None],
            by_parameter=shape[..., None],
        )


@dataclass(frozen=True)
class LostMotion(GearEffect):
    """e = b [sign(τ + τ_g) − sign(τ_g)]: the play is crossed when the total torque turns round."""

    name: ClassVar[str] = "lost_motion"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width b of the play."""
        return (ParameterSpec("half_width", "rad", "rad", plausible=1e-3, typical=1e-4, lower=0.0),)

    def sentence(self) -> str:
        """What happens."""
        return f"The gear of {self.where} has lost motion: it jumps when its torque turns round."

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        weight = self.weight_torque(situation)
        return _step(np.sign(torques + weight) - np.sign(weight), values)

    def aliases(self, robot: Robot) -> tuple[str, ...]:
        """None: with falling loads in the data friction looks different (see `Friction`)."""
        return ()


@dataclass(frozen=True)
class FrictionHysteresis(GearEffect):
    """e = ∓h sign(τ): friction holds the joint back while the load grows, and up while it falls."""

    name: ClassVar[str] = "friction_hysteresis"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width h of the loop."""
        return (ParameterSpec("half_width", "rad", "rad", plausible=5e-4, typical=5e-5, lower=0.0),)

    def sentence(self) -> str:
        """What happens."""
        return f"Friction in {self.where} makes loading and unloading differ."

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        return _step(-situation.branch[:, None] * np.sign(torques), values)


def _step(shape: Array, values: Array) -> Elongation:
    return Elongation(
        value=values[0] * shape,
        by_torque=np.zeros((*shape.shape, 1)),
        by_parameter=shape[..., None],
    )
