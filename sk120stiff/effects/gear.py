"""What gears do beyond a linear spring: they harden, they have lost motion, they rub."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import (
    LOADS_GROW,
    Alias,
    Elastic,
    Elongation,
    Options,
    Switching,
    scale_of,
)
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.situation import Situation
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot

STEPS = (0.1, 0.2, 0.4, 0.7)  # of the largest torque: where the gear may change its stiffness
BELOW = "extra_below_"  # extra_below_150: softer by the value of this parameter below 150 N·m


@dataclass(frozen=True)
class GearEffect(Elastic):
    """A law of the total torque of one turning actuated joint, its weight's share included."""

    of_gear: ClassVar[bool] = True

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
        torque = situation.gravity_torque[:, index : index + 1]
        # About a vertical axis only rounding is left, and its sign must not count.
        return np.where(np.abs(torque) > 1e-9 * situation.robot.total_mass, torque, 0.0)


@dataclass(frozen=True)
class GearHardening(GearEffect):
    """The gear yields less than in proportion: e(τ + τ_g) − e(τ_g), τ_g the weight's torque.

    As a series, whatever the torque range::

        e = −κ₂ τ|τ| − κ₃ τ³

    The two terms together come within a fifth of any stiffness that rises in steps. The other usual
    law is piecewise linear: the gear is softer by c_k as long as |τ| < T_k::

        e = Σ c_k min(max(τ, −T_k), T_k)

    The torques T_k of the steps come from a data sheet; where a search has none, it tries steps
    over the torques that were measured.
    """

    breaks: tuple[float, ...] = ()
    name: ClassVar[str] = "gear_hardening"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "q - q_0 = torque / K - k2 * torque * abs(torque) - k3 * torque^3"
    axes: ClassVar[str] = "the axis of the joint itself; torque includes the arm's weight"
    bends_a_spring: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The gear of one joint, with the steps of its data sheet where they are known."""
        return cls(where, scale_of(robot), breaks=options.breaks)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The steps that the names of the parameters tell."""
        return Options(breaks=_breaks_of(parameters))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Coefficients κ₂ and κ₃, or the extra compliance c_k below each break torque."""
        size = self.scale**-3  # torques grow with the cube of an arm's length, compliances fall
        if self.breaks:
            unit = "rad/(N*m)"
            return tuple(
                ParameterSpec(
                    f"{BELOW}{torque:g}", unit, unit, plausible=1e-4 * size, typical=5e-7 * size,
                    lower=0.0, meaning=f"extra compliance while the torque is below {torque:g} N*m",
                )
                for torque in self.breaks
            )  # fmt: skip
        square, cube = "rad/(N*m)**2", "rad/(N*m)**3"
        return (
            ParameterSpec(
                "quadratic", square, square, plausible=1e-8 * size**2, typical=3e-10 * size**2,
                lower=0.0, meaning="k2; positive: stiffer as the torque grows",
            ),
            ParameterSpec(
                "cubic", cube, cube, plausible=1e-11 * size**3, typical=3e-13 * size**3,
                meaning="k3; positive: stiffer as the torque grows",
            ),
        )  # fmt: skip

    def other_laws(self, situation: Situation) -> tuple[GearHardening, ...]:
        """The series, or steps at `STEPS` of the largest torque among the readings."""
        if self.breaks:
            return (replace(self, breaks=()),)
        index = situation.robot.actuated.index(self.where)
        load = situation.nominal.at(situation.force_point).torques(situation.wrench)
        largest = float(np.abs(load + situation.gravity_torque)[:, index].max(initial=0.0))
        if largest <= 0.0:
            return ()
        return (replace(self, breaks=tuple(float(f"{share * largest:.3g}") for share in STEPS)),)

    def sentence(self) -> str:
        """What happens."""
        return f"The gear of {self.where} gets stiffer as its torque grows."

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        weight = self.weight_torque(situation)
        total = torques + weight
        by_parameter = self._shapes(total) - self._shapes(weight)
        return Elongation(
            value=by_parameter @ values,
            by_torque=(self._slopes(total) @ values)[..., None],
            by_parameter=by_parameter,
        )

    def _shapes(self, torque: Array) -> Array:
        """(N, 1, P) elongation per unit of each parameter at torques (N, 1)."""
        if self.breaks:
            return np.stack([np.clip(torque, -T, T) for T in self.breaks], axis=-1)
        return np.stack([-torque * np.abs(torque), -(torque**3)], axis=-1)

    def _slopes(self, torque: Array) -> Array:
        """(N, 1, P) derivative of `_shapes` by the torque."""
        if self.breaks:
            return np.stack([1.0 * (np.abs(torque) < T) for T in self.breaks], axis=-1)
        return np.stack([-2.0 * np.abs(torque), -3.0 * torque**2], axis=-1)


@dataclass(frozen=True)
class LostMotion(GearEffect, Switching):
    """e = b [sign(τ + τ_g) − sign(τ_g)]: the play is crossed when the total torque turns round."""

    name: ClassVar[str] = "lost_motion"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K + b * (sign(torque) - sign(torque of the weight))"
    )
    axes: ClassVar[str] = "the axis of the joint itself; torque includes the arm's weight"
    twins: ClassVar[tuple[str, ...]] = ("friction_hysteresis",)  # while loads only grow

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width b of the play."""
        return (
            ParameterSpec(
                "half_width",
                "rad",
                "rad",
                plausible=1e-3,
                typical=1e-4,
                lower=0.0,
                meaning="b, half the play: the joint jumps by 2 b when its torque turns round",
            ),
        )

    def sentence(self) -> str:
        """What happens."""
        return f"The gear of {self.where} has lost motion: it jumps when its torque turns round."

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        weight = self.weight_torque(situation)
        return _step(np.sign(torques + weight) - np.sign(weight), values)


@dataclass(frozen=True)
class FrictionHysteresis(GearEffect, Switching):
    """e = ∓h sign(τ): friction holds the joint back while the load grows, and up while it falls."""

    name: ClassVar[str] = "friction_hysteresis"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K - h * sign(torque) while loading, + h * sign(torque) while unloading"
    )
    axes: ClassVar[str] = "the axis of the joint itself"
    twins: ClassVar[tuple[str, ...]] = (LostMotion.name,)  # while loads only grow

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width h of the loop."""
        return (
            ParameterSpec(
                "half_width",
                "rad",
                "rad",
                plausible=5e-4,
                typical=5e-5,
                lower=0.0,
                meaning="h, half the width of the loop",
            ),
        )

    def sentence(self) -> str:
        """What happens."""
        return f"Friction in {self.where} makes loading and unloading differ."

    def aliases(self, robot: Robot) -> tuple[Alias, ...]:
        """Of an arm without weight: lost motion with the other sign, until a load is taken off.

        What the weight presses against a gear's flank never crosses the play at small loads.
        """
        if robot.total_mass > 0.0:
            return ()
        own = f"{self.id}.half_width"
        return (Alias(own, own.replace(self.name, LostMotion.name), LOADS_GROW),)

    def elongation(self, torques: Array, situation: Situation, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        return _step(-situation.branch[:, None] * np.sign(torques), values)


def _breaks_of(names: Iterable[str]) -> tuple[float, ...]:
    """Break torques [N·m] that the names of parameters tell.

    Raises
    ------
    InputError
        A name begins as theirs but ends in no positive number.
    """
    found = []
    for name in names:
        if not name.startswith(BELOW):
            continue
        try:
            torque = float(name.removeprefix(BELOW))
        except ValueError:
            torque = np.nan
        if not (np.isfinite(torque) and torque > 0.0 and f"{BELOW}{torque:g}" == name):
            raise InputError(
                f"the parameter {name!r} names no break torque",
                remedy=f"Write {BELOW}150 for a gear that is softer below 150 N·m.",
            )
        found.append(torque)
    return tuple(found)


def _step(shape: Array, values: Array) -> Elongation:
    return Elongation(
        value=values[0] * shape,
        by_torque=np.zeros((*shape.shape, 1)),
        by_parameter=shape[..., None],
    )
