"""Gears as they are: right in kind for a catalogue's name, wrong in detail for its law.

The reversible ones carry the name of hardening or play, those with a loop that of friction; which
of a family's names stands there does not matter, the family counts (`families.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .equilibrium import Law
from .history import Advance, History
from .rotations import Array
from .world import Cause, Scene


@dataclass(frozen=True)
class Reversible(Cause):
    """An extra twist that the joint's torque alone decides."""

    def curve(self, torque: Array, compliance: float) -> Array:
        raise NotImplementedError

    def laws(self, scene: Scene) -> list[Law]:
        column = scene.mechanism.column[self.where]
        compliance = scene.springs[self.where]

        def law(f: Array, x: Array) -> tuple[int, Array]:
            return column, self.curve(f[column], compliance)

        return [law]


@dataclass(frozen=True)
class SmoothPlay(Reversible):
    """Play whose flanks take hold gradually and not alike. Sizes: half_width [rad].

    Options: flank [N m], the torque over which it closes; skew s: the positive side is 1 + s wide
    and its flank 1 + s long, the negative one 1 - s.
    """

    name: ClassVar[str] = "lost_motion"

    def curve(self, torque: Array, compliance: float) -> Array:
        side = 1.0 + float(self.options.get("skew", 0.0)) * np.sign(torque)
        return (
            self.size("half_width") * side * np.tanh(torque / (side * float(self.options["flank"])))
        )


@dataclass(frozen=True)
class SteppedHardening(Reversible):
    """The gear stiffens step by step. Sizes: share, the extra compliance at no torque.

    Options: knees (k,) [N m] rising, and shares (k,) falling: between knee i - 1 and knee i the
    extra compliance is share * shares[i]; beyond the last knee none.
    """

    name: ClassVar[str] = "gear_hardening"

    def curve(self, torque: Array, compliance: float) -> Array:
        knees = np.array(self.options["knees"], float)
        rises = np.array(self.options["shares"], float) * np.diff(knees, prepend=0.0)
        ends = np.concatenate([[0.0], np.cumsum(rises)])
        twist = np.interp(np.abs(torque), np.concatenate([[0.0], knees]), ends)
        return self.size("share") * compliance * np.sign(torque) * twist


@dataclass(frozen=True)
class PowerHardening(Reversible):
    """Teeth and rollers touch as Hertz says: twist with a power of the torque below one.

    Sizes: share of the joint's compliance at the torque `full`. Options: exponent, full [N m].
    """

    name: ClassVar[str] = "gear_hardening"

    def curve(self, torque: Array, compliance: float) -> Array:
        full = float(self.options["full"])
        power = (np.abs(torque) / full) ** float(self.options["exponent"])
        return self.size("share") * compliance * full * np.sign(torque) * power


@dataclass(frozen=True)
class Remembering(Cause):
    """Friction beside the joint's spring. Its state runs along the loads, from the idle torque."""

    name: ClassVar[str] = "friction_hysteresis"

    def advance(self, stiffness: float) -> Advance:
        """The whole twist of the spring and what rubs beside it."""
        raise NotImplementedError

    def laws(self, scene: Scene) -> list[Law]:
        if scene.before is None:
            return []
        column = scene.mechanism.column[self.where]
        idle = scene.before.f[column]
        compliance = scene.springs[self.where]
        history = History.of(scene.rows)
        advance = self.advance(1.0 / compliance)

        def linear(state: None, torque: Array) -> tuple[Array, None]:
            return compliance * torque, None

        def law(f: Array, x: Array) -> tuple[int, Array]:
            torque = f[column] - idle
            return column, history.walk(torque, advance) - history.walk(torque, linear)

        return [law]


@dataclass(frozen=True)
class MaxwellSlip(Remembering):
    """Springs in series with sliders, all beside the joint's spring.

    Sizes: half_width [rad], the twist of the joint's spring under all sliders' friction. Options:
    shares (E,) of that friction, summing to one, and reach (E,) [rad], the twist at which each
    slider starts to slip.
    """

    def advance(self, stiffness: float) -> Advance:
        limit = self.size("half_width") * stiffness * np.array(self.options["shares"], float)
        slope = limit / np.array(self.options["reach"], float)
        top, steep = limit[:, None, None], slope[:, None, None]

        def step(state: Any, torque: Array) -> tuple[Array, Any]:
            if not np.any(limit):
                return torque / stiffness, None
            x0, p0 = (0.0 * torque, 0.0 * limit[:, None] * torque) if state is None else state

            def held(x: Array) -> Array:
                """Forces of the elements (E, M, P) at twists x (M, P)."""
                return np.clip(p0[:, None] + steep * (x - x0), -top, top)

            # spring and elements together are piecewise linear in x, with a knee where one slips
            slips = [x0 + (way * limit[:, None] - p0) / slope[:, None] for way in (1.0, -1.0)]
            knees = np.sort(np.concatenate(slips), axis=0)
            force = stiffness * knees + held(knees).sum(0)
            twist = knees[0] + (torque - force[0]) / stiffness
            for k in range(len(knees) - 1):
                rise = np.maximum(force[k + 1] - force[k], 1e-300)
                inner = knees[k] + (knees[k + 1] - knees[k]) * (torque - force[k]) / rise
                twist = np.where(torque > force[k], inner, twist)
            above = knees[-1] + (torque - force[-1]) / stiffness
            twist = np.where(torque > force[-1], above, twist)
            return twist, (twist, held(twist[None])[:, 0])

        return step


@dataclass(frozen=True)
class Dahl(Remembering):
    """Friction that approaches its limit exponentially after every reversal.

    Sizes: half_width [rad], the twist of the joint's spring under the whole friction. Option
    reach [rad]: the twist over which the friction turns.
    """

    def advance(self, stiffness: float) -> Advance:
        limit = self.size("half_width") * stiffness
        reach = float(self.options["reach"])

        def step(state: Any, torque: Array) -> tuple[Array, Any]:
            x0, p0 = (0.0 * torque, 0.0 * torque) if state is None else state
            way = np.sign(torque - (stiffness * x0 + p0))
            goal = way * limit
            # after the way s >= 0 the friction is goal + (p0 - goal) exp(-s / reach); the sum of
            # spring and friction is concave in s, so Newton from zero comes up to it from below
            s = np.zeros_like(torque)
            for _ in range(80):
                fade = np.exp(-s / reach)
                short = way * (torque - stiffness * (x0 + way * s) - goal - (p0 - goal) * fade)
                change = short / (stiffness + np.abs(p0 - goal) * fade / reach)
                s = s + change
                if np.abs(change).max() < 1e-15:
                    break
            return x0 + way * s, (x0 + way * s, goal + (p0 - goal) * np.exp(-s / reach))

        return step
