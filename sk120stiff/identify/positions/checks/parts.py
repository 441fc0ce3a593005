"""Readings of an instrument that moved once, of which a model knows the stations and the file none.

Whoever was told that the tracker moved may not have written it into the file that is held out, or
into the same file when the model is tried on it. It moved from one station to the next and not
back: which rows are of which is a handful of numbers, whatever the rows say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases
from sk120stiff.errors import listed
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.model.pose_reading import read_poses

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
        stations: Labels, in the order in which they were stood for.
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
    order = readings.order if readings.order is not None else readings.time
    clock = np.arange(float(readings.n_readings)) if order is None else order
    most = FAR * float(np.median(off.min(axis=0)))  # a wild row tells of no station
    own = _one_after_the_other(np.minimum(off, most) ** 2, clock[whole])
    later = [clock[whole][own >= k] for k in range(1, len(stations))]
    starts = [float(own.min(initial=np.inf)) for own in later]
    median = float(np.median(off[own, np.arange(len(x))]))
    parts = np.searchsorted(starts, clock, side="right")
    labels = tuple(stations[k] for k in parts)
    told = replace(readings, absolute=replace(said, stations=labels))
    return Parts(told, median, _sentence(readings, stations, parts, clock))


def _from(rows: LoadCases, label: str) -> LoadCases:
    here = np.zeros(rows.count, dtype=np.intp)
    return replace(rows, station=here, station_names=(label,))


def _one_after_the_other(squares: Array, clock: Array) -> Index:
    """(N,) the station of each row, never one before that of an earlier row: the least sum."""
    order = np.argsort(clock, kind="stable")
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
    return own


def _sentence(readings: Measurements, stations: Sequence[str], own: Index, clock: Array) -> str:
    """Which rows were taken for which station."""
    order = np.argsort(clock, kind="stable")
    said = []
    for k in np.unique(own):
        rows = order[own[order] == k]
        line = readings.line[rows]
        said.append(f"lines {line[0]} to {line[-1]} from {stations[k]}")
    return (
        f"The file names no station, and the model knows several: {listed(said)} are taken for "
        "that, as they fit best one after the other. A column station says otherwise."
    )
