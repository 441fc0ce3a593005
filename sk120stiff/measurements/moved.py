"""What moved in the middle of a campaign, and the same readings with that told.

Whoever wrote the file may not know of it. So whatever is found once it is certain is taken as it
is likeliest, and the work goes on: the result says so, and how the file says otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, TypeVar

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements

Result = TypeVar("Result")

MOST = 3  # different things that moved in one campaign: more are no campaign

Column = Literal["station", "series"]


class MovedBetween(InputError):
    """Tracker, marker or a joint moved between rows, and the file tells nothing of it.

    Attributes:
        apart: The same readings with it told.
        taken: How it is told there, in a sentence.
    """

    def __init__(
        self, what: str, *, where: str | None, remedy: str, apart: Measurements, taken: str
    ) -> None:
        super().__init__(what, where=where, remedy=remedy)
        self.apart = apart
        self.taken = taken

    @property
    def sentences(self) -> str:
        """What was found, how it is taken, and how the file says otherwise."""
        return f"{self.what[0].upper()}{self.what[1:]}. {self.taken} {self.remedy}"


def clock_of(readings: Measurements) -> Array:
    """(N,) when each row was read: its order, its time, or else its place in the file."""
    clock = readings.order if readings.order is not None else readings.time
    return np.arange(float(readings.n_readings)) if clock is None else clock


def parts_of_all(readings: Measurements, rows: Index, part: Index) -> Index:
    """(N,) part of every row, where (P,) parts of some rows are known, one after the other.

    What is masked is of the part that it stands in.
    """
    known = np.zeros(readings.n_readings, dtype=np.intp)
    known[rows] = part
    order = np.argsort(clock_of(readings), kind="stable")
    every = np.empty_like(known)
    every[order] = np.maximum.accumulate(known[order])
    return every


def labelled(readings: Measurements, column: Column, part: Sequence[int] | Index) -> Measurements:
    """The same absolute readings with a label for each (N,) part of the campaign: a, b, ...

    What was found before is kept: each of its parts may have parts of its own.
    """
    said = readings.absolute
    if said is None:
        return readings
    known = said.stations if column == "station" else said.series
    pairs = list(zip(known or [""] * len(part), map(int, part), strict=True))
    every = sorted(dict.fromkeys(pairs))
    labels = tuple(chr(ord("a") + every.index(pair)) for pair in pairs)
    found = tuple(dict.fromkeys([*said.found, column]))
    told = replace(said, stations=labels) if column == "station" else replace(said, series=labels)
    return replace(readings, absolute=replace(told, found=found))


def turned_from(readings: Measurements, joint: int, by: Array) -> Measurements:
    """The same readings with (N,) `by` [rad or m] added to the values of a joint.

    Rows of a pose that differ by then are poses of their own.
    """
    more = np.zeros_like(readings.joints)
    more[:, joint] = by
    first = dict(zip(reversed(readings.pose), by[::-1], strict=True))
    sizes = np.unique(by).tolist()
    pose = tuple(
        label if off == first[label] else f"{label} ({sizes.index(off) + 1})"
        for label, off in zip(readings.pose, by.tolist(), strict=True)
    )
    return replace(readings, joints=readings.joints + more, pose=pose)


def taken_as_moved(
    readings: Measurements, work: Callable[[Measurements], Result]
) -> tuple[Result, tuple[str, ...]]:
    """What comes of readings, taken as they are likeliest where something moved among them.

    Args:
        readings: As they were read.
        work: What is done with them; it raises `MovedBetween`.

    Returns:
        Its result, and sentences of what moved.
    """
    told: tuple[str, ...] = ()
    for _ in range(MOST):
        try:
            return work(readings), told
        except MovedBetween as moved:
            readings, told = moved.apart, (*told, moved.sentences)
    if readings.absolute is not None:  # no more is looked for of what was found so often
        readings = replace(readings, absolute=replace(readings.absolute, found=()))
    try:
        return work(readings), told
    except MovedBetween as moved:
        found = f"{' '.join(told)} Then: {moved.what}"
        raise InputError(found, where=moved.where, remedy=moved.remedy) from moved
