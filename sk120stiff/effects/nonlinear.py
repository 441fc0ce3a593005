"""Parts that yield, but not in proportion: bearings stiffen as more of their rollers carry, rubber
stiffens as it is pressed, anchors give way more and more, or one way only.

A straight law has one compliance for each axis. Here the compliance goes in a straight line from
c₀ without load to c₁ under the largest load T that was measured, and stays there beyond::

    e = c₀ τ (1 − |τ| / 2T) + c₁ τ |τ| / 2T   for |τ| ≤ T

Contact stiffens with a root of its load (Hertz: balls with the cube root), of which this is the
best straight line. Where T is not told there is one compliance for either sign of the load::

    e = c₊ max(τ, 0) + c₋ min(τ, 0)

In both e rises with τ wherever no compliance is negative.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import (
    AxisByAxis,
    Effect,
    Elastic,
    scale_of,
)
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot, VirtualJoint

AT = "_at_"  # stiffness_x_at_0 and stiffness_x_at_3000: without load, and from 3000 N·m on
POSITIVE, NEGATIVE = "_positive", "_negative"
ALSO = (
    "out of proportion, with two of each stiffness: ..._at_0 without load and ..._at_150 for "
    "further load from 150 N*m (or N) on, the compliance on a straight line in between; or "
    "..._positive and ..._negative, each under load of that sign"
)


class StraightPart(AxisByAxis):
    """The straight law of a part that may yield out of proportion too.

    Attributes:
        nonlinear: The laws out of proportion (class attribute); they make themselves known.
    """

    also: ClassVar[str] = ALSO
    nonlinear: ClassVar[type[Nonlinear]]

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The part, out of proportion where names of parameters tell so."""
        scale = scale_of(robot)
        return cls.nonlinear.told_by(options.shape, where, scale) or cls(where, scale)

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """Out of proportion, over the loads of some readings."""
        virtual = self.virtual_joints(load_cases.robot)
        loads = np.abs(load_cases.torques_on(virtual)).max(axis=0, initial=0.0)
        turns = np.array([joint.revolute for joint in virtual])
        full = np.array([loads[turns == kind].max(initial=0.0) for kind in turns])
        if not full.any():
            return ()
        full[full == 0.0] = full.max()  # nothing turns it, or nothing shifts it: any load will do
        measured = tuple(float(f"{T:.3g}") for T in full)
        law = self.nonlinear
        return law(self.where, self.scale, measured), law(self.where, self.scale)


@dataclass(frozen=True)
class Nonlinear(Elastic):
    """A part whose compliance goes with its load, the weight's share included.

    Attributes:
        straight: The law that is in proportion, one compliance for every coordinate (class
            attribute); name, place and axes are those of it.
        full: Load T [N·m or N] of every coordinate, up to which the compliance changes; empty: it
            goes with the sign alone.
    """

    full: tuple[float, ...] = ()
    also: ClassVar[str] = ALSO
    straight: ClassVar[type[StraightPart]]

    def __init_subclass__(cls) -> None:
        """Make the law known to the straight one."""
        super().__init_subclass__()
        straight = cls.straight
        cls.name, cls.place, cls.axes = straight.name, straight.place, straight.axes
        cls.equation = f"{straight.equation}, K going with the load"
        straight.nonlinear = cls

    @property
    def law_prior(self) -> float:
        """Most bearings and bolted joints hardly depart from straight."""
        return 0.2

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The law that the options tell, this one or the straight one."""
        return cls.straight.at(robot, where, options)

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The law that the names of the parameters tell."""
        return cls.straight.options_of(parameters)

    @property
    def _part(self) -> StraightPart:
        return self.straight(self.where, self.scale)

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Two of each that the straight law has: all of the first kind, then the second kind."""
        straight = self._part.parameters
        if not self.full:
            return (
                *(_named(spec, POSITIVE, "under positive load") for spec in straight),
                *(_named(spec, NEGATIVE, "under negative load") for spec in straight),
            )
        return (
            *(_named(spec, f"{AT}0", "without load") for spec in straight),
            *(
                _named(spec, f"{AT}{T:g}", f"for further load from {T:g} {_load_unit(spec)} on")
                for spec, T in zip(straight, self.full, strict=True)
            ),
        )

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Those of the straight law."""
        return self._part.virtual_joints(robot)

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """The straight law, and all others that it leads to."""
        laws = (self._part, *self._part.other_laws(load_cases))
        return tuple(law for law in laws if law != self)

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`. A position has no zero reading to be subtracted."""
        weight = load_cases.weight_torques(self._part.virtual_joints(load_cases.robot))
        by_parameter = self._shapes(torques + weight)
        if not load_cases.absolute:
            by_parameter = by_parameter - self._shapes(weight)
        slopes = self._slopes(torques + weight) @ values
        return Elongation(
            value=by_parameter @ values,
            by_torque=slopes[..., None] * np.eye(slopes.shape[-1]),
            by_parameter=by_parameter,
        )

    def _shapes(self, torque: Array) -> Array:
        """(N, k, 2k) elongation per unit of each parameter at torques (N, k)."""
        if not self.full:
            return _axis_by_axis(np.maximum(torque, 0.0), np.minimum(torque, 0.0))
        T = np.array(self.full)
        inside = np.clip(torque, -T, T)
        later = inside * np.abs(inside) / (2.0 * T)
        return _axis_by_axis(inside - later, later + torque - inside)

    def _slopes(self, torque: Array) -> Array:
        """(N, k, 2k) derivative of `_shapes` by the torque."""
        if not self.full:
            positive = 0.5 * (1.0 + np.sign(torque))
            return _axis_by_axis(positive, 1.0 - positive)
        share = np.minimum(np.abs(torque) / np.array(self.full), 1.0)
        return _axis_by_axis(1.0 - share, share)

    @classmethod
    def told_by(cls, names: Collection[str], where: str, scale: float) -> Nonlinear | None:
        """The law that names of parameters tell; None where they tell none of this kind.

        Raises:
            InputError: A name ends in no positive load, the loads of some are missing, or the names
                are those of two laws.
        """
        straight = cls.straight(where, scale).parameters
        by_sign = [name for name in names if name.endswith((POSITIVE, NEGATIVE))]
        by_load = [name for name in names if AT in name]
        if by_sign and by_load:
            raise InputError(
                f"{by_sign[0]} and {by_load[0]} belong to two laws",
                remedy="Give all parameters as ..._positive and ..._negative, or all as ..._at_0 "
                "and ..._at_150.",
            )
        if by_sign:
            return cls(where, scale)
        if not by_load:
            return None
        return cls(where, scale, tuple(_told(spec, names) for spec in straight))


def _named(spec: ParameterSpec, end: str, words: str) -> ParameterSpec:
    return replace(spec, name=spec.name + end, meaning=f"{spec.meaning}, {words}")


def _told(spec: ParameterSpec, names: Collection[str]) -> float:
    """The load up to which the compliance of one coordinate changes."""
    head = f"{spec.name}{AT}"
    loads = {name.removeprefix(head) for name in names if name.startswith(head)} - {"0"}
    if len(loads) == 1 and _is_load(load := loads.pop()):
        return float(load)
    raise InputError(
        f"the names of the parameters do not tell up to which load {spec.name} changes",
        remedy=f"Write {head}0 and {head}150 for 150 {_load_unit(spec)}, {head}1e+06 for 1000000.",
    )


def _load_unit(spec: ParameterSpec) -> str:
    return "N*m" if spec.unit == "N*m/rad" else "N"


def _is_load(text: str) -> bool:
    try:
        load = float(text)
    except ValueError:
        return False
    return bool(np.isfinite(load) and load > 0.0 and f"{load:g}" == text)


def _axis_by_axis(first: Array, second: Array) -> Array:
    """(N, k, 2k) two shapes (N, k) of every coordinate, all of the first before the second."""
    eye = np.eye(first.shape[-1])
    return np.concatenate([first[..., None] * eye, second[..., None] * eye], axis=-1)
