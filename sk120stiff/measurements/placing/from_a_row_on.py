"""Positions that belong to another place of the tracker, or to other rows, from a row on."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.moved import MovedBetween, labelled
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.slips import moved_at, shifted_at

SHIFTS = (1, -1, 2, -2)  # rows by which positions may be off their joints


def refuse_from_a_row_on(
    cloud: Cloud, told: str, least: float, readings: Measurements, rows: Index
) -> None:
    """Refuse positions of a tracker that moved once, or that stand in other rows from one on.

    Args:
        cloud: The positions, of these `rows` of the readings.
        told: What is left of them without.
        least: What must be left with it at most [m].
        readings, rows: Where they come from.

    Raises:
        MovedBetween: The tracker did.
        InputError: They stand in other rows.
    """
    line, moved = readings.line[rows], None
    said = readings.absolute
    if said is not None and said.frame == "unknown" and said.stations is None:
        moved = moved_at(cloud)
    if moved is not None and moved[0] < least:
        rms, row = moved
        part = (np.arange(readings.n_readings) >= rows[row]).astype(np.intp)
        raise MovedBetween(
            f"{told}. The tracker looks moved between lines {line[row - 1]} and {line[row]}: with "
            f"another frame from there on {1e3 * rms:.3g} mm are left",
            where=readings.place,
            remedy="Add a column station with one label up to there and another from there on.",
            apart=labelled(readings, "station", part),
            taken="Taken so here: a frame of its own for each part of the campaign.",
        )
    for by in SHIFTS:
        shifted = shifted_at(cloud, by)
        if shifted is None or shifted[0] >= least:
            continue
        rms, row = shifted
        first = max(row, -by)
        position, joints = line[first], line[min(first + by, len(line) - 1)]
        apart = max(abs(int(joints - position)), 1)  # other rows may lie between
        raise InputError(
            f"{told}. From line {line[row]} on positions and joints look {apart} row"
            f"{'s' * (apart > 1)} apart: with the position of line {position} at the joints of "
            f"line {joints}, and so on, {1e3 * rms:.3g} mm are left",
            where=readings.place,
            remedy="Put the rows right: one of them lacks its partner.",
        )
