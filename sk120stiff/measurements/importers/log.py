"""A log that went on while the arm moved: every standstill is one reading, the way between none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.poses import rows_at_rest

STILL = 2e-4  # rad or m: what encoders of an arm that stands may wander by
LEAST = 5  # rows of a standstill
STANDSTILLS = 3  # of a log
MOVING = 10  # rows of a log in which the arm moves
SHORT = 0.2  # of the way from standstill to standstill: a step from row to row on it


def standstills(draft: Draft) -> Sheet | None:
    """The sheet of a log with a row for each standstill; None where the file is no log.

    A log has many rows on the way from one standstill to the next. Poses that were read once among
    others that were repeated are as far apart as those.
    """
    q = draft.joints.values
    if draft.displaced or len(set(draft.marker_of)) > 1 or len(q) < STANDSTILLS * LEAST + MOVING:
        return None
    runs = rows_at_rest(q, STILL, draft.loads.wrench)
    still = [run for run in runs if len(run) >= LEAST]
    moving = np.concatenate([np.zeros(0, int), *(run for run in runs if len(run) < LEAST)])
    if len(still) < STANDSTILLS or len(moving) < MOVING:
        return None
    ways = np.abs(np.diff([q[run[0]] for run in still], axis=0)).max(axis=1)
    steps = np.abs(np.diff(q, axis=0)).max(axis=1)[np.minimum(moving, len(q) - 2)]
    if np.median(steps) > SHORT * np.median(ways):
        return None
    return _of_standstills(draft, still, len(moving))


def _of_standstills(draft: Draft, still: list[Index], moving: int) -> Sheet:
    sheet = draft.sheet
    middle = [int(run[len(run) // 2]) for run in still]
    medians = {c.meaning for c in sheet.columns if c.meaning in ("x", "y", "z")} | {
        c.meaning for c in draft.joints.taken
    }

    def cut(column: Column) -> Column:
        if column.meaning not in medians:
            return replace(column, cells=tuple(column.cells[k] for k in middle))
        values = np.array([float(cell) for cell in column.cells])
        cells = tuple(f"{np.median(values[run]):.12g}" for run in still)
        return replace(column, cells=cells)

    apart = np.concatenate(
        [draft.measured[run] - draft.measured[run].mean(axis=0) for run in still]
    )
    scatter = 1e6 * float(np.sqrt(np.mean(apart**2)))
    typical = int(np.median([len(run) for run in still]))
    return replace(
        sheet,
        columns=tuple(map(cut, sheet.columns)),
        spare=tuple(map(cut, sheet.spare)),
        lines=tuple(sheet.lines[k] for k in middle),
        rank=tuple(sheet.rank[k] for k in middle) if sheet.rank else (),
        notes=(
            *sheet.notes,
            f"This is a log: in {len(still)} standstills, of {typical} rows in the median, the arm "
            f"stood. Each is one reading, the median of its rows (which scatter by {scatter:.3g} "
            f"µm rms per axis); {moving} rows in which it moved are left out.",
        ),
    )
