"""Readings of an instrument that moved once, of which a model knows the stations and the file none.

Whoever was told that the tracker moved may not have written it into the file that is held out, or
into the same file when the model is tried on it. It moved from one station to the next and not
back: which rows are of which is a handful of numbers, whatever the rows say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases
from sk120stiff.errors import listed
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.moved import clock_of, parts_of_all
from sk120stiff.model import Model
from sk120stiff.model.pose_reading import read_poses

FEW = 4  # stations of which every order is tried
FAR = 8.0  # times the median distance: rows that do not tell where the tracker stands


@dataclass(frozen=True, eq=False)
class Parts:
    """Readings with the station of each told.

    Attributes:
        readings: They.
        left: Median distance that the model leaves of them [m].
        sentence: Which rows were taken for which station.
    """

    readings: Measurements
    left: float
    sentence: str


def by_stations(
    model: Model, readings: Measurements, stations: Sequence[str], rows: LoadCases, whole: Mask
) -> Parts | None:
    """Each row with the station it was read from, as they leave least one after the other.

    Args:
        model: It knows where the instrument stood.
        readings: They name no station.
        stations: Labels; of a few the order in which they were stood for is found, too.
        rows: Load cases of the whole positions.
        whole: (N,) which these are.
    """
    said = readings.absolute
    if said is None or said.channels.position is None or said.stations is not None:
        return None
    x = said.channels.position[whole]
    off = np.stack([
        np.linalg.norm(x - read_poses(model, _from(rows, label)).position, axis=1)
        for label in stations
    ])  # fmt: skip
    most = FAR * float(np.median(off.min(axis=0)))  # a wild row tells of no station
    squares, when = np.minimum(off, most) ** 2, clock_of(readings)[whole]
    ways = permutations(range(len(stations))) if len(stations) <= FEW else [range(len(stations))]
    tried = ((way, *_one_after_the_other(squares[list(way)], when)) for way in ways)
    way, own, _ = min(tried, key=lambda each: each[2])
    parts = parts_of_all(readings, np.flatnonzero(whole), own)
    labels = tuple(stations[way[k]] for k in parts)
    told = replace(readings, absolute=replace(said, stations=labels))
    median = float(np.median(off[[way[k] for k in own], np.arange(len(x))]))
    return Parts(told, median, _sentence(told, labels))


def _from(rows: LoadCases, label: str) -> LoadCases:
    here = np.zeros(rows.count, dtype=np.intp)
    return replace(rows, station=here, station_names=(label,))


def _one_after_the_other(squares: Array, when: Array) -> tuple[Index, float]:
    """(N,) the station of each row, never one before that of an earlier row, and the least sum."""
    order = np.argsort(when, kind="stable")
    count = squares.shape[0]
    best = np.zeros(count)
    came = np.zeros((len(order), count), dtype=np.intp)
    for at, row in enumerate(order):
        came[at] = [int(np.argmin(best[: k + 1])) for k in range(count)]
        best = best[came[at]] + squares[:, row]
    own = np.zeros(len(order), dtype=np.intp)
    k = int(np.argmin(best))
    for at in range(len(order) - 1, -1, -1):
        own[order[at]] = k
        k = int(came[at, k])
    return own, float(best.min())


def _sentence(readings: Measurements, labels: Sequence[str]) -> str:
    """Which rows were taken for which station."""
    order = np.argsort(clock_of(readings), kind="stable")
    lines: dict[str, list[int]] = {}
    for row in order:
        lines.setdefault(labels[row], []).append(int(readings.line[row]))
    said = [f"lines {own[0]} to {own[-1]} from {label}" for label, own in lines.items()]
    return (
        f"The file names no station, and the model knows several: {listed(said)} are taken for "
        "that, as they fit best one after the other. A column station says otherwise."
    )
