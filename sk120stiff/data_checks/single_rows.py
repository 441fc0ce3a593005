"""Slips of the pen at single rows, which no correction of a whole column mends.

A sign that was forgotten, axes that changed places, a decimal point, two rows whose readings were
exchanged. A slip is told where with it the reading fits as the others do, and without it every axis
that it changes does not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, permutations

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.errors import listed
from sk120stiff.measurements import Measurements

AXES = ("dx", "dy", "dz")
GAUGE = ("d", "d", "d")  # a number along a direction, whatever axis that is nearest to
TOGETHER = 2 / 3  # of what one axis may be off, that several may be, rms: two errors of three
POINT = {0.1: "left", 10.0: "right"}  # which way a decimal point has to go


def slips_of_rows(
    readings: Measurements, rows: Sequence[int], told: Array, limit: float
) -> dict[int, str]:
    """What each of some rows would fit with, as half a sentence; rows without are left out.

    Args:
        readings: All rows.
        rows: Those that lie far off.
        told: (N, 3) what a model says of every row, in the axes of the readings [m].
        limit: What a mended axis may be off [m].
    """
    read = readings.displacement
    if read is None:
        return {}
    out = {}
    for row in rows:
        for slip, mended in _single(read[row], AXES if readings.directions is None else GAUGE):
            changed = np.isfinite(read[row]) & (mended != read[row])
            off = np.abs(read[row] - told[row])[changed] >= limit
            if off.all() and _fits(mended, told[row], limit):
                out[row] = slip
                break
    alone = [row for row in rows if row not in out]
    for pair in combinations(alone, 2):
        if all(_fits(read[a], told[b], limit) for a, b in permutations(pair)):
            for row, other in permutations(pair):
                place = place_of(readings, other)
                out[row] = f"exchanged with the reading of {place} both would fit"
    return dict(sorted(out.items()))


def place_of(readings: Measurements, row: int) -> str:
    """Pose and line of a row of the file."""
    line = int(readings.line[row])
    return f"pose {readings.pose[row]}" + (f", line {line}" if line else "")


def _fits(read: Array, told: Array, limit: float) -> bool:
    """Is no axis off by more than the limit, and are not all of them nearly as far off?"""
    off = np.abs(read - told)[np.isfinite(read)]
    if not len(off) or off.max() >= limit:
        return False
    return len(off) < 2 or bool(rms(off) < TOGETHER * limit)


def _single(read: Array, names: Sequence[str]) -> Iterator[tuple[str, Array]]:
    """Slips at one reading (3,), and what should have stood there."""
    seen = [k for k in range(3) if np.isfinite(read[k]) and read[k]]
    for count in (1, 2, 3):
        for axes in combinations(seen, count):
            mended = read.copy()
            mended[list(axes)] *= -1.0
            yield f"{listed([names[k] for k in axes])} would fit with the other sign", mended
    for axis in seen:
        for factor, way in POINT.items():
            mended = read.copy()
            mended[axis] *= factor
            yield f"{names[axis]} would fit with its decimal point one place to the {way}", mended
    for order in permutations(range(3)):
        moved = [k for k in range(3) if order[k] != k]
        if moved and set(moved) <= set(seen):
            shown = listed([names[k] for k in moved])
            yield f"{shown} would fit in one another's place", read[list(order)]
