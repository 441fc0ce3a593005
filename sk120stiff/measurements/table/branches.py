"""Loading and unloading where no column says so, from the order in which loads were applied."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.measurements.poses import rows_by_label

SAME = 0.03  # share of the largest load within which a load is met again
ONE_WAY = 0.999  # cosine of the angle between two loads of one direction, at least
TOLD = "the loads rise and then fall again"


def branches_by_order(
    pose: Integers, wrench: Array, sequence: Array
) -> tuple[tuple[str, ...], str] | None:
    """``load`` and ``unload`` for every row, and a sentence; None where the order tells nothing.

    A pose tells branches if its loads, along one line, rise to a peak and fall from it, and at
    least one on the way down was met on the way up; so must the loads of every direction where a
    pose was loaded in several, one after the other, and each time where it was loaded again and
    again. Most poses with three loads or more have to.

    Args:
        pose: (N,) number of the pose of each row.
        wrench: (N, 6) loads; rows without load count for nothing.
        sequence: (N,) order or time of the rows, or their place in the file.
    """
    size = np.linalg.norm(wrench[:, :3], axis=1)
    falling = np.zeros(len(pose), dtype=bool)
    told, able = 0, 0
    loaded = np.flatnonzero(size > 0.0)
    loaded = loaded[np.argsort(sequence[loaded], kind="stable")]
    for own in rows_by_label(pose[loaded]):
        rows = loaded[own]
        if len(rows) < 3:
            continue
        able += 1
        down = _ways_down(wrench[rows, :3], size[rows])
        told += down is not None
        if down is not None:
            falling[rows[down]] = True
    if 2 * told <= able:
        return None
    words = tuple("unload" if falls else "load" for falls in falling)
    return words, (
        f"At {told} of {able} poses {TOLD} in the order of the rows; they are taken as loading "
        "and unloading. Add a column 'branch' with load or unload to say it yourself."
    )


def branches_of(
    written: tuple[str, ...] | None, pose: Integers, wrench: Array, sequence: Array
) -> tuple[tuple[str, ...] | None, str | None]:
    """Loading or unloading as written, else as the order tells; and what was taken for granted."""
    found = branches_by_order(pose, wrench, sequence) if written is None else None
    return (written, None) if found is None else found


def _ways_down(force: Array, size: Array) -> Mask | None:
    """(k,) the rows of one pose that follow the peak of their direction; None without a way."""
    alone = _way_down(force, size)
    if alone is not None:
        return alone
    unit = force / size[:, None]
    turns = np.flatnonzero((unit[1:] * unit[:-1]).sum(axis=1) < ONE_WAY) + 1
    runs = [
        run
        for rows in np.split(np.arange(len(size)), turns)
        for run in np.split(rows, _new_rises(size[rows]))
    ]
    ways = [None if len(rows) < 3 else _way_down(force[rows], size[rows]) for rows in runs]
    if any(way is None for way in ways):
        return None
    return np.concatenate([way for way in ways if way is not None])


def _new_rises(size: Array) -> list[int]:
    """Rows of loads along one line with which they begin to rise anew after a fall.

    Of equal ones at the foot the last begins the rise: it was put on after the load was off.
    """
    slack = SAME * size.max()
    starts, falling = list[int](), False
    for row in range(1, len(size)):
        step = size[row] - size[row - 1]
        if step < -slack:
            falling = True
        elif step > slack and falling:
            again = row >= 2 and abs(size[row - 1] - size[row - 2]) <= slack
            starts.append(row - 1 if again else row)
            falling = False
    return starts


def _way_down(force: Array, size: Array) -> Mask | None:
    """(k,) the rows of one pose, in their order, that follow the peak; None without such a way."""
    slack = SAME * size.max()
    peak = int(np.argmax(size >= size.max() - slack))
    steps = np.diff(size)
    if (steps[:peak] < -slack).any() or (steps[peak:] > slack).any():
        return None
    along = force @ force[peak] / size[peak]
    if (np.abs(size - along) > slack).any():
        return None
    down = np.zeros(len(size), dtype=bool)
    down[peak + 1 :] = size[peak + 1 :] < size.max() - slack
    met = np.abs(size[down][:, None] - size[: peak + 1]).min(axis=1, initial=np.inf) <= slack
    return down if met.any() else None
