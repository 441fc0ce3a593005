"""Which columns hold an orientation: a quaternion, a matrix, or angles as controllers name them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.measurements.importers.columns.matrices import LOOKED_AT, ROTATION
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Column, Meanings, Sheet
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.table.columns import QUATERNION

# By which names three angles stand side by side; the order is that of the numbers in a row.
NAMES = ("x y z", "roll pitch yaw", "a b c", "w p r", "o a t", "alpha beta gamma")
MATRICES = (  # row by row, and column by column
    "r11 r12 r13 r21 r22 r23 r31 r32 r33",
    "r00 r01 r02 r10 r11 r12 r20 r21 r22",
    "nx ny nz ox oy oz ax ay az",
)
FROM_0 = ("q0", "q1", "q2", "q3")  # a quaternion as Leica writes it
NUMBERED = ("q1", "q2", "q3", "q4")  # and as ABB does
FEWEST = 3  # different rows that tell a quaternion


def named(sheet: Sheet) -> Sheet:
    """The sheet with columns such as A, B, C or R11, R12 ... known, where all of them stand."""
    plain_names = [unit_of_header(column.header)[0].strip().lower() for column in sheet.spare]
    for names in (each.split() for each in (*MATRICES, *NAMES)):
        places = [plain_names.index(name) for name in names if plain_names.count(name) == 1]
        if len(places) == len(names):
            found = [
                replace(sheet.spare[place], meaning=f"orientation {name}")
                for place, name in zip(places, names, strict=True)
            ]
            spare = tuple(c for k, c in enumerate(sheet.spare) if k not in places)
            return replace(sheet, columns=(*sheet.columns, *found), spare=spare)
    return sheet


def orientation_columns(sheet: Sheet) -> tuple[Column, ...]:
    """Columns of an orientation that belong together; none where there are not."""
    angles = ([f"orientation {name}" for name in names.split()] for names in (*MATRICES, *NAMES))
    for names in (QUATERNION, *angles):
        if sheet.has(*names):
            return tuple(sheet.those(*names))
    return ()


def with_quaternions(
    names: Sequence[str],
    meanings: Sequence[tuple[str, float] | None],
    rows: Sequence[Sequence[str]],
) -> Meanings:
    """Meanings of numbered columns that are no joints but a quaternion, its scalar first.

    Of q1 to q4 that are joints of other names beside them tell, else that there is no fifth and
    that the four are of length one in every row: so Q0 to Q3 of a Leica probe are no joints either.

    Args:
        names, meanings: Of the columns, as their headers say.
        rows: Cells below them.
    """
    plain, out = [name.strip().lower() for name in names], list(meanings)
    for numbered in (FROM_0, NUMBERED):
        places = [plain.index(name) for name in numbered if plain.count(name) == 1]
        if len(places) < len(numbered):
            continue
        if any((known := meanings[k]) and not known[0].startswith("joint ") for k in places):
            continue  # commanded joints, beside measured ones
        others = {known[0] for k, known in enumerate(meanings) if known and k not in places}
        more = f"q{int(numbered[-1][1:]) + 1}" in plain
        if {f"joint {k}" for k in (1, 2, 3, 4)} <= others or (not more and _are_unit(rows, places)):
            for place, meaning in zip(places, QUATERNION, strict=True):
                out[place] = (meaning, 1.0)
            return out
    return out


def _are_unit(rows: Sequence[Sequence[str]], places: Sequence[int]) -> bool:
    """Are the numbers of every row that has them the parts of a unit vector, of several?"""
    full = [
        [float(row[k]) for k in places]
        for row in rows
        if all(k < len(row) and is_number(row[k]) for k in places)
    ]
    lengths = np.linalg.norm(np.array(full[:LOOKED_AT]).reshape(-1, len(places)), axis=1)
    several = len({tuple(row) for row in full[:LOOKED_AT]}) >= FEWEST
    return several and bool((np.abs(lengths - 1.0) < ROTATION).all())
