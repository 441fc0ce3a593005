"""Offsets of single poses that go steadily with the order of the rows: a drift, if rows have one.

Without a column that says when rows were read no drift is sought: rows may have been sorted. What
comes of it instead are offsets of poses, all different; where they rise or fall from row to row,
whoever took the readings knows whether that is their order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation

FEWEST = 6  # poses of which a steady course can be told
HALF = 0.5  # of the offsets' squares about their mean that goes with the order
CHANCE = 1e-4  # that offsets in any order do so


def steady_offsets(answer: Explanation) -> str | None:
    """What to do about offsets of poses where no order was stated; None: nothing was named so."""
    readings = answer.final.problem.measurements
    drawn = [each.effect for each in answer.findings if each.effect.random_effects]
    if not drawn or readings.order is not None or readings.time is not None:
        return None
    for effect in drawn:
        values = [p.internal for p in answer.final.parameters if p.effect.id == effect.id]
        share, chance = _with_order(np.array(values), len(readings.poses))
        if share > HALF and chance < CHANCE:
            return (
                f"The offsets of the poses go steadily with the order of the rows ({share:.0%} of "
                "their squares): if they were read in that order, that is a drift. Write the order "
                "into a column order (1, 2, 3, ...) and run this again."
            )
    return (
        "No order of the readings is stated, so a drift was not looked for: if offsets of poses "
        "may have come with the time, write it into a column order (1, 2, 3, ...)."
    )


def _with_order(values: np.ndarray, poses: int) -> tuple[float, float]:
    """Share of the squares of offsets (3 of each pose) that is linear in the order, and its p."""
    if poses < FEWEST or len(values) != 3 * poses:
        return 0.0, 1.0
    offsets = values.reshape(poses, 3)
    offsets = offsets - offsets.mean(axis=0)
    way = np.arange(poses) - 0.5 * (poses - 1)
    rise = way @ offsets / (way @ way)
    total = float((offsets**2).sum())
    left = float(((offsets - np.outer(way, rise)) ** 2).sum())
    if not total > 0.0:
        return 0.0, 1.0
    freedom = 3 * (poses - 2)
    ratio = (total - left) / 3.0 / max(left / freedom, 1e-300)
    return 1.0 - left / total, float(stats.f.sf(ratio, 3, freedom))
