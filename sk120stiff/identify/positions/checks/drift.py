"""Readings that creep from row to row of a file that does not say when each was taken."""

from __future__ import annotations

import numpy as np

from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.measurements import Measurements

CLEAR = 10.0  # logarithm of the odds for a course over the rows
WORTH = 0.1  # share of the squares left that it must take off to be told
FEWEST = 20  # positions that a course is told from
POWERS = (1, 2)  # of the place in the file


def creeping(found: Calibration, readings: Measurements) -> list[str]:
    """That what is left follows the rows, where neither order nor time is stated.

    An error of the model does so too, where poses stand in the file one beside its neighbours: that
    it is drift only who read them can say.
    """
    problem = found.problem
    if readings.order is not None or readings.time is not None:
        return []
    if "position" not in problem.channels.present:
        return []
    held = problem.channels.held("position")
    gap = np.full(held.shape, np.nan)
    left = problem.of_channels.undo(found.residual)
    gap[held] = left[problem.channels.kinds[problem.channels.present.index("position")]]
    rows = np.flatnonzero(held.all(axis=1))
    if len(rows) < FEWEST:
        return []
    y = gap[rows]
    t = np.linspace(-1.0, 1.0, len(rows))
    A = np.column_stack([np.ones(len(rows)), *(t**power for power in POWERS)])
    course = A @ np.linalg.lstsq(A, y, rcond=None)[0]
    even = y - y.mean(axis=0)
    before, after = float((even**2).sum()), float(((y - course) ** 2).sum())
    count, spent = y.size, 3 * len(POWERS)
    odds = 0.5 * count * np.log(before / max(after, 1e-300)) - 0.5 * spent * np.log(count)
    if odds < CLEAR or after > (1.0 - WORTH) * before:
        return []
    creeps = 1e3 * float(np.linalg.norm(np.ptp(course, axis=0)))
    return [
        f"What is left creeps by {creeps:.2g} mm over the rows of the file. If they stand in the "
        "order in which they were read, add a column order (1, 2, 3, ...): a drift is then looked "
        "for among the causes."
    ]
