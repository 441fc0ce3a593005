"""A log that went on while the arm moved: every standstill is one reading, the way between none."""

from __future__ import annotations

import numpy as np

from sk120stiff.measurements.importers.contract import Sheet
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.holds.holds import (
    LEAST,
    STILL,
    holds_of,
    one_reading_each,
    scatter_um,
)

STANDSTILLS = 3  # of a log
MOVING = 10  # rows of a log in which the arm moves
SHORT = 0.2  # of the way from standstill to standstill: a step from row to row on it


def standstills(draft: Draft) -> Sheet | None:
    """The sheet of a log with a row for each standstill; None where the file is no log.

    A log has many rows on the way from one standstill to the next. Poses that were read once among
    others that were repeated are as far apart as those. Loads that were hung one after the other
    while the arm stood are readings of their own.
    """
    q = draft.joints.values
    if draft.displaced or len(set(draft.marker_of)) > 1 or len(q) < STANDSTILLS * LEAST + MOVING:
        return None
    holds = holds_of(q, draft.loads.wrench)
    if len(holds.rows) < STANDSTILLS or len(holds.moving) < MOVING:
        return None
    ways = np.abs(np.diff([q[hold[0]] for hold in holds.rows], axis=0)).max(axis=1)
    ways = ways[ways > STILL]  # of loads at one pose there is none
    steps = np.abs(np.diff(q, axis=0)).max(axis=1)[np.minimum(holds.moving, len(q) - 2)]
    if not len(ways) or np.median(steps) > SHORT * np.median(ways):
        return None
    typical = int(np.median([len(run) for run in holds.rows]))
    left = f"{len(holds.moving)} rows in which it moved"
    if len(holds.changing):
        left += f" and {len(holds.changing)} in which the load changed"
    notes = [
        f"This is a log: in {len(holds.rows)} standstills, of {typical} rows in the median, the "
        f"arm stood under one load. Each is one reading, the median of its rows (which scatter by "
        f"{scatter_um(draft, holds):.3g} µm per axis); {left} are left out."
    ]
    if holds.noise.any():
        notes.append(
            f"Loads are read with a noise of {holds.say()}; that of a standstill is their mean."
        )
    return one_reading_each(draft, holds, notes)
