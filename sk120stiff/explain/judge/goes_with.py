"""What the remainder goes with: a suspect, how much it leaves, and whether it foretells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.errors import micro
from sk120stiff.explain.localise.changes import changed_at

ALL_OF_IT = "nothing is left beyond the noise"
BETTER = 0.95  # of the gap without it, that a suspect has to leave of readings no fit saw
CHANGED = 0.85  # the same of a change among the readings, which is one of very many
NOT_FORETOLD = "that is where it shows, but how it goes on there is not known"


@dataclass(frozen=True)
class Foretold:
    """How near readings that no fit saw are foretold.

    Attributes:
        what: Which readings, with the verb: "Poses that are left out are".
        gap, without: With the suspect and with the names alone, rms per axis [m].
    """

    what: str
    gap: float
    without: float

    @property
    def better(self) -> bool:
        """Nearer with the suspect than without, by more than which poses were drawn may bring."""
        return self.gap < BETTER * self.without

    def sentence(self) -> str:
        """Both gaps, and that what does no better is no law."""
        both = f"to {micro(self.gap)} µm rms per axis with it"
        but = "" if self.better else f": {NOT_FORETOLD}"
        return f"{self.what} foretold {both} and to {micro(self.without)} without{but}."


def foretold(what: str, gap: float, without: float) -> Foretold | None:
    """None where either gap [m] is unknown."""
    return Foretold(what, gap, without) if np.isfinite([gap, without]).all() else None


@dataclass(frozen=True)
class GoesWith:
    """A suspect beside which names leave nothing but noise, or less than without it.

    Attributes:
        suspect: Completes the sentence "It goes with ...".
        left: What is left beside it beyond the noise, rms per axis [m]; zero: nothing.
        without: The same without it [m].
        beside_names: Names stand beside it.
        foretold: How near other readings are foretold with it; None: that is not known.
    """

    suspect: str
    left: float
    without: float
    beside_names: bool
    foretold: Foretold | None = None

    @property
    def whole(self) -> bool:
        """Nothing is left beyond the noise."""
        return not self.left

    @property
    def borne_out(self) -> bool:
        """Readings that no fit saw do not speak against it.

        For a change somewhere among the readings they have to speak: of all the poses from which on
        something may have changed there is nearly always one that fits a little better.
        """
        told, change = self.foretold, changed_at(self.suspect) is not None
        if told is None:
            return not change
        return told.gap < CHANGED * told.without if change else told.better

    @property
    def most(self) -> bool:
        """It takes more than half of the square."""
        return self.left**2 < 0.5 * self.without**2

    def sentences(self) -> tuple[str, ...]:
        """Where the remainder lives, and whether other readings bear it out."""
        beside = "with that beside the names" if self.beside_names else "with that in the model"
        left = f"{micro(self.left)} of {micro(self.without)} µm rms per axis are left"
        part = "It" if self.whole else "Most of it" if self.most else "Part of it"
        said = f"{part} goes with {self.suspect}: {beside}, {ALL_OF_IT if self.whole else left}."
        return (said,) if self.foretold is None else (said, self.foretold.sentence())
