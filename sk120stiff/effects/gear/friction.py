"""A gear that rubs: its twist depends on where its torque came from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects.base import (
    scale_of,
)
from sk120stiff.effects.elongation import Elongation
from sk120stiff.effects.gear.law import GearEffect, constant_in_torque, torques_told
from sk120stiff.effects.gear.lost_motion import LostMotion
from sk120stiff.effects.load_cases import IDLE, LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.effects.switching import Switching
from sk120stiff.robot import Robot

REACHES = (0.02, 0.06, 0.15, 0.4)  # of the largest torque: after which a gear may start to slip
HALF = "half_width"
Start = Literal["rest", "cycled", "weighed"]
REACH: dict[Start, str] = {
    "rest": f"{HALF}_presliding_",
    "cycled": f"{HALF}_cycled_",
    "weighed": f"{HALF}_weighed_",
}
BEFORE: dict[Start, str] = {
    "rest": "",
    "cycled": ", the load having gone up and down before",
    "weighed": ", the arm's weight having come before",
}


@dataclass(frozen=True)
class FrictionHysteresis(GearEffect, Switching):
    """e = ∓h sign(τ): friction holds the joint back while the load grows, and up while it falls.

    Real gears pre-slide: after every reversal of the torque they first stick. Then
    e = −Σ h_k p_k / r_k, with p_k what the torque has changed by since, held within ±r_k (the stop
    operator of Prandtl and Ishlinskii; a sum of them is any Maxwell-slip gear, its loops follow
    Masing's rule)::

        p_k(t) = min(max(p_k(t − 1) + τ(t) − τ(t − 1), −r_k), r_k),   p_k(0) = 0

    An arm that was loaded and unloaded before its zero was read, as laboratories do until the loop
    closes, begins where that left it: p_k(0) = −r_k sign(τ), with τ the loads of the ladder. One
    that has its weight on the gear begins where that brought it: τ_g within ±r_k.

    Attributes:
        reaches: Torques r_k [N·m] after which it slips; 0: at once, on the branch that the readings
            tell.
        start: What the gear has from before: nothing, loads that went up and down before every
            zero reading, or the arm's weight.
    """

    reaches: tuple[float, ...] = (0.0,)
    start: Start = "rest"
    name: ClassVar[str] = "friction_hysteresis"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque / K - h * sign(torque) while loading, + h * sign(torque) while unloading;"
        " with presliding r: - h * p / r, p the change of torque since the last reversal within +-r"
    )
    says: ClassVar[str] = "Friction in {where} makes loading and unloading differ."
    axes: ClassVar[str] = "the axis of the joint itself"
    also: ClassVar[str] = (
        f"{REACH['rest']}20: after a reversal it sticks until the torque has changed by r = 20 "
        f"N*m; several add up. {REACH['cycled']}20: the same where the load went up and down "
        f"before the zero; {REACH['weighed']}20: where the arm's weight came before the load"
    )
    twins: ClassVar[tuple[str, ...]] = (LostMotion.name,)  # while loads only grow

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The friction of one joint, pre-sliding where names of parameters tell."""
        told: dict[Start, tuple[float, ...]] = {
            start: tuple(sorted(torques_told(options.shape, head, "torque of slipping")))
            for start, head in REACH.items()
        }
        for start in ("cycled", "weighed"):
            if told[start]:
                return cls(where, scale_of(robot), told[start], start)
        jump = HALF in options.shape or not told["rest"]
        return cls(where, scale_of(robot), (*([0.0] if jump else []), *told["rest"]))

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Half width h of the loop, or of each part that slips after another torque."""
        return tuple(
            ParameterSpec(
                f"{REACH[self.start]}{r:g}" if r else HALF,
                "rad",
                "rad",
                plausible=5e-4,
                typical=5e-5,
                lower=0.0,
                meaning="h, half the width of the loop"
                + (f" of the part that slips after {r:g} N*m" if r else "")
                + BEFORE[self.start],
            )
            for r in self.reaches
        )

    def other_laws(self, load_cases: LoadCases) -> tuple[FrictionHysteresis, ...]:
        """Pre-sliding over each of `REACHES` of the largest torque, and over all of them.

        Each from every start that there may have been.

        Where no load is taken off step by step, nothing tells one from another.
        """
        largest = float(np.abs(self.load_torque(load_cases)).max(initial=0.0))
        if largest <= 0.0 or not (load_cases.branch < 0.0).any():
            return ()
        reaches = tuple(float(f"{share * largest:.3g}") for share in REACHES)
        shapes = (*((r,) for r in reaches), reaches)
        weighs = self.weight_torque(load_cases).any()
        starts = [start for start in REACH if weighs or start != "weighed"]
        laws = (
            *(replace(self, reaches=r, start=start) for start in starts for r in shapes),
            replace(self, reaches=(0.0,), start="rest"),
        )
        return tuple(law for law in laws if law != self)

    def elongation(self, torques: Array, load_cases: LoadCases, values: Array) -> Elongation:
        """See `Elastic.elongation`."""
        slips = np.array([r for r in self.reaches if r])
        course = self._course(torques[:, 0], slips, load_cases)
        held = iter(course.at(load_cases) / slips[:, None])
        at_once = -load_cases.branch * np.sign(torques[:, 0])
        shapes = [-next(held) if r else at_once for r in self.reaches]
        return constant_in_torque(np.stack(shapes, axis=-1), values)

    def by_onset(
        self, onset: Array, change: Array, load_cases: LoadCases, values: Array
    ) -> Array | None:
        """See `Switching.by_onset`: what is held back follows the torque until it slips."""
        slips = np.array([r for r in self.reaches if r])
        if not len(slips):
            return None
        h = np.array([h for h, r in zip(values, self.reaches, strict=True) if r])
        held = self._course(onset[:, 0], slips, load_cases).changed(change[:, 0], load_cases)
        return -np.tensordot(h / slips, held, axes=1)[:, None]

    def _course(self, torque: Array, slips: Array, load_cases: LoadCases) -> Course:
        weight = self.weight_torque(load_cases)[:, 0] if self.start == "weighed" else None
        return course_of(torque, slips, load_cases, cycled=self.start == "cycled", weight=weight)


@dataclass(frozen=True, eq=False)
class Course:
    """What k parts of a gear hold back, step by step of g poses side by side.

    Attributes:
        held: (S, k, g) torque [N·m].
        sticks: (S, k, g) it follows the torque of the load there, step by step.
    """

    held: Array
    sticks: Mask

    def at(self, load_cases: LoadCases) -> Array:
        """(k, N) of every reading, beyond its zero reading."""
        return _of_readings(self.held, load_cases)

    def changed(self, change: Array, load_cases: LoadCases) -> Array:
        """(k, N, P) the same of what changes (N, P) of the torque make of it."""
        steps, _, _ = load_cases.history
        torques = np.where((steps == IDLE)[..., None], 0.0, change[steps])
        moves = np.diff(torques, axis=0, prepend=0.0)  # (S, g, P)
        held = np.zeros((*self.held.shape[1:], change.shape[1]))
        seen = np.zeros((len(steps), *held.shape))
        for k in range(len(steps)):
            held = np.where(self.sticks[k][..., None], held + moves[k], 0.0)
            seen[k] = held
        return _of_readings(seen, load_cases)


def _of_readings(seen: Array, load_cases: LoadCases) -> Array:
    """(k, N, ...) of every reading beyond its zero reading, from the steps (S, k, g, ...)."""
    _, zero, own = load_cases.history
    pose = load_cases.pose_column
    return np.swapaxes(seen[own, :, pose] - seen[zero, :, pose], 0, 1)


def course_of(
    torque: Array,
    reaches: Array,
    load_cases: LoadCases,
    *,
    cycled: bool = False,
    weight: Array | None = None,
) -> Course:
    """What friction holds back at every step.

    Every pose begins without load and without memory; its loads follow one another in the order of
    the readings, with none in between where a zero was read or a repeat begins. Before a series
    that begins with a load that falls, more was on.

    Args:
        torque: (N,) torque of the load [N·m].
        reaches: (k,) torques after which parts of the gear slip [N·m].
        load_cases: The readings, in whose order the torques came.
        cycled: Before every zero reading the loads that follow it had been on and off.
        weight: (N,) torque of the arm's weight that came before the loads [N·m].
    """
    steps, _, _ = load_cases.history
    idle = steps == IDLE
    torques = np.where(idle, 0.0, torque[steps])
    change = np.diff(torques, axis=0, prepend=0.0)
    fresh = np.zeros(steps.shape, dtype=bool)  # the first load of a series, where it falls already
    fresh[1:] = idle[:-1] & ~idle[1:] & (load_cases.branch < 0.0)[steps[1:]]
    way = _sign_of_run(torques, idle) if cycled else None
    reach = reaches[:, None]
    held = np.zeros((len(reaches), steps.shape[1]))
    if weight is not None:
        held = np.minimum(np.maximum(weight[_first_rows(load_cases)], -reach), reach)
    seen = np.zeros((len(steps), *held.shape))
    sticks = np.zeros(seen.shape, dtype=bool)
    for k in range(len(steps)):
        free = held + change[k]
        held = np.minimum(np.maximum(free, -reach), reach)
        sticks[k] = (held == free) & ~fresh[k]
        if fresh[k].any():
            held = np.where(fresh[k], -reach * np.sign(torques[k]), held)
        if way is not None and idle[k].any():
            held = np.where(idle[k], -reach * way[k], held)
            sticks[k] &= ~idle[k]
        seen[k] = held
    return Course(seen, sticks)


def _sign_of_run(torques: Array, idle: Mask) -> Array:
    """(S, g) at every idle step the sign of the largest torque until the next one."""
    sign, peak = np.zeros(torques.shape), np.zeros(torques.shape[1])
    for k in range(len(torques) - 1, -1, -1):
        peak = np.where(np.abs(torques[k]) > np.abs(peak), torques[k], peak)
        if idle[k].any():
            sign[k] = np.where(idle[k], np.sign(peak), 0.0)
            peak = np.where(idle[k], 0.0, peak)
    return sign


def _first_rows(load_cases: LoadCases) -> Index:
    """(g,) a row of every pose."""
    return np.unique(load_cases.pose_column, return_index=True)[1]
