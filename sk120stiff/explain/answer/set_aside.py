"""What may have happened to single readings that were set aside: slips that a hand makes.

A sign that was forgotten, axes that changed places, a decimal point, two rows whose readings were
exchanged. A slip is told where with it the reading fits as the others do.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, permutations
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import ToolkitError, listed
from sk120stiff.identify import known_model
from sk120stiff.measurements import Measurements
from sk120stiff.model.predicted import predict_what_holds

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation

FITS = 3.0  # times the gap of the readings in use, rms, that a mended axis may be off
AXES = ("dx", "dy", "dz")
POINT = {0.1: "left", 10.0: "right"}  # which way a decimal point has to go


def likely_slips(answer: Explanation) -> Mapping[int, str]:
    """What each row that was set aside would fit with, as half a sentence; rows without are left.

    Args:
        answer: Readings, and the model that is held against them.
    """
    rows, read = answer.set_aside, answer.readings.displacement
    if not rows or read is None:
        return {}
    final = known_model(answer.final)
    try:
        told = predict_what_holds(final, load_cases_of(final.robot, answer.readings)).displacement
    except ToolkitError:
        return {}
    limit = FITS * max(answer.steps[-1].fit_rms, answer.noise_floor or 0.0)
    out = {}
    for row in rows:
        for slip, mended in _single(read[row]):
            if _fits(mended, told[row], limit):
                out[row] = slip
                break
    alone = [row for row in rows if row not in out]
    for pair in combinations(alone, 2):
        if all(_fits(read[a], told[b], limit) for a, b in permutations(pair)):
            for row, other in permutations(pair):
                place = place_of(answer.readings, other)
                out[row] = f"exchanged with the reading of {place} both would fit"
    return out


def set_aside_sentences(answer: Explanation) -> tuple[str, ...]:
    """One for every reading that was set aside."""
    slips = likely_slips(answer)
    return tuple(
        f"Set aside as no smooth cause can have made it: {place_of(answer.readings, row)}"
        + (f"; {slips[row]}." if row in slips else ".")
        for row in answer.set_aside
    )


def place_of(readings: Measurements, row: int) -> str:
    """Pose and line of a row of the file."""
    line = int(readings.line[row])
    return f"pose {readings.pose[row]}" + (f", line {line}" if line else "")


def _fits(read: Array, told: Array, limit: float) -> bool:
    seen = np.isfinite(read)
    return bool(seen.any() and (np.abs(read - told)[seen] < limit).all())


def _single(read: Array) -> Iterator[tuple[str, Array]]:
    """Slips at one reading (3,), and what should have stood there."""
    seen = [k for k in range(3) if np.isfinite(read[k]) and read[k]]
    for count in (1, 2, 3):
        for axes in combinations(seen, count):
            mended = read.copy()
            mended[list(axes)] *= -1.0
            yield f"{listed([AXES[k] for k in axes])} would fit with the other sign", mended
    for axis in seen:
        for factor, way in POINT.items():
            mended = read.copy()
            mended[axis] *= factor
            yield f"{AXES[axis]} would fit with its decimal point one place to the {way}", mended
    for order in permutations(range(3)):
        moved = [k for k in range(3) if order[k] != k]
        if moved and set(moved) <= set(seen):
            names = listed([AXES[k] for k in moved])
            yield f"{names} would fit in one another's place", read[list(order)]
