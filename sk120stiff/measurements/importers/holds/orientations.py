"""The orientation of a hold: the middle of what was read of it while the arm stood still."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.measurements.importers.columns.orientations import orientation_columns
from sk120stiff.measurements.importers.contract import Column, Sheet

QUATERNION, MATRIX = 4, 9  # numbers
UNIT = 0.01  # by which a length or a determinant may differ from 1: what was not seen has zeros
NORMAL = 1.4826  # standard deviation of normal errors over the median of their sizes
NEAR = np.radians(2.0)  # within which angles add up, whatever axes they are about
PERIODS = {"deg": 360.0, "°": 360.0, "rad": 2.0 * np.pi}


def held_orientations(
    sheet: Sheet, holds: Sequence[Index], joint_unit: str | None
) -> tuple[dict[str, tuple[str, ...]], list[str]]:
    """Cells of the columns of an orientation, by meaning: one for each hold.

    Quaternions have their signs aligned and length 1; of matrices the nearest rotation is taken.
    Three numbers are angles or a vector in some order that only the fit tells: near the middle row
    their medians are the same in any, and where they scatter farther that row stands for its hold.

    Args:
        sheet: The readings.
        holds: Rows of each hold.
        joint_unit: Unit of angles, where their columns state none.

    Returns:
        The cells, empty without orientations in numbers, and what is to be said.
    """
    columns = orientation_columns(sheet)
    values = numbers_of(columns)
    if values is None:
        return {}, []
    units = {column.unit or joint_unit or "" for column in columns}
    period = PERIODS.get(units.pop()) if len(units) == 1 else None
    good = are_orientations(values)
    out, middle = [], 0
    for rows in holds:
        seen = rows[good[rows]]
        at = rows[len(rows) // 2]
        if not len(seen):
            out.append([column.cells[at] for column in columns])
            continue
        own = seen[np.abs(seen - at).argmin()]
        found = _middle(values[seen], values[own], period)
        middle += found is None
        out.append([f"{value:.12g}" for value in (values[own] if found is None else found)])
    said = []
    if middle:
        said.append(
            f"Orientations of {middle} of {len(holds)} holds are those of one row each, in the "
            "middle: as numbers they scatter too far for their median, or have no unit."
        )
    return {c.meaning: tuple(row[k] for row in out) for k, c in enumerate(columns)}, said


def _middle(values: Array, own: Array, period: float | None) -> Array | None:
    """(k,) of (n, k) and one of them; None where that has to stand for all."""
    if len(own) == QUATERNION:
        signs = np.where(values @ own < 0.0, -1.0, 1.0)
        mid = np.median(values * signs[:, None], axis=0)
        length = float(np.linalg.norm(mid))
        return None if length < 1.0 - 2.0 * UNIT else np.asarray(mid / length)
    if len(own) == MATRIX:
        u, s, v = np.linalg.svd(np.median(values, axis=0).reshape(3, 3))
        return None if s[-1] < 1.0 - 2.0 * UNIT else np.asarray((u @ v).ravel())
    if period is None:
        return None
    off = values - own
    off -= period * np.round(off / period)
    mid = np.median(off, axis=0)
    spread = NORMAL * np.median(np.abs(off - mid), axis=0)
    return None if spread.max() > NEAR / (2.0 * np.pi) * period else np.asarray(own + mid)


def are_orientations(values: Array) -> Mask:
    """(N,) rows that hold an orientation."""
    good: Mask = np.asarray(np.isfinite(values).all(axis=1))
    if values.shape[1] == QUATERNION:
        good &= np.abs(np.linalg.norm(values, axis=1) - 1.0) < UNIT
    elif values.shape[1] == MATRIX:
        good &= np.abs(np.linalg.det(np.nan_to_num(values).reshape(-1, 3, 3)) - 1.0) < UNIT
    return good


def numbers_of(columns: Sequence[Column]) -> Array | None:
    """(N, k), NaN where a cell is blank; None without columns, or where a cell is a word."""
    try:
        cells = [[float(cell or "nan") for cell in column.cells] for column in columns]
    except ValueError:
        return None
    return np.array(cells).T if cells else None
