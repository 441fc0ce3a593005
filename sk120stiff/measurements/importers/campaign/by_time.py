"""Which row of another file each reading belongs to, by the times of both.

Two clocks of one campaign differ by a constant: of all constants one leaves the readings at the
times of rows of the other file. People read at uneven times, so that no other does; of even ones
only clocks that show the same time of the day tell.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements.importers.clock import DateOrder, since_first
from sk120stiff.measurements.importers.contract import Column, Sheet

FEWEST = 5  # readings whose times tell how clocks are shifted
MOST = 2000  # rows of the other file; of a longer log the clocks have to show the same time
TRIED = 12  # readings, at each of whose times every row of the other file is tried
CLEAR = 2.0  # times farther off: any other shift
LEAST = 0.01  # of the time from row to row: and by so much more
CLOSE = 0.1  # of the time from row to row: as far off readings are in the mean
SHARE = 0.5  # of the readings that find a row
DENSE = 0.25  # of the time between readings: such rows are a log, in which every time has a row


EXACT = 1e-3  # s
DAY = 86400.0  # s
_FRACTION = re.compile(r"(?<=:\d\d)[.,]\d+")
_OF_DAY = re.compile(r"\d{1,2}:")


@dataclass(frozen=True, eq=False)
class ByTime:
    """Readings with a row of the other file.

    Attributes:
        rows, others: (M,) readings and their rows.
        shift: By how much later the readings are [s], in the median.
        off: How far off that any of them is [s].
        columns: Headers of both clocks.
        dense: Is the other file a log, in which every time has a row?
    """

    rows: Index
    others: Index
    shift: float
    off: float
    columns: tuple[str, str]
    dense: bool

    def say(self) -> str:
        """In words."""
        later = f"{abs(self.shift):.3g} s {'later' if self.shift >= 0.0 else 'earlier'}"
        later += f", within {self.off:.2g} s" if self.off > EXACT else " throughout"
        return f"{self.columns[0]}, {self.columns[1]}: {later}"


def by_time(points: Sheet, other: Sheet, order: DateOrder | None = None) -> ByTime | str | None:
    """The row of another file for each reading; why it cannot be told, in words; None where not
    both files have times.
    """
    mine, theirs = clock_of(points), clock_of(other)
    if not mine or not theirs:
        return None
    headers = (_shown(mine), _shown(theirs))
    a, b = (_seconds(columns, order) for columns in (mine, theirs))
    for column, seconds in ((headers[0], a), (headers[1], b)):
        if isinstance(seconds, str):
            return f"{column} is not understood ({seconds})"
    if isinstance(a, str) or isinstance(b, str):
        return None
    if len(a) < FEWEST or len(b) < 2:
        return f"fewer than {FEWEST} readings do not tell how far the clocks are apart"
    step, own = _step(b), _step(a)
    dense = step <= DENSE * own
    same = _same_time(mine, theirs, order)
    shift = _shift(a, b, step) if len(b) <= MOST and not dense else None
    if shift is None:
        if same is None or step <= 0.0:
            return (
                "the clocks do not show the same time, and nothing else tells how far they differ"
            )
        shift = same
    nearest = _nearest(a - shift, b)
    off = np.abs(a - shift - b[nearest])
    near = off <= (step if dense else 0.5 * step)
    rows = np.flatnonzero(near)
    twice = not dense and len(set(nearest[rows])) < len(rows)
    if len(rows) < SHARE * len(a) or twice:
        return "few readings have the time of a row of the other file"
    others, apart = nearest[rows], a[rows] - b[nearest[rows]]
    absolute = apart - (same or 0.0)
    shown = float(np.median(absolute if same is not None else apart))
    return ByTime(rows, others, shown, float(np.ptp(apart)), headers, dense)


def _step(clock: Array) -> float:
    """Usual time between stamps [s]; rows of one stamp are not apart. Zero: all have one."""
    steps = np.diff(np.unique(clock))
    return float(np.median(steps)) if len(steps) else 0.0


def clock_of(sheet: Sheet) -> tuple[Column, ...]:
    """The columns of a clock, date and time."""
    return tuple(c for c in sheet.those("date", "time") if all(c.cells))


def _shown(columns: Sequence[Column]) -> str:
    return " and ".join(column.header for column in columns)


def _seconds(columns: Sequence[Column], order: DateOrder | None) -> Array | str:
    """(N,) since the first row [s], or why not."""
    if len(columns) == 1 and columns[0].unit == "s":
        cells: tuple[str, ...] | str = columns[0].cells
    else:
        cells = since_first(*(column.cells for column in columns), order=order)
    if isinstance(cells, str):
        return cells
    try:
        seconds = np.array([float(cell) for cell in cells])
    except ValueError:
        return "a cell is no number"
    return seconds - seconds[0] if np.isfinite(seconds).all() else "a cell is no number"


def _same_time(
    mine: Sequence[Column], theirs: Sequence[Column], order: DateOrder | None
) -> float | None:
    """How much less the seconds of the second clock are when both show the same time; None where
    they show none, or are written in other ways."""
    if len(mine) != len(theirs) or any(column.unit == "s" for column in (*mine, *theirs)):
        return None
    firsts = [(one.cells[0], two.cells[0]) for one, two in zip(mine, theirs, strict=True)]
    whole = [tuple(_FRACTION.sub("", cell) for cell in pair) for pair in firsts]
    for cells in (firsts, whole):
        seconds = since_first(*cells, order=order)
        if not isinstance(seconds, str):
            apart = float(seconds[1])
            of_day = len(firsts) == 1 and all(_OF_DAY.match(cell) for cell in firsts[0])
            return apart - DAY if of_day and apart > 0.5 * DAY else apart
    return None


def _shift(a: Array, b: Array, step: float) -> float | None:
    """By how much the first clock is ahead of the second; None where several shifts fit."""
    tried = a[np.unique(np.linspace(0, len(a) - 1, TRIED).astype(int))]
    shifts = np.unique((tried[:, None] - b[None, :]).ravel())
    cap = 0.5 * step
    score = np.array([_score(a - shift, b, cap) for shift in shifts])
    best = int(np.argmin(score))
    others = score[np.abs(shifts - shifts[best]) > cap]
    clear = CLEAR * score[best] + LEAST * step
    if score[best] > CLOSE * step or (len(others) and others.min() < clear):
        return None
    near = a - shifts[best] - b[_nearest(a - shifts[best], b)]
    return float(shifts[best] + np.median(near[np.abs(near) <= cap]))


def _score(times: Array, b: Array, cap: float) -> float:
    """How far off rows the readings are in the mean [s], of those between the first row and the
    last: each by no more than `cap`; infinite where few are."""
    inside = times[(times >= b.min() - cap) & (times <= b.max() + cap)]
    if len(inside) < max(SHARE * len(times), 2):
        return np.inf
    return float(np.minimum(np.abs(inside - b[_nearest(inside, b)]), cap).mean())


def _nearest(times: Array, b: Array) -> Index:
    order = np.argsort(b, kind="stable")
    rising = b[order]
    right = np.clip(np.searchsorted(rising, times), 1, len(rising) - 1)
    left = right - 1
    nearer = np.where(times - rising[left] <= rising[right] - times, left, right)
    return np.asarray(order[nearer], dtype=np.intp)
