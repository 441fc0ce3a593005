"""Where a loaded arm stands, and what the instrument makes of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import LoadCases
from sk120stiff.model.misread import Misread
from sk120stiff.model.true_load import TrueLoad
from sk120stiff.robot import Screws
from sk120stiff.stiffness import Equilibrium


@dataclass(frozen=True, eq=False)
class Standing:
    """Where the loaded arm stands.

    Attributes:
        load_cases: The readings.
        load: The true load.
        onset: (N, n_z) torques of the load at the unloaded pose, which switch what jumps [N·m or
            N]; zero where nothing does.
        begun: The unloaded arm as these torques have it; None where nothing jumps.
        rest: Equilibrium under load and weight.
    """

    load_cases: LoadCases
    load: TrueLoad
    onset: Array
    begun: Screws | None
    rest: Equilibrium


@dataclass(frozen=True, eq=False)
class Solution(Standing):
    """A solved set of displacements; what sensitivities build on.

    Attributes:
        unloaded: Equilibrium before the load, under the arm's own weight, of U of the readings.
        begin: (N,) which of these each reading begins with, or a slice over all.
        readings: What the instrument made of the displacement.
    """

    unloaded: Equilibrium
    begin: Index | slice
    readings: Misread

    @property
    def displacement(self) -> Array:
        """(N, 3) predicted readings in the axes of the measurements [m]."""
        axes = np.swapaxes(self.load_cases.reading_axes, -1, -2)
        return np.asarray(np.einsum("nij,nj->ni", axes, self.readings.value))

    @property
    def turn(self) -> Array:
        """(N, 3, 3) from the axes of the tool at its zero reading to those under the load, base."""
        before = self.unloaded.screws.rotation[self.begin]
        return np.asarray(self.rest.screws.rotation @ np.swapaxes(before, -1, -2))
