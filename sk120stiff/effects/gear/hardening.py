"""A gear that gets stiffer as its torque grows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import scale_of
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.gear.law import GearEffect, torques_told
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot

# of the largest torque: where the gear may change its stiffness
STEPS = (0.06, 0.12, 0.2, 0.3, 0.45, 0.7)
FIRST = 1  # of them that may be the only one: what gives way at once about no torque is play
BELOW = "extra_below_"  # extra_below_150: softer by the value of this parameter below 150 N·m
SIDED = "extra_negative"  # softer by the value of this parameter under negative torque


@dataclass(frozen=True)
class GearHardening(GearEffect):
    """The gear yields less than in proportion: e(τ + τ_g) − e(τ_g), τ_g the weight's torque.

    As a series, whatever the torque range::

        e = −κ₂ τ|τ| − κ₃ τ³

    The two terms together come within a fifth of any stiffness that rises in steps. The other usual
    law is piecewise linear: the gear is softer by c_k as long as |τ| < T_k::

        e = Σ c_k min(max(τ, −T_k), T_k)

    The torques T_k of the steps come from a data sheet; where a search has none, it tries steps
    over the torques that were measured. And a gear may be softer one way than the other, by c::

        e = c min(τ, 0)
    """

    breaks: tuple[float, ...] = ()
    sided: bool = False
    name: ClassVar[str] = "gear_hardening"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K - k2 * torque * abs(torque) - k3 * torque^3; by direction: torque / K"
        " + c * min(torque, 0)"
    )
    says: ClassVar[str] = (
        "The gear of {where} is not as stiff under much torque as under little: it hardens or "
        "softens."
    )
    axes: ClassVar[str] = "the axis of the joint itself; torque includes the arm's weight"
    also: ClassVar[str] = (
        f"in steps, as data sheets have it: {BELOW}150 in rad/(N*m) is by how much more the gear "
        "yields while the torque is below 150 N*m; several steps add up. By direction: "
        f"{SIDED} in rad/(N*m) is by how much more it yields under negative torque"
    )
    bends_a_spring: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The gear of one joint, with the steps of its data sheet where they are known."""
        return cls(where, scale_of(robot), breaks=options.breaks, sided=SIDED in options.shape)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The steps that the names of the parameters tell, or the sides."""
        breaks = torques_told(parameters, BELOW, "break torque")
        return Options(breaks=breaks, shape=tuple(parameters))

    def sentence(self) -> str:
        """See `Effect.sentence`."""
        if self.sided:
            return f"The gear of {self.where} is stiffer under torque of one sign than the other."
        return super().sentence()

    def told(self, values: Mapping[str, float]) -> str:
        """See `Effect.told`: of one sign, the terms say which way its stiffness goes."""
        if self.sided or not any(values.values()):
            return self.sentence()
        if min(values.values()) >= 0.0:
            return f"The gear of {self.where} hardens: it gets stiffer as its torque grows."
        if max(values.values()) <= 0.0:
            return f"The gear of {self.where} softens: it yields the more the larger its torque is."
        return self.sentence()

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Coefficients κ₂ and κ₃, or the extra compliance c_k below each break torque."""
        size = self.scale**-3  # torques grow with the cube of an arm's length, compliances fall
        unit = "rad/(N*m)"
        if self.sided:
            return (
                ParameterSpec(
                    SIDED, unit, unit, plausible=1e-4 * size, typical=5e-7 * size,
                    meaning="extra compliance under negative torque; below zero it is stiffer then",
                ),
            )  # fmt: skip
        if self.breaks:
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
                lower=0.0, meaning="k2; alone it makes the gear stiffer as the torque grows",
            ),
            ParameterSpec(
                "cubic", cube, cube, plausible=1e-11 * size**3, typical=3e-13 * size**3,
                meaning="k3; with k2 it makes the curve, and may have either sign",
            ),
        )  # fmt: skip

    def other_laws(self, load_cases: LoadCases) -> tuple[GearHardening, ...]:
        """The series, steps (one, two as in most data sheets, one at each of `STEPS`), sides."""
        largest = self.largest_torque(load_cases)
        steps = tuple(float(f"{share * largest:.3g}") for share in STEPS) if largest > 0.0 else ()
        laws = [(), *((T,) for T in steps[FIRST:]), *combinations(steps, 2), steps]
        every = [replace(self, breaks=own, sided=False) for own in laws]
        every.append(replace(self, breaks=(), sided=True))
        return tuple(law for law in dict.fromkeys(every) if law != self)  # without torque no steps

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`. A position has no zero reading to be subtracted."""
        weight = self.weight_torque(load_cases)
        total = torques + weight
        by_parameter = self._shapes(total)
        if not load_cases.absolute:
            by_parameter = by_parameter - self._shapes(weight)
        return Elongation(
            value=by_parameter @ values,
            by_torque=(self._slopes(total) @ values)[..., None],
            by_parameter=by_parameter,
        )

    def _shapes(self, torque: Array) -> Array:
        """(N, 1, P) elongation per unit of each parameter at torques (N, 1)."""
        if self.sided:
            return np.minimum(torque, 0.0)[..., None]
        if self.breaks:
            return np.stack([np.clip(torque, -T, T) for T in self.breaks], axis=-1)
        return np.stack([-torque * np.abs(torque), -(torque**3)], axis=-1)

    def _slopes(self, torque: Array) -> Array:
        """(N, 1, P) derivative of `_shapes` by the torque."""
        if self.sided:
            return np.asarray(np.heaviside(-torque, 0.5))[..., None]
        if self.breaks:
            return np.stack([1.0 * (np.abs(torque) < T) for T in self.breaks], axis=-1)
        return np.stack([-2.0 * np.abs(torque), -3.0 * torque**2], axis=-1)
