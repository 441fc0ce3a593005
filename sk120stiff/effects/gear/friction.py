"""A gear that rubs: its twist depends on where its torque came from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import (
    Elongation,
    Switching,
    scale_of,
)
from sk120stiff.effects.gear.law import GearEffect, constant_in_torque, torques_told
from sk120stiff.effects.gear.lost_motion import LostMotion
from sk120stiff.effects.load_cases import IDLE, LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot

REACHES = (0.02, 0.06, 0.15, 0.4)  # of the largest torque: after which a gear may start to slip
HALF, REACH = "half_width", "half_width_presliding_"


@dataclass(frozen=True)
class FrictionHysteresis(GearEffect, Switching):
    """e = ∓h sign(τ): friction holds the joint back while the load grows, and up while it falls.

    Real gears pre-slide: after every reversal of the torque they first stick. Then
    e = −Σ h_k p_k / r_k, with p_k what the torque has changed by since, held within ±r_k (the stop
    operator of Prandtl and Ishlinskii; a sum of them is any Maxwell-slip gear, its loops follow
    Masing's rule)::

        p_k(t) = min(max(p_k(t − 1) + τ(t) − τ(t − 1), −r_k), r_k),   p_k(0) = 0

    Attributes:
        reaches: Torques r_k [N·m] after which it slips; 0: at once, on the branch that the readings
            tell.
    """

    reaches: tuple[float, ...] = (0.0,)
    name: ClassVar[str] = "friction_hysteresis"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K - h * sign(torque) while loading, + h * sign(torque) while unloading;"
        " with presliding r: - h * p / r, p the change of torque since the last reversal within +-r"
    )
    says: ClassVar[str] = "Friction in {where} makes loading and unloading differ."
    axes: ClassVar[str] = "the axis of the joint itself"
    also: ClassVar[str] = (
        f"{REACH}20: after a reversal it sticks until the torque has changed by r = 20 N*m; "
        "several add up"
    )
    twins: ClassVar[tuple[str, ...]] = (LostMotion.name,)  # while loads only grow

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The friction of one joint, pre-sliding where names of parameters tell."""
        told = tuple(sorted(torques_told(options.shape, REACH, "torque of slipping")))
        jump = HALF in options.shape or not told
        return cls(where, scale_of(robot), (*([0.0] if jump else []), *told))

    @classmethod
    def options_of(cls, parameters: Mapping[str, str]) -> Options:
        """The pre-sliding that the names of the parameters tell."""
        return Options(shape=tuple(parameters))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width h of the loop, or of each part that slips after another torque."""
        return tuple(
            ParameterSpec(
                f"{REACH}{r:g}" if r else HALF,
                "rad",
                "rad",
                plausible=5e-4,
                typical=5e-5,
                lower=0.0,
                meaning="h, half the width of the loop"
                + (f" of the part that slips after {r:g} N*m" if r else ""),
            )
            for r in self.reaches
        )

    def other_laws(self, load_cases: LoadCases) -> tuple[FrictionHysteresis, ...]:
        """Pre-sliding over each of `REACHES` of the largest torque, and over all of them.

        Where no load is taken off step by step, nothing tells one from another.
        """
        largest = float(np.abs(self.load_torque(load_cases)).max(initial=0.0))
        if largest <= 0.0 or not (load_cases.branch < 0.0).any():
            return ()
        reaches = tuple(float(f"{share * largest:.3g}") for share in REACHES)
        single = [replace(self, reaches=(r,)) for r in reaches]
        laws = (*single, replace(self, reaches=reaches), replace(self, reaches=(0.0,)))
        return tuple(law for law in laws if law != self)

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        shapes = [
            -held_back(torques[:, 0], r, load_cases) / r
            if r
            else -load_cases.branch * np.sign(torques[:, 0])
            for r in self.reaches
        ]
        return constant_in_torque(np.stack(shapes, axis=-1), values)


def held_back(torque: Array, reach: float, load_cases: LoadCases) -> Array:
    """(N,) what friction holds back at every reading beyond its zero reading [N·m].

    Every pose begins without load and without memory; its loads follow one another in the order of
    the readings, with none in between where a zero was read or a repeat begins. Before a series
    that begins with a load that falls, more was on.

    Args:
        torque: (N,) torque of the load [N·m].
        reach: Torque after which it slips [N·m].
        load_cases: The readings, in whose order the torques came.
    """
    steps, zero, own = load_cases.history
    before = np.zeros(steps.shape[1])
    held = np.zeros(steps.shape[1])
    idle = np.ones(steps.shape[1], dtype=bool)
    falls = load_cases.branch < 0.0
    seen = np.zeros(steps.shape)
    for k, rows in enumerate(steps):
        now = np.where(rows == IDLE, 0.0, torque[rows])
        fresh = idle & (rows != IDLE) & falls[rows]
        held = np.where(fresh, -reach * np.sign(now), np.clip(held + now - before, -reach, reach))
        seen[k], before, idle = held, now, rows == IDLE
    pose = load_cases.pose_column
    return np.asarray(seen[own, pose] - seen[zero, pose])
