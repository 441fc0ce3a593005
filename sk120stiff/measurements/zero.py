"""Positions become displacements: which zero reading a row subtracts, and of how many it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.measurements.poses import rows_by_label


@dataclass(frozen=True)
class ZeroReadings:
    """The zero readings of a file of positions.

    Args:
        group: (N,) number of the zero reading of each row, loaded or not.
        counted: (N,) the rows without load that a zero reading is the mean of.
        count: (N,) how many rows are counted in the row's group; 0 where there is no zero reading.
    """

    group: Integers
    counted: Mask
    count: Integers

    def mean(self, values: Array) -> Array:
        """Mean of `values` (N, ...) over the zero rows of each row's group; NaN without any."""
        sums = np.zeros((int(self.group.max()) + 1, *values.shape[1:]))
        np.add.at(sums, self.group[self.counted], values[self.counted])
        count = np.where(self.count > 0, self.count, np.nan)
        mean: Array = sums[self.group] / count.reshape(-1, *(1,) * (values.ndim - 1))
        return mean


def find_zero_readings(
    group: Integers, loaded: Mask, use: Mask, axes: Integers | None = None
) -> ZeroReadings:
    """Count the rows without load in each group (N,).

    Masked rows do not count, except where every row of the group is masked: then its masked
    zero rows give the masked rows a displacement to show. Of `axes` (N,) were read in each row;
    rows that lack one which others of the group have do not count either.
    """
    size = int(group.max()) + 1
    alive = np.bincount(group[use], minlength=size) > 0
    counted = ~loaded & (use | ~alive[group])
    if axes is not None:
        most = np.zeros(size, dtype=np.int64)
        np.maximum.at(most, group[counted], axes[counted])
        counted &= axes == most[group]
    count = np.bincount(group[counted], minlength=size)
    return ZeroReadings(group, counted, count[group].astype(np.int64))


def group_by_run(pose: Integers, loaded: Mask, use: Mask, sequence: Array) -> Integers:
    """Groups (N,) where each row subtracts the zero reading that was taken last before it.

    Zero rows that follow one another without a loaded row between are one reading. Rows before
    the first zero reading of their pose subtract that first one.
    """
    group = np.zeros(len(pose), dtype=np.int64)
    start = 0
    for rows in rows_by_label(pose):
        rows = rows[np.argsort(sequence[rows], kind="stable")]
        runs, after_load = 0, True
        for row in rows:
            is_zero = not loaded[row] and use[row]
            if is_zero and after_load:
                runs += 1
            if is_zero or loaded[row]:
                after_load = not is_zero
            group[row] = start + max(runs, 1) - 1
        start += max(runs, 1)
    return group


def since_zero(clock: Array, zero: Array | None, group: Integers) -> Array:
    """(N,) clock (order, or time) of each row minus that of the zero reading it subtracts.

    Where the file does not tell when the zero was read (`zero` None or NaN), it is taken to be one
    typical interval before the first row of its `group`.
    """
    steps = np.diff(np.sort(clock))
    interval = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 1.0
    _, index = np.unique(group, return_inverse=True)
    first = np.full(index.max() + 1, np.inf)
    np.minimum.at(first, index, clock)
    known = np.full(len(clock), np.nan) if zero is None else zero
    since: Array = clock - np.where(np.isnan(known), first[index] - interval, known)
    return since


def of_one_reading(sigma: Array, zero_count: Integers) -> Array:
    """(N, 3) standard uncertainty of a loaded reading, from that of the displacement (N, 3).

    A displacement is the difference of it and the mean of `zero_count` (N,) others.
    """
    return np.asarray(sigma / np.sqrt(1.0 + 1.0 / zero_count[:, None]))


def of_displacement(sigma: Array, zero_count: Integers) -> Array:
    """(N, 3) standard uncertainty of a displacement: what `of_one_reading` takes back to `sigma`.

    To the last bit where there is such a number, as for all that came from a file; else within one
    rounding. Of several the smallest, so that a second writing gives the same.
    """
    near = sigma * np.sqrt(1.0 + 1.0 / zero_count[:, None])
    near = near + np.spacing(near) * np.arange(-2.0, 3.0)[:, None, None]
    back = np.array([of_one_reading(each, zero_count) for each in near])
    exact = (back == sigma).any(axis=0)
    reached = back == np.where(exact, sigma, back[2])
    return np.asarray(np.take_along_axis(near, reached.argmax(axis=0)[None], axis=0)[0])
