"""Gauges that stand still under different loads: stuck, or at the end of their range.

A number that comes again to its last digit at one pose, under loads that differ, is no displacement
of an arm that yields. Axes that hardly move repeat their numbers too, but then the numbers next to
them come as often.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import poisson

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.measurements import Measurements

AGAIN = 4  # times that a number comes again at the pose it was read at, at least
BEYOND_DOUBT = 1e-6  # probability of as many by chance, over all numbers
NEIGHBOURS = 3  # last digits to either side, whose numbers tell how often one comes by chance
ROUNDING = 1e-6  # of a last digit
LISTED = 5  # lines that are told


def without_stuck(measurements: Measurements) -> tuple[Measurements, str | None]:
    """The readings without numbers of gauges that stood still, and the sentence that says so.

    Where one stood at the end of its range, the others of its kind did at the same number.
    """
    gauges = list(_gauges(measurements))
    still = [
        (name, *each)
        for name, rows, values in gauges
        for each in _still(measurements, rows, values)
    ]
    ends = {abs(value) for _, rows, value in still if abs(value) >= _largest(gauges)}
    stuck = [each for each in still if abs(each[2]) not in ends]
    stuck += [
        (name, rows[there], end)
        for name, rows, values in gauges
        for end in ends
        if (there := np.abs(np.abs(values) - end) <= ROUNDING * end).any()
    ]
    told, said = measurements, list[str]()
    for name, rows, value in stuck:
        told = _without(told, name, rows)
        lines = ", ".join(str(measurements.line[row]) for row in rows[:LISTED])
        more = ", …" if len(rows) > LISTED else ""
        read = f"exactly {'±' * (value in ends)}{1e3 * value:.6g} mm in {len(rows)} rows"
        why = "the end of its range" if value in ends else "the gauge seems to have been stuck"
        said.append(f"{name} reads {read}, whatever the load is (lines {lines}{more}): {why}")
    return told, f"{'; '.join(said)}. These numbers are left out." if said else None


def _largest(gauges: Sequence[tuple[str, Index, Array]]) -> float:
    """The largest number that any of them read, but for rounding [m]."""
    largest = max((float(np.abs(values).max(initial=0.0)) for _, _, values in gauges), default=0.0)
    return largest * (1.0 - ROUNDING)


def _gauges(measurements: Measurements) -> Iterator[tuple[str, Index, Array]]:
    """Name, rows (k,) and numbers (k,) of everything that was read along one direction [m]."""
    use = measurements.use
    if measurements.displacement is not None:
        for k, name in enumerate(("dx", "dy", "dz")):
            rows = np.flatnonzero(use & np.isfinite(measurements.displacement[:, k]))
            yield name, rows, measurements.displacement[rows, k]
    said = measurements.absolute
    if said is not None and said.channels.shift is not None and said.channels.along is not None:
        shift, along = said.channels.shift, said.channels.along
        read = np.flatnonzero(use & np.isfinite(shift))
        _, which = np.unique(np.round(along[read], 6), axis=0, return_inverse=True)
        for one in range(int(which.max(initial=-1)) + 1):
            rows = read[which == one]
            yield "d", rows, shift[rows]


def _still(measurements: Measurements, rows: Index, values: Array) -> Iterator[tuple[Index, float]]:
    """Rows with one number, and the number, wherever it comes again too often."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > ROUNDING * np.abs(values).max(initial=0.0)]
    if not len(steps):
        return
    number = np.rint(values / steps.min()).astype(np.int64)
    again = _again(measurements, rows, number)
    by_chance = len(rows) * len(again) / float(np.ptp(number)) ** 2
    near = [step for step in range(-NEIGHBOURS, NEIGHBOURS + 1) if step]
    for candidate, count in again.items():
        beside = max(again.get(candidate + step, 0) for step in near)
        usual = max(float(beside), by_chance, 1.0 / len(rows))
        chance = float(poisson.sf(count - 1, usual)) * len(again)
        if candidate and count >= AGAIN and chance < BEYOND_DOUBT:
            here = number == candidate
            yield rows[here], float(np.median(values[here]))


def _again(measurements: Measurements, rows: Index, number: Index) -> dict[int, int]:
    """How often every number comes again at one pose under another load."""
    out: dict[int, int] = {}
    place = measurements.pose_index[rows]
    for one in np.unique(place):
        here = place == one
        keys = np.column_stack([number[here], np.round(measurements.wrench[rows[here]], 6)])
        for value, count in zip(
            *np.unique(np.unique(keys, axis=0)[:, 0], return_counts=True), strict=True
        ):
            out[int(value)] = out.get(int(value), 0) + int(count) - 1
    return out


def _without(measurements: Measurements, name: str, rows: Index) -> Measurements:
    """The readings with numbers blank; rows that hold nothing any more are masked."""
    lost: Mask = np.zeros(measurements.n_readings, dtype=bool)
    lost[rows] = True
    said = measurements.absolute
    if name == "d" and said is not None and said.channels.shift is not None:
        shift = np.where(lost, np.nan, said.channels.shift)
        channels = replace(said.channels, shift=shift)
        absolute = replace(said, channels=channels)
        return replace(measurements, absolute=absolute, use=measurements.use & channels.filled)
    moved = np.array(measurements.displacement)
    moved[rows, ("dx", "dy", "dz").index(name)] = np.nan
    left = np.isfinite(moved).any(axis=1)
    return replace(measurements, displacement=moved, use=measurements.use & left)
