"""Few rows so far off all others that with them no arm explains the readings at all.

A tracker that lost its target, a digit too many: one such row outweighs the squares of all others.
They are looked for only where a passive arm explains next to nothing, and set aside only where it
explains nearly everything without them: rows of another robot, or of shuffled columns, stay in.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.data_checks.passive import compliances
from sk120stiff.data_checks.sheet import MOST, Sheet, sheet_of
from sk120stiff.data_checks.single_rows import place_of
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

HALF = 0.5  # of the readings' squares: what a passive arm explains at the very least
SOUND = 0.9  # the same without wild rows, before they are called so
FEW = 0.125  # share of the rows that may be wild
FAR = 8.0  # times what is left of the others, rms: no smooth cause is so much at one row alone
SPARE = 6  # numbers beyond the compliances that it takes to judge a fit
TOLD = 6  # rows that are named


def wild_rows(sheet: Sheet) -> Index:
    """Rows of a sheet that are far off what a passive arm makes of all others; mostly none."""
    rows, d = np.flatnonzero(sheet.kept), sheet.measured
    columns = sheet.columns()
    A, y = columns.reshape(d.size, -1), d.ravel()
    read = np.isfinite(y)
    A, y = np.where(read[:, None], A, 0.0), np.where(read, y, 0.0)
    of_row = np.repeat(np.arange(len(d)), 3)
    kept = np.ones(len(d), dtype=bool)
    for _ in range(1 + int(FEW * len(d))):
        use = kept[of_row]
        c = compliances(A[use].T @ A[use], A[use].T @ y[use])
        count = int(read[use].sum())
        if c is None or count < A.shape[1] + SPARE:
            break
        off = y - A @ c
        size = np.sqrt(np.bincount(of_row, off**2))
        left = float(off[use] @ off[use])
        share = 1.0 - left / float(y[use] @ y[use])
        if share >= (HALF if kept.all() else SOUND):
            each = np.sqrt(left / count * np.bincount(of_row, read))  # rms of a whole row
            apart = bool((size[~kept] > FAR * each[~kept]).all())
            return rows[~kept] if apart else rows[:0]
        kept[int(np.argmax(np.where(kept, size, 0.0)))] = False
    return rows[:0]


def without_wild(robot: Robot, measurements: Measurements) -> tuple[Measurements, str | None]:
    """The displacements with wild rows masked, and the sentence that says so."""
    if measurements.displacement is None or int(measurements.use.sum()) > MOST:
        return measurements, None
    sheet = sheet_of(robot, measurements)
    if sheet is None or not sheet.exists() or not sheet.moves:
        return measurements, None
    wild = wild_rows(sheet)
    if not len(wild):
        return measurements, None
    use = measurements.use.copy()
    use[wild] = False
    size = 1e3 * np.sqrt(np.nansum(measurements.displacement**2, axis=1))
    named = "; ".join(
        f"{place_of(measurements, row)}: {_plain(size[row])} mm" for row in wild[:TOLD]
    )
    more = " …" if len(wild) > TOLD else ""
    one, usual = len(wild) == 1, _plain(float(np.median(size[use])))
    said = (
        f"{len(wild)} {'row is' if one else 'rows are'} so far off that no arm explains the "
        f"readings with {'it' if one else 'them'} ({named}{more}; the others "
        f"{usual} mm in the median), and nearly all of the others without: "
        f"{'it is' if one else 'they are'} set aside. Check what was read there, or write 0 into "
        "a column use."
    )
    return replace(measurements, use=use), said


def _plain(value: float) -> str:
    """Three significant digits, without an exponent."""
    return f"{float(f'{value:.3g}'):g}"
