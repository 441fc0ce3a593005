"""Columns that are right down to a row and stand some rows off from there on.

So it looks where one of two files lacks a line, or has one twice. Whatever the row, what remains to
be fitted are sums over the rows above it and over those below: each row is tried at the price of
one small problem.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.passive import Passive, of_sums
from sk120stiff.data_checks.sheet import Sheet
from sk120stiff.data_checks.slips import PARTS, SHIFTS, shifted

TRIED = 40  # rows that are tried before those between the best two
LEAST = 3  # rows with a reading, above and below: fewer are no column


@dataclass(frozen=True)
class FromARow:
    """Columns that stand some rows off from a row on.

    Attributes:
        correction: What mends it.
        found: What a passive arm explains then.
    """

    correction: Correction
    found: Passive


def from_a_row_on(sheet: Sheet, lines: Index, drives: int | None) -> FromARow | None:
    """The row, the columns and by how many rows that leave least; None where no row can be tried.

    Args:
        sheet: The readings, none left out.
        lines: (N,) lines of the file.
        drives: Of the unit compliances only so many are asked for; None: all.
    """
    best: tuple[float, int, Index, dict[str, bool], str, int] | None = None
    plain = _Sums.of(sheet, drives)
    rows = np.flatnonzero(sheet.kept)
    inner = rows[LEAST:-LEAST]
    if not len(inner):
        return None
    for name, which in PARTS:
        for shift in SHIFTS:
            source = shifted(len(sheet.joints), shift)
            moved = sheet.moved(source, **which)
            if not moved.exists():
                continue
            off = _Sums.of(moved, drives)
            row, left = _least(plain, off, inner)
            if best is None or left < best[0]:
                best = left, row, source, which, name, shift
    if best is None:
        return None
    _, row, source, which, name, shift = best
    own = np.where(np.arange(len(source)) >= row, source, np.arange(len(source)))
    way, back = ("low", "up") if shift > 0 else ("high", "down")
    count = f"{abs(shift)} row{'s' if abs(shift) > 1 else ''}"
    correction = Correction(
        f"from line {lines[row]} on {name} seem to stand {count} too {way}",
        f"Look there for a line that is missing or stands twice in one of the columns: from that "
        f"line on, move {name} {back} by {count}.",
        lambda s: s.moved(own, **which),
    )
    return FromARow(
        correction, _Sums.at(plain, _Sums.of(sheet.moved(source, **which), drives), row)
    )


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums over all rows above each row: (N + 1, k, k), (N + 1, k), (N + 1,) and (N + 1,)."""

    gram: Array
    along: Array
    square: Array
    count: Array

    @staticmethod
    def of(sheet: Sheet, drives: int | None) -> _Sums:
        """Of the readings of a sheet."""
        A, d = sheet.columns()[:, :, :drives], sheet.measured
        known = np.isfinite(d)
        A, d = np.where(known[:, :, None], A, 0.0), np.where(known, d, 0.0)
        at, total = np.flatnonzero(sheet.kept), len(sheet.joints) + 1

        def summed(each: Array) -> Array:
            out = np.zeros((total, *each.shape[1:]))
            out[at + 1] = each
            return np.asarray(np.cumsum(out, axis=0))

        return _Sums(
            summed(np.einsum("nik,nil->nkl", A, A)),
            summed(np.einsum("nik,ni->nk", A, d)),
            summed((d**2).sum(axis=1)),
            summed(known.sum(axis=1).astype(float)),
        )

    def at(self, other: _Sums, row: int) -> Passive:
        """Fitted to these rows above `row` and to the other ones from there on."""

        def both(own: Array, off: Array) -> Array:
            return np.asarray(own[row] + off[-1] - off[row])

        return of_sums(
            both(self.gram, other.gram),
            both(self.along, other.along),
            float(both(self.square, other.square)),
            int(both(self.count, other.count)),
        )


def _least(plain: _Sums, off: _Sums, rows: Index) -> tuple[int, float]:
    """The row from which the other sums leave least, and what they leave per number [m²]."""
    places: Iterator[int] | Index = np.unique(
        np.linspace(0, len(rows) - 1, min(TRIED, len(rows))).astype(np.intp)
    )
    known: dict[int, float] = {}
    for _ in range(2):
        for place in map(int, places):
            if place not in known:
                known[place] = plain.at(off, int(rows[place])).left
        best = min(known, key=lambda each: known[each])
        step = len(rows) // TRIED + 1
        places = np.arange(max(best - step, 0), min(best + step + 1, len(rows)))
    return int(rows[best]), known[best]
