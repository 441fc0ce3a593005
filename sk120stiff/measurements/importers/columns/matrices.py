"""Poses that are written as the numbers of a matrix: ``T00 ... T33``, ``m11 ... m44``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import product

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.measurements.importers.contract import Meanings
from sk120stiff.measurements.importers.grid import is_number

_NUMBER = re.compile(
    r"(?P<of>.*?)[\s_]*[\[(]?(?P<row>[0-4])[\])]?[\s_,]*[\[(]?(?P<col>[0-4])[\])]?"
)
_PLACES = frozenset(("x", "y", "z", "dx", "dy", "dz", "measured x", "nominal x", "loaded x"))
ROTATION = 1e-3  # by which a row of a rotation may be off a unit vector, as it is rounded
LOOKED_AT = 50  # rows of the table that tell


def with_matrices(
    names: Sequence[str],
    meanings: Sequence[tuple[str, float] | None],
    rows: Sequence[Sequence[str]],
) -> tuple[Meanings, list[str]]:
    """Meanings with the position and the rotation of a pose that is written as a matrix.

    Three rows of four numbers or four of them, counted from 0 or from 1, in columns of one name.
    The rotation has to be one, and of four rows the last 0, 0, 0, 1; where that stands in the last
    column instead, the matrix is written column by column. Else nothing is taken for a matrix.

    Args:
        names, meanings: Of the columns, as their headers say.
        rows: Cells below them.

    Returns:
        Meanings, and what was understood, in sentences.
    """
    out = list(meanings)
    if any(known and known[0] in _PLACES for known in meanings):
        return out, []
    found = [
        (places, first)
        for places in _groups(names).values()
        for first in (0, 1)
        if _indices(first, 3) <= places.keys() <= _indices(first, 4)
        and (len(places) == len(_indices(first, 3)) or places.keys() == _indices(first, 4))
    ]
    if len(found) != 1:
        return out, []
    (places, first), full = found[0], len(found[0][0]) == len(_indices(0, 4))
    matrices = _matrices(places, first, [row for row in rows if _filled(row, places)][:LOOKED_AT])
    turned = full and _is_pose(np.swapaxes(matrices, 1, 2))
    if not turned and not _is_pose(matrices):
        return out, []
    for (row, col), k in places.items():
        i, j = (col, row) if turned else (row, col)
        i, j = i - first, j - first
        if i < len("xyz"):
            out[k] = ("xyz"[i] if j == len("xyz") else f"orientation r{i + 1}{j + 1}"), 1.0
        elif j == i:
            out[k] = MATRIX_END, 1.0
        else:
            out[k] = f"{MATRIX_END} {j + 1}", 1.0
    columns = [names[k] for _, k in sorted(places.items())]
    how = "column by column" if turned else "row by row"
    return out, [f"{columns[0]} to {columns[-1]} are a pose as a matrix, {how}."]


MATRIX_END = "matrix end"  # begins the meanings of 0, 0, 0, 1


def _groups(names: Sequence[str]) -> dict[str, dict[tuple[int, int], int]]:
    """What stands before two digits → these → the place of the column."""
    out: dict[str, dict[tuple[int, int], int]] = {}
    for k, name in enumerate(names):
        match = _NUMBER.fullmatch(name.strip())
        if match:
            out.setdefault(match["of"], {})[int(match["row"]), int(match["col"])] = k
    return out


def _indices(first: int, count: int) -> set[tuple[int, int]]:
    """Of so many rows of four numbers, counted from `first`."""
    return set(product(range(first, first + count), range(first, first + 4)))


def _filled(row: Sequence[str], places: dict[tuple[int, int], int]) -> bool:
    return all(k < len(row) and is_number(row[k]) for k in places.values())


def _matrices(
    places: dict[tuple[int, int], int], first: int, rows: Sequence[Sequence[str]]
) -> Array:
    """(N, 4, 4), the last row 0, 0, 0, 1 where the table has none."""
    out = np.tile(np.eye(4), (len(rows), 1, 1))
    for (row, col), k in places.items():
        out[:, row - first, col - first] = [float(cells[k]) for cells in rows]
    return out


def _is_pose(matrices: Array) -> bool:
    """Rotations above 0, 0, 0, 1, in every row."""
    R = matrices[:, :3, :3]
    turns = np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max(initial=0.0) < ROTATION
    return bool(len(matrices) and turns and not np.any(matrices[:, 3] != np.eye(4)[3]))
