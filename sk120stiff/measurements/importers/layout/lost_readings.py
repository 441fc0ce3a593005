"""Rows in which an instrument read nothing and wrote a number that says so, as 9999 in x, y, z."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.contract import Sheet
from sk120stiff.measurements.importers.grid import is_number

_POSITIONS = ("", "measured ", f"{WITHOUT} ", f"{WITH} ")
# Nines alone (from 999 on, with decimals of nines or zeros), a power of ten from 10000 on, or ten
# digits before the point: no length that is measured has one of them in three axes at once.
_SAYS_NOTHING = re.compile(r"9{3,}\.9*0*|10{4,}\.0*|\d{10,}\.\d*")
FAR = 0.1  # of the extent of all others, by which such a row lies outside the box they fill
AGAIN = 2  # rows of 0, 0, 0 that are none: one may be where somebody set the instrument to zero


def without_lost(sheet: Sheet) -> Sheet:
    """The sheet without rows whose three coordinates are one number that stands for nothing: 9999,
    -999, 1e10 and the like, or for positions 0, 0, 0 in several rows, far from all others.

    Displacements of zero are readings.
    """
    lost: dict[int, str] = {}
    for kind, zero in (*((kind, True) for kind in _POSITIONS), ("d", False)):
        columns = sheet.those(*(f"{kind}{axis}" for axis in "xyz"))
        if len(columns) < 3:
            continue
        headers = ", ".join(column.header for column in columns)
        cells = list(zip(*(column.cells for column in columns), strict=True))
        for row, text in _lost(cells, zero=zero).items():
            lost.setdefault(row, f"{text} in {headers}, as where nothing was read")
    if not lost:
        return sheet
    kept = [row for row in range(len(sheet.lines)) if row not in lost]
    return replace(
        sheet.rows(kept),
        skipped=tuple(sorted((*sheet.skipped, *((sheet.lines[k], w) for k, w in lost.items())))),
    )


def _lost(cells: list[tuple[str, ...]], *, zero: bool) -> dict[int, str]:
    """Row → the number that stands for nothing there."""
    whole = [row for row, three in enumerate(cells) if all(map(is_number, three))]
    at = np.array([[float(cell) for cell in cells[row]] for row in whole]).reshape(-1, 3)
    same = (at[:, 0] == at[:, 1]) & (at[:, 1] == at[:, 2])
    says = np.array([bool(_SAYS_NOTHING.fullmatch(f"{abs(v):.6f}")) for v in at[:, 0]], dtype=bool)
    nothing: Mask = same & says
    zeros = ~at.any(axis=1)
    if zero and zeros.sum() >= AGAIN:
        nothing = nothing | zeros
    if not nothing.any() or nothing.all():
        return {}
    read = at[~nothing]
    far = nothing & (_beyond(at, read) > FAR * np.ptp(read, axis=0).max())
    return {whole[k]: cells[whole[k]][0] for k in np.flatnonzero(far)}


def _beyond(at: Array, read: Array) -> Array:
    """(N,) how far each point lies outside the box that the others fill."""
    low, high = read.min(axis=0), read.max(axis=0)
    return np.asarray(np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0.0), axis=1))
