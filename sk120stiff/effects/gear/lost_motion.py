"""A gear with play: between its flanks it turns without resisting."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import scale_of
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.gear.law import GearEffect, constant_in_torque, torques_told
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.switching import Switching
from sk120stiff.robot import Robot

FLANKS = (0.02, 0.06, 0.15)  # of the largest torque: over which teeth may take hold
# Gear makers read lost motion off at 3 % of the rated torque. What gives way over much more of it
# is seldom play: most call it the gear's first stiffness (`hardening.py`).
WIDE, SELDOM = 0.1, 0.1
HALF, FLANK = "half_width", "_flank_"
SIDES = {"": 0, "_positive": 1, "_negative": -1}  # end of a name → sign of the torque


@dataclass(frozen=True)
class LostMotion(GearEffect, Switching):
    """e = Σ b_k [s_k(τ + τ_g) − s_k(τ_g)], τ_g the weight's torque; positions: Σ b_k s_k(τ + τ_g).

    Without flanks s is the sign: the play is crossed when the total torque turns round. Teeth take
    hold gradually, over a flank T of a few percent of the rated torque: s = tanh(τ/T). Where the
    two sides differ, each has a half width of its own.

    Attributes:
        flanks: Torques T [N·m] over which the flanks close; 0: at once.
        sided: The two sides of the play differ.
        wide: A flank is beyond `WIDE` of the largest torque that was measured.
    """

    flanks: tuple[float, ...] = (0.0,)
    sided: bool = False
    wide: bool = field(default=False, compare=False)
    name: ClassVar[str] = "lost_motion"
    of_transmission: ClassVar[bool] = True
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K + b * (s(torque) - s(torque of the weight)), s the sign, or tanh "
        "where flanks close gradually"
    )
    says: ClassVar[str] = (
        "The gear of {where} has lost motion: it gives way when its torque turns round."
    )
    axes: ClassVar[str] = "the axis of the joint itself; torque includes the arm's weight"
    also: ClassVar[str] = (
        f"{HALF}{FLANK}20 with s = tanh(torque / 20 N*m); {HALF}_positive and {HALF}_negative, "
        f"each for torques of that sign, and {HALF}_positive{FLANK}20; several add up"
    )
    twins: ClassVar[tuple[str, ...]] = ("friction_hysteresis",)  # while loads only grow

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The play of one joint, with the flanks that names of parameters tell."""
        heads = [f"{HALF}{side}" for side in SIDES]
        told = {T for head in heads for T in torques_told(options.shape, f"{head}{FLANK}", "flank")}
        plain = set(heads) & set(options.shape)
        sided = any(name.startswith(tuple(heads[1:])) for name in options.shape)
        flanks = (*([0.0] if plain or not told else []), *sorted(told))
        return cls(where, scale_of(robot), flanks, sided)

    @property
    def _terms(self) -> tuple[tuple[str, float], ...]:
        """Side and flank of every parameter."""
        sides = list(SIDES)[1:] if self.sided else [""]
        return tuple((side, T) for T in self.flanks for side in sides)

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width b of the play, for each side and each flank that it has."""
        words = {"": "", "_positive": " under positive torque", "_negative": " under negative one"}
        return tuple(
            ParameterSpec(
                f"{HALF}{side}" + (f"{FLANK}{T:g}" if T else ""),
                "rad",
                "rad",
                plausible=1e-3,
                typical=1e-4,
                lower=0.0,
                meaning=f"b{words[side]}, half the play: "
                + (
                    f"the joint gives way by 2 b over a flank of {T:g} N*m as its torque turns "
                    "round"
                    if T
                    else "the joint jumps by 2 b when its torque turns round"
                ),
            )
            for side, T in self._terms
        )

    def other_laws(self, load_cases: LoadCases) -> tuple[LostMotion, ...]:
        """Flanks of `FLANKS` of the largest torque, sides that differ, and all of these together.

        Together they come near any curve that flattens, as one law with non-negative parts.
        """
        largest = self.largest_torque(load_cases)
        if largest <= 0.0:
            return ()
        flanks = {share: float(f"{share * largest:.3g}") for share in FLANKS}
        narrow = tuple(T for share, T in flanks.items() if share <= WIDE)
        every = tuple(flanks.values())
        laws = [
            replace(self, flanks=shape, sided=sided, wide=not {*shape} <= {0.0, *narrow})
            for shape in (*((T,) for T in (0.0, *every)), (0.0, *narrow), (0.0, *every))
            for sided in (False, True)
        ]
        return tuple(law for law in laws if law != self)

    @property
    def law_prior(self) -> float:
        """Wide flanks are seldom those of play."""
        return SELDOM if self.wide else 1.0

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`. A position has no zero reading to be subtracted."""
        weight = self.weight_torque(load_cases)
        shapes = self._shapes(torques + weight)
        if not load_cases.absolute:
            shapes = shapes - self._shapes(weight)
        return constant_in_torque(shapes, values)

    def by_onset(
        self, onset: Array, change: Array, load_cases: LoadCases, values: Array
    ) -> Array | None:
        """See `Switching.by_onset`: flanks have a slope, jumps have none."""
        if not any(self.flanks):
            return None
        torque = (onset + self.weight_torque(load_cases))[:, 0]
        slope = np.zeros(len(torque))
        for value, (side, T) in zip(values, self._terms, strict=True):
            if T:
                here = SIDES[side] * torque > 0.0 if side else np.ones(len(torque), dtype=bool)
                slope += np.where(here, value / T * (1.0 - np.tanh(torque / T) ** 2), 0.0)
        return np.asarray(slope[:, None, None] * change)

    def _shapes(self, torque: Array) -> Array:
        """(N, p) twist per unit of each parameter at torques (N, 1)."""
        out = []
        for side, T in self._terms:
            s = np.tanh(torque[:, 0] / T) if T else np.sign(torque[:, 0])
            way = SIDES[side]
            out.append(way * np.maximum(way * s, 0.0) if way else s)
        return np.stack(out, axis=-1)
