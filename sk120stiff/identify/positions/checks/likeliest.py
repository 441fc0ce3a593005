"""Which of several things moved between rows, where each takes off much: simplicity counts.

A tracker moves by six numbers, a marker by three, a joint by one, and numbers fit an error of the
model as well as a move: rows are no independent witnesses then, and odds of independent noise run
to the richest. So the simplest stands, until another does to what it leaves what a move must do to
be one: halve it, and once more with each further time, by more than its numbers take off at rows
where nothing happened (the BIC, Schwarz, Ann. Statist. 6, 1978, p. 461, of overdispersed numbers,
McCullagh & Nelder 1989, ch. 9). Whatever is within that doubt of the likeliest is its rival.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.identify.positions.checks.change_points import (
    BEYOND_DOUBT,
    HALF,
    Change,
    Steps,
)
from sk120stiff.measurements.moved import Column


@dataclass(frozen=True)
class Cause:
    """What may have moved.

    Attributes:
        what: It.
        column: The column that tells when.
        own: What each of its labels has.
        joint: Which actuated joint slipped; None: none did.
    """

    what: str
    column: Column
    own: str
    joint: int | None = None


@dataclass(frozen=True, eq=False)
class Suspect:
    """A cause that moved at some times.

    Attributes:
        cause: It.
        steps: What was read, with its columns.
        change: When it moved.
        raw: (M, f) its columns, not whitened.
    """

    cause: Cause
    steps: Steps
    change: Change
    raw: Array

    @property
    def numbers(self) -> int:
        """How many numbers tell how it moved."""
        return int(len(self.change.cuts) * self.steps.frame.shape[1])

    @property
    def left(self) -> float:
        """Square that is left beside it."""
        return self.steps.kept.left(list(self.change.cuts))

    @property
    def error_of_number(self) -> float:
        """See `Steps.error_of_number`."""
        return self.steps.kept.error_of_number(self.change.cuts)

    @property
    def sizes(self) -> Array:
        """(C, f) by how much it moved at each time."""
        return self.steps.kept.sizes(self.change.cuts)

    def price(self, simpler: Suspect) -> float:
        """Logarithm of the odds that it has to bring, for its numbers more, and their times."""
        steps = self.steps.kept
        times = len(self.change.cuts) - len(simpler.change.cuts)
        more = 0.5 * (self.numbers - simpler.numbers) * np.log(len(steps.gap))
        return float(more + times * np.log(int(steps.when.max()) + 1))

    def clearer_than(self, simpler: Suspect) -> bool:
        """Does it explain more, beyond what its numbers may take off of an error of the model?"""
        times = max(len(self.change.cuts) - len(simpler.change.cuts), 0)
        halvings = times + (self.cause != simpler.cause)
        if self.left > HALF**halvings * simpler.left:
            return False
        gain = 0.5 * (simpler.left - self.left) / self.error_of_number
        return gain > self.price(simpler) + BEYOND_DOUBT


def variants(cause: Cause, steps: Steps, raw: Array) -> list[Suspect]:
    """A cause at all times that were found, and at fewer of them."""
    found = steps.found
    ways = steps.kept.fewer(found) if found.cuts else []
    return [Suspect(cause, steps, change, raw) for change in ways]


def likeliest(suspects: Sequence[Suspect]) -> Suspect:
    """The simplest, until another brings more beyond doubt."""
    order = sorted(suspects, key=lambda each: (each.numbers, len(each.change.cuts), each.left))
    best = order[0]
    for each in order[1:]:
        if each.clearer_than(best):
            best = each
    return best


def rivals_of(best: Suspect, suspects: Sequence[Suspect]) -> list[Suspect]:
    """Of every other cause the one that explains nearly as much with as few moves, likeliest first.

    That it has more numbers does not speak against it: they may all be small.
    """
    unit = best.error_of_number
    doubt = dict[Cause, tuple[float, Suspect]]()
    for each in suspects:
        fewer = len(each.change.cuts) <= len(best.change.cuts)
        behind = 0.5 * (each.left - best.left) / unit + min(each.price(best), 0.0)
        if each.cause == best.cause or not fewer or behind > BEYOND_DOUBT:
            continue
        if each.cause not in doubt or behind < doubt[each.cause][0]:
            doubt[each.cause] = behind, each
    return [each for _, each in sorted(doubt.values(), key=lambda pair: pair[0])]
