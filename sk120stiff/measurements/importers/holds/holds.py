"""Holds: rows in turn in which an arm stands still under one load, as a sensor of force reads it.

Such a sensor never reads the same twice. Loads are the same while they differ by no more than their
own noise, which shows as what rows are off the running median of their standstill: it keeps steps
and slopes, so that weights hung one after the other are no noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, rms
from sk120stiff.measurements.importers.columns.pose_labels import near_poses
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.holds.orientations import NORMAL, held_orientations
from sk120stiff.measurements.poses import rows_at_rest
from sk120stiff.measurements.table.columns import FORCES, MOMENTS

STILL = 2e-4  # rad or m: what encoders of an arm that stands may wander by
LEAST = 5  # rows of a hold; the running median keeps plateaus that long
SAME = 5.0  # σ between running medians: at two edges of a short plateau they are its extremes
ODD = 6.0  # σ off the median of its hold: such a row is of another load
WITHIN = (0.95, 1.96)  # of normal errors this share lies within so many σ
SMALL = 0.03  # of how loads differ from hold to hold: noise, and no loads one by one
MANY = 2000  # rows of a recording: nobody reads as many one by one
EVEN = 5.0  # times the noise along another axis: one sensor is about as noisy along each


@dataclass(frozen=True, eq=False)
class Holds:
    """Standstills under one load each.

    Attributes:
        rows: Of every hold its rows; none has less than `LEAST`.
        moving: Rows in which the arm moves.
        changing: Rows of an arm that stands, under loads that do not last.
        noise: (6,) standard deviation of what is read of a load [N, N·m].
    """

    rows: list[Index]
    moving: Index
    changing: Index
    noise: Array

    def say(self) -> str:
        """The noise of the loads in words; empty where they are read without any."""
        parts = [
            f"{rms(part):.2g} {unit}"
            for part, unit in ((self.noise[:3], "N"), (self.noise[3:], "N·m"))
            if part.any()
        ]
        return " and ".join(parts)


def scatter_um(draft: Draft, holds: Holds) -> float:
    """By how much readings of a hold scatter per axis [µm], as the middle of them tells it: a late
    tracker moves on while the arm stands already. NaN of gauges, which have axes of their own."""
    apart = [
        values - np.median(values)
        for rows in holds.rows
        for column in draft.measured[rows].T
        if len(values := column[np.isfinite(column)])
    ]
    return 1e6 * NORMAL * float(np.median(np.abs(np.concatenate(apart)))) if apart else np.nan


def holds_of(joints: Array, wrench: Array) -> Holds:
    """Find the holds among rows in turn.

    Args:
        joints: (N, n) [rad or m].
        wrench: (N, 6) as it was read [N, N·m].
    """
    runs = rows_at_rest(joints, STILL)
    still = [run for run in runs if len(run) >= LEAST]
    levels = [_running_median(wrench[run]) for run in still]
    noise = _noise([wrench[run] - level for run, level in zip(still, levels, strict=True)])
    rows, changing = [], [np.zeros(0, int)]
    for run, level in zip(still, levels, strict=True):
        held, left = _under_one_load(wrench[run], level, noise)
        rows += [run[part] for part in held]
        changing.append(run[left])
    moving = np.concatenate([np.zeros(0, int), *(run for run in runs if len(run) < LEAST)])
    return Holds(rows, moving, np.concatenate(changing), noise)


def _under_one_load(wrench: Array, level: Array, noise: Array) -> tuple[list[Index], Index]:
    """Rows of a standstill under each load that lasts, and the others.

    Loads in turn that are alike are one, whatever is between them: noise parted them, where the
    running median has few rows, or a knock did.
    """
    parts = [p for p in rows_at_rest(level, SAME * noise) if len(p) >= LEAST]
    loads: list[Array] = []
    spans: list[tuple[int, int]] = []
    for part in parts:
        load, start = np.median(wrench[part], axis=0), int(part[0])
        if loads and (np.abs(load - loads[-1]) <= SAME * noise).all():
            start = spans.pop()[0]
            load = loads.pop()
        loads.append(load)
        spans.append((start, int(part[-1]) + 1))
    ends = [0, *(end for _, end in spans), 0]
    starts = [*(start for start, _ in spans), len(wrench)]
    held, taken = [], np.zeros(len(wrench), dtype=bool)
    for k, load in enumerate(loads):
        among = np.arange(ends[k], starts[k + 1])  # up to the loads on either side
        near = (np.abs(wrench[among] - load) <= ODD * noise).all(axis=1) & ~taken[among]
        if near.sum() >= LEAST:
            held.append(among[near])
            taken[among[near]] = True
    return held, np.flatnonzero(~taken)


def _running_median(values: Array) -> Array:
    """(N, k) medians of each row and up to four on either side of it."""
    side, last = LEAST - 1, len(values)
    windows = (values[max(0, k - side) : k + side + 1] for k in range(last))
    return np.array([np.median(window, axis=0) for window in windows])


def _noise(off: list[Array]) -> Array:
    """(6,) σ; few rows at steps and knocks do not count."""
    if not off:
        return np.zeros(6)
    share, sigmas = WITHIN
    found: Array = np.quantile(np.abs(np.concatenate(off)), share, axis=0) / sigmas
    return found


def mean_loads(holds: list[Index]) -> Callable[[Column], Column]:
    """What gives every row of a hold the mean of what was read of its load, in every column."""

    def averaged(column: Column) -> Column:
        if column.meaning not in (*FORCES, *MOMENTS, "payload"):
            return column
        cells = list(column.cells)
        for hold in holds:
            if len({cells[k] for k in hold}) > 1:
                mean = f"{np.mean([float(cells[k]) for k in hold]):.6g}"
                for k in hold:
                    cells[k] = mean
        return replace(column, cells=tuple(cells))

    return averaged


def _pieces(changing: Index, joints: Array) -> list[Index]:
    """Rows in turn of one standstill while the load changes, `LEAST` of them in a piece."""
    found: list[Index] = []
    cuts = np.flatnonzero(np.diff(changing) > 1) + 1
    for run in np.split(changing, cuts) if len(changing) else []:
        for still in rows_at_rest(joints[run], STILL):
            cut = still[: len(still) // LEAST * LEAST].reshape(-1, LEAST)
            found += [run[piece] for piece in cut]
    return found


def one_reading_each(draft: Draft, holds: Holds, notes: Sequence[str]) -> Sheet:
    """The sheet with a row for each hold, the median of what was read in it, orientations too; all
    others go."""
    sheet, still = draft.sheet, holds.rows
    middle = [int(run[len(run) // 2]) for run in still]
    medians = {c.meaning for c in sheet.columns if c.meaning in ("x", "y", "z")} | {
        c.meaning for c in draft.joints.taken
    }
    averaged = mean_loads(still)
    units = {header.partition("[")[2].rstrip("]") for header, _ in draft.joints.written}
    turned, told = held_orientations(sheet, still, next(iter(units & {"deg", "rad"}), None))

    def cut(column: Column) -> Column:
        if column.meaning in turned:
            return replace(column, cells=turned[column.meaning])
        if column.meaning not in medians:
            return averaged(column).rows(middle)
        values = np.array([float(cell) for cell in column.cells])
        cells = tuple(f"{np.median(values[run]):.12g}" for run in still)
        return replace(column, cells=cells)

    columns = tuple(map(cut, sheet.columns))
    if sheet.get("pose") is None and len({tuple(row) for row in draft.loads.wrench[middle]}) > 1:
        q = draft.joints.values[middle]
        columns = (*columns, Column("standstill", "pose", None, "", near_poses(q)))
    whole = replace(sheet.rows(middle), columns=columns, spare=tuple(map(cut, sheet.spare)))
    return whole.noting(*notes, *told)


def as_repeats(draft: Draft) -> Sheet | None:
    """The sheet with one load for all rows of a hold, which then are repeats; None where loads were
    not read with noise, or where that may be loads of their own.

    A sensor is noisy along all axes that it reads, and little beside what loads differ by from hold
    to hold. Weights that somebody changes from row to row are not. Of a recording of many rows each
    hold is one reading: rows in turn err alike, and tell no more than their middle does.
    """
    sheet, W = draft.sheet, draft.loads.wrench
    read = [k for k, name in enumerate(FORCES) if sheet.get(name) is not None]
    if not read:
        return None
    holds = holds_of(draft.joints.values, W)
    noise = holds.noise[read]
    if len(holds.rows) < 2 or noise.min() <= 0.0 or noise.max() > EVEN * noise.min():
        return None
    levels = np.array([W[rows][:, read].mean(axis=0) for rows in holds.rows])
    if np.linalg.norm(noise) > SMALL * np.linalg.norm(np.std(levels, axis=0)):
        return None
    typical = int(np.median([len(rows) for rows in holds.rows]))
    scatter = scatter_um(draft, holds)
    if len(W) > MANY and not draft.displaced and len(set(draft.marker_of)) < 2:
        slopes = _pieces(holds.changing, draft.joints.values)
        parts = sorted([*holds.rows, *slopes], key=lambda rows: int(rows[0]))
        note = (
            f"This is a recording of {len(W)} rows: in {len(holds.rows)} holds, of {typical} rows "
            "in the median, the arm stood under one load, which was read with a noise of "
            f"{holds.say()}. Each is one reading, the median of its rows (which scatter by "
            f"{scatter:.3g} µm per axis) under their mean load"
        )
        if slopes:
            note += f"; so are {len(slopes)} times {LEAST} rows in turn while the load changed"
        return one_reading_each(draft, replace(holds, rows=parts), [f"{note}."])
    told = (
        f" They scatter by {scatter:.3g} µm per axis. If the instrument is no noisier over hours, "
        f"state that: noise: {{sigma: {scatter:.3g}, unit: um}} in the YAML file."
    )
    told = told if np.isfinite(scatter) else ""
    alone = ""
    if len(holds.changing):
        alone = f"; {len(holds.changing)} rows under loads that did not last keep theirs"
    averaged = replace(sheet, columns=tuple(map(mean_loads(holds.rows), sheet.columns)))
    return averaged.noting(
        f"In {len(holds.rows)} holds, of {typical} rows in the median, the arm stood under one "
        f"load, which was read with a noise of {holds.say()}. All rows of a hold have its mean "
        f"as their load: they are repeats of one pose and load{alone}.{told}"
    )
