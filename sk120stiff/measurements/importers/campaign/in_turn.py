"""Markers that were read one after the other at every pose, and the joints once.

A rigid tool shows it: rows as many apart keep their distances from pose to pose.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.told import numbers

MOST = 12  # markers of a tool
FEWEST = 3  # poses, from which on distances that stay alike are no chance
ALIKE = 0.05  # of a distance between markers, by which it may differ from pose to pose (median)


def in_turn(points: Sheet, poses: int) -> Sheet | None:
    """The points with a column that tells their markers apart; None where nothing shows any.

    Args:
        points: Without a column of markers, `poses` times as many rows as there are markers.
        poses: How many rows of joints there are.
    """
    count, rest = divmod(points.total, max(poses, 1))
    if rest or not 2 <= count <= MOST or poses < FEWEST or points.get("marker") is not None:
        return None
    x = _positions(points)
    if x is None or points.rank != tuple(range(points.total)):
        return None
    groups = x.reshape(poses, count, 3)
    pairs = [groups[:, i] - groups[:, j] for i, j in combinations(range(count), 2)]
    apart = np.linalg.norm(pairs, axis=2)
    usual = np.median(apart, axis=1)
    if not (np.median(np.abs(apart - usual[:, None]), axis=1) < ALIKE * usual).all():
        return None
    off = np.abs(groups - np.median(groups, axis=1, keepdims=True)).max()
    if np.linalg.norm(np.diff(groups[:, 0], axis=0), axis=1).max() <= off:
        return None  # the tool did not move: nothing tells poses from markers
    names = tuple(f"M{k % count + 1}" for k in range(points.total))
    said = (
        f"{points.total} points and {poses} rows of joints: {count} markers at every pose, read "
        f"one after the other (M1 to M{count}); they keep their distances from pose to pose."
    )
    column = Column("(row)", "marker", None, "", names)
    return replace(points, columns=(*points.columns, column), notes=(*points.notes, said))


def _positions(points: Sheet) -> Array | None:
    columns = [points.get(axis) for axis in "xyz"]
    if any(column is None for column in columns):
        return None
    try:
        found = [numbers(points, column) for column in columns if column is not None]
    except InputError:
        return None
    x = np.column_stack(found)
    return x if np.isfinite(x).all() else None
