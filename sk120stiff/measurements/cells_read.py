"""Axes of a displacement that were not read: a dial gauge reads one, a tracker may lose one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from sk120stiff.measurements.data import Measurements

AXES = "xyz"


def refuse_unread(readings: Measurements) -> None:
    """Raise an `InputError` for a row in use without any axis, or an axis without uncertainty."""
    empty = readings.use & ~readings.read.any(axis=1)
    if empty.any():
        raise InputError(
            "no axis of this displacement was read",
            where=_place(readings, int(np.argmax(empty))),
            remedy="Write at least one of dx, dy, dz (with positions: x, y or z in the row and in "
            "its zero reading), or mask the row with a column use that holds 0.",
        )
    if readings.sigma is None:
        return
    lacking = readings.read & np.isnan(readings.sigma) & readings.use[:, None]
    if lacking.any():
        row, axis = (int(k) for k in np.argwhere(lacking)[0])
        raise InputError(
            f"an axis was read whose standard uncertainty s{AXES[axis]} is blank",
            where=_place(readings, row),
            remedy="Write it, or leave the three columns sx, sy, sz out.",
        )


def _place(readings: Measurements, row: int) -> str:
    """File and line of a row; its number where it has none."""
    line = int(readings.line[row]) if len(readings.line) else 0
    place = f"line {line}" if line else f"reading {row + 1}"
    return f"{readings.path}, {place}" if readings.path else place
