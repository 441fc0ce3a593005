"""The load that really acts, and how it goes with the arm as it bends.

What is stated in axes of the base keeps its direction there. What a sensor on the tool has read
does not: its axes are those of the tool as it stands under that load, sag included, so the load at
the equilibrium z is

    W(z) = W_base + R(z) W_tool

with R(z) the tool's axes there, and W_base what hangs on the tool besides, or nothing. Misreadings
of a sensor act on W_tool, in its own axes; where the load is stated in axes of the base, those of
the unloaded tool stand for them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.effects.base import LoadError, Misreading
from sk120stiff.model.misread import misread
from sk120stiff.stiffness.wrench import rotate


@dataclass(frozen=True, eq=False)
class TrueLoad:
    """A load at the point of the force.

    Attributes:
        steady: (N, 6) the part that is constant in base axes, base axes [N, N·m].
        follower: (N, 6) the part that turns with the tool, tool axes; None where nothing does.
        of_steady, of_follower: Of each effect its part of the vector of values, and (N, 6, p)
            derivatives of the two, in axes of the unloaded tool and in those of the tool.
    """

    steady: Array
    follower: Array | None
    of_steady: tuple[tuple[slice, Array], ...]
    of_follower: tuple[tuple[slice, Array], ...]

    def at(self, rotation: Array) -> Array:
        """(N, 6) the whole load where the tool's axes are (N, 3, 3), base axes."""
        if self.follower is None:
            return self.steady
        return self.steady + rotate(rotation, self.follower)


def true_load(
    effects: list[tuple[Misreading, slice]], load_cases: LoadCases, values: Array
) -> TrueLoad:
    """The load as reported with what the load errors make of it."""
    R = load_cases.rotation
    to_tool = np.swapaxes(R, -1, -2)
    if not load_cases.follows:
        found = misread(effects, load_cases, values, rotate(to_tool, load_cases.wrench))
        return TrueLoad(rotate(R, found.value), None, found.columns, ())
    hanging = load_cases.hanging
    read = rotate(to_tool, load_cases.wrench - hanging)
    sensed = misread([e for e in effects if not _hangs(e)], load_cases, values, read)
    hung = misread([e for e in effects if _hangs(e)], load_cases, values, np.zeros_like(read))
    steady = hanging + rotate(R, hung.value)
    return TrueLoad(steady, sensed.value, hung.columns, sensed.columns)


def _hangs(effect: tuple[Misreading, slice]) -> bool:
    return isinstance(effect[0], LoadError) and effect[0].hangs
