"""Slips between rows: columns that were pasted some rows too high or low, or upside down."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.sheet import Sheet

SHIFTS = (1, -1, 2, -2)  # rows
PARTS: tuple[tuple[str, dict[str, bool]], ...] = (
    ("the readings (dx, dy, dz)", {}),
    ("the loads (fx, fy, fz)", {"wrench": True}),
    ("the joints", {"joints": True}),
)


def of_rows(sheet: Sheet) -> Iterator[Correction]:
    """Corrections of the order of rows, for displacements, loads and joints apart."""
    count = len(sheet.joints)
    for name, which in PARTS:
        for shift in SHIFTS:
            way, back = ("low", "up") if shift > 0 else ("high", "down")
            rows = f"{abs(shift)} row{'s' if abs(shift) > 1 else ''}"
            yield _moved(
                shifted(count, shift),
                which,
                f"{name} seem to stand {rows} too {way}",
                f"Move their columns {back} by {rows}.",
            )
        yield _moved(
            np.arange(count)[::-1],
            which,
            f"{name} seem to stand in reverse order",
            "Turn their columns upside down.",
        )


def shifted(count: int, shift: int) -> Index:
    """(count,) the row whose values belong into each row; -1: none."""
    rows = np.arange(count) + shift
    return np.where((rows >= 0) & (rows < count), rows, -1)


def _moved(rows: Index, which: dict[str, bool], said: str, remedy: str) -> Correction:
    return Correction(said, remedy, lambda s: s.moved(rows, **which))
