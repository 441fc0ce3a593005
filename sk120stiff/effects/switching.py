"""Elastic laws that jump with the sign of a torque, or remember where it came from."""

from __future__ import annotations

from sk120stiff.arrays import Array
from sk120stiff.effects.base import Elastic
from sk120stiff.effects.load_cases import LoadCases


class Switching(Elastic):
    """An elastic law that jumps with the sign of a torque.

    It is given the torques of the true load at the unloaded pose: they decide the side on which a
    joint comes to rest. Were the torques of the loaded pose asked, an arm could find no rest
    between two sides. The elongation is therefore a constant during the search for equilibrium.
    """

    def by_onset(
        self,
        onset: Array,
        change: Array,
        load_cases: LoadCases,
        values: Array,
    ) -> Array | None:
        """(N, k, P) by how much the elongation changes where these torques (N, k) do, (N, k, P).

        None where the law jumps and is flat between its jumps. With a memory, the change of one
        reading's torque tells in those that follow it.
        """
        return None
