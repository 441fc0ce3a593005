"""What a gap may go with: a handful of columns, a name that completes a sentence, an abscissa."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sk120stiff.arrays import Array


@dataclass(frozen=True, eq=False)
class Suspect:
    """One thing that the gap may go with.

    Attributes:
        family: ``place``, ``law``, ``linkage``, ``angle``, ``axes``, ``instrument``, ``series`` or
            ``change``.
        name: Completes the sentence "The gap goes with ...".
        columns: (N, 3, k) change of the readings per unit of each of k free factors, base axes [m].
        abscissa: (N,) the variable that a figure draws the gap against.
        label: Name and unit of the abscissa.
        direction: (N, 3) direction in which it moves the point, base axes; None where the fit
            decides it.
        carried: (N, k) load behind each column, where a place yields [N or N·m].
        frees: Effects (``name`` or ``name:where``) of whose law it is the free form.
        drive: The joint whose position alone its law goes with; empty where it is no such law.
        alike: How many suspects, itself among them, differ by a whole number alone.
    """

    family: str
    name: str
    columns: Array
    abscissa: Array
    label: str
    direction: Array | None = None
    carried: Array = field(default_factory=lambda: np.zeros((0, 0)))
    frees: tuple[str, ...] = ()
    drive: str = ""
    alike: int = 1

    @property
    def price_of_choice(self) -> float:
        """What which of those alike it is costs, in -2 ln L: all of them together are one cause."""
        return 2.0 * float(np.log(self.alike))
