"""Which pair of joints adds to which element of K_C."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sk120stiff.arrays import Array, Integers


def contributions(to_joints: Array, soft: Integers) -> tuple[Integers, Integers, Integers, Array]:
    """The pairs, their stretches, rows and factors of `Fold`.

    Args:
        to_joints: (m, n) factors of the coordinates; ones where they change with the pose.
        soft: (s,) coordinates that yield.
    """
    pairs: list[tuple[int, int]] = []
    ends: list[int] = []
    adds: list[tuple[int, float, int, float, int, int]] = []
    entry = np.cumsum(to_joints != 0.0).reshape(to_joints.shape) - 1
    by, entry = to_joints[:, soft], entry[:, soft]
    for first, second in _joint_pairs(by):
        before = len(adds)
        for i, j, *add in _additions(by[first], by[second], same=first == second):
            adds.append((*add, entry[first, i], entry[second, j]))
        if len(adds) > before:
            pairs.append((first, second))
            ends.append(len(adds))
    table = np.array(adds, dtype=float).reshape(-1, 6)
    pair = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    rows = table[:, [0, 2, 4, 5]].astype(np.int64, order="C")  # one layout, one compilation
    return pair, np.array(ends, dtype=np.int64), rows, table[:, [1, 3]].copy()


def _joint_pairs(to_joints: Array) -> Iterator[tuple[int, int]]:
    moved = np.flatnonzero((to_joints != 0.0).any(axis=1)).tolist()
    return ((first, second) for k, first in enumerate(moved) for second in moved[k:])


def _additions(
    first: Array, second: Array, *, same: bool
) -> Iterator[tuple[int, int, int, float, int, float]]:
    """Aᵀ K A for one symmetric pair of elements of K: i, j, row, factor, skew row, skew factor."""
    for i in np.flatnonzero(first).tolist():
        for j in np.flatnonzero(second).tolist():
            value = float(first[i] * second[j])
            high, low = max(i, j), min(i, j)
            row = high * (high + 1) // 2 + low
            if same:
                if i >= j:
                    yield i, j, row, value, -1, 0.0
            elif i == j:
                yield i, j, row, 2.0 * value, -1, 0.0
            else:
                skew = high * (high - 1) // 2 + low
                # K[second, first] carries + half of the moment's part, K[first, second] minus that.
                yield i, j, row, value, skew, value if j > i else -value
