"""Joint columns that look like radians among columns in degrees, or the other way round."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Index, Mask

HALF_TURN = np.pi  # rad; few joints go beyond it, and in degrees one that moves does
MOVED = 1.0  # as written, from the smallest to the largest: less is a joint that was held
FAR = 10.0 * np.pi  # as written, of another column: degrees beyond doubt


def like_radians(a: Array, turning: Mask) -> Index:
    """Columns that stay within ±pi as degrees and move there, beside others that go far beyond.

    Args:
        a: (N, n) joint values as degrees were understood [rad].
        turning: (n,) joints that turn.
    """
    degrees = np.degrees(a)
    largest, moved = np.abs(degrees).max(axis=0), np.ptp(degrees, axis=0)
    few = turning & (largest <= HALF_TURN) & (moved >= MOVED)
    return np.flatnonzero(few if (turning & (largest > FAR)).any() else few & False)


def like_degrees(a: Array, turning: Mask) -> Index:
    """Columns that go far beyond a turn as radians, beside others that do not.

    Args:
        a: (N, n) joint values as radians were understood [rad].
        turning: (n,) joints that turn.
    """
    far = turning & (np.abs(a).max(axis=0) > FAR)
    return np.flatnonzero(far if (turning & ~far).any() else far & False)


def mixed(a: Array, turning: Mask) -> list[tuple[Index, float, str, str]]:
    """Columns in another unit than the others: which, the factor, the unit meant and as written."""
    found = (
        (like_radians(a, turning), 180.0 / np.pi, "rad", "deg"),
        (like_degrees(a, turning), np.pi / 180.0, "deg", "rad"),
    )
    return [each for each in found if len(each[0])]
