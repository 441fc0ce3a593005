"""Axes of a displacement that were not read: a dial gauge reads one, a tracker may lose one."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.errors import InputError

AXES = "xyz"


def refuse_unread(
    read: Mask, sigma: Array | None, use: Mask, line: Integers, file: str | None
) -> None:
    """Raise an `InputError` for a row in use without any axis, or an axis without uncertainty.

    Args:
        read: (N, 3) axes that were read.
        sigma: (N, 3) standard uncertainties, NaN where blank, or None.
        use: (N,) rows in use.
        line, file: (N,) line numbers (0: none) and the file, for the message.
    """

    def place(row: int) -> str:
        parts = [file, f"line {line[row]}" if line[row] else f"reading {row + 1}"]
        return ", ".join(part for part in parts if part)

    empty = use & ~read.any(axis=1)
    if empty.any():
        raise InputError(
            "no axis of this displacement was read",
            where=place(int(np.argmax(empty))),
            remedy="Write at least one of dx, dy, dz (with positions: x, y or z in the row and in "
            "its zero reading), or mask the row with a column use that holds 0.",
        )
    if sigma is None:
        return
    lacking = read & np.isnan(sigma) & use[:, None]
    if lacking.any():
        row, axis = (int(k) for k in np.argwhere(lacking)[0])
        raise InputError(
            f"an axis was read whose standard uncertainty s{AXES[axis]} is blank",
            where=place(row),
            remedy="Write it, or leave the three columns sx, sy, sz out.",
        )
