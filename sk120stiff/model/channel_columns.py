"""Columns of predictions beside what each kind of channel read: turns, gauges, wires, levels."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.directions import of_columns
from sk120stiff.robot.rotations import rotation_vector

AXES = "xyz"


def vectors_read(readings: Measurements) -> Array | None:
    """(N, 3) displacements as read, else positions [m]; None where neither was, or by gauges."""
    if readings.absolute is None:
        return readings.displacement if readings.directions is None else None
    channels = readings.absolute.channels
    return channels.position if channels.displacement is None else channels.displacement


def of_turns(
    readings: Measurements, turned: Array | None, rotation: Array | None
) -> dict[str, Array]:
    """Rotation vectors of the axes that are read, axes of the instrument; nothing where none was.

    The gap is the rotation from the predicted axes to those that were read. Of what a load turned
    both are those of the turns.
    """
    turn = None if readings.absolute is None else readings.absolute.channels.turn
    if turn is not None and turned is not None:
        said, gap = turned, turn - turned
        return {f"predicted_dr{axis}[mrad]": said[:, k] * 1e3 for k, axis in enumerate(AXES)} | {
            f"gap_dr{axis}[urad]": gap[:, k] * 1e6 for k, axis in enumerate(AXES)
        }
    read = None if readings.absolute is None else readings.absolute.channels.rotation
    if read is None or rotation is None:
        return {}
    said, gap = rotation_vector(rotation), np.full((len(read), 3), np.nan)
    known = np.isfinite(read).all(axis=(1, 2)) & np.isfinite(said).all(axis=1)
    gap[known] = rotation_vector(read[known] @ np.swapaxes(rotation[known], 1, 2))
    return {f"predicted_r{axis}[rad]": said[:, k] for k, axis in enumerate(AXES)} | {
        f"gap_r{axis}[urad]": gap[:, k] * 1e6 for k, axis in enumerate(AXES)
    }


def gauges_of(readings: Measurements) -> tuple[Array | None, Array | None]:
    """(N,) what gauges read [m] and (N, 3) along which directions; None where none did."""
    if readings.directions is not None and readings.displacement is not None:
        return of_columns(readings.directions, readings.displacement), readings.directions
    channels = None if readings.absolute is None else readings.absolute.channels
    return (None, None) if channels is None else (channels.shift, channels.along)


def of_gauges(readings: Measurements, moved: Array) -> dict[str, Array]:
    """Displacement (N, 3) and reading along the directions of gauges; nothing where none was read.

    Cells of rows that no gauge read are empty.
    """
    read, directions = gauges_of(readings)
    if read is None or directions is None:
        return {}
    d, along = read, np.einsum("ni,ni->n", directions, moved)
    said = np.where(np.isfinite(d), along, np.nan)
    return {"predicted_d[mm]": said * 1e3, "d[mm]": d * 1e3, "gap_d[um]": (d - along) * 1e6}


def of_wires_and_levels(
    readings: Measurements, position: Array | None, leans: Array | None
) -> dict[str, Array]:
    """Lengths to fixed points, and inclinations; nothing of what was not read."""
    channels = None if readings.absolute is None else readings.absolute.channels
    out: dict[str, Array] = {}
    if channels is None or position is None:
        return out
    if channels.distance is not None and channels.anchor is not None:
        read, said = channels.distance, np.linalg.norm(position - channels.anchor, axis=1)
        out |= {
            "predicted_l[mm]": said * 1e3,
            "l[mm]": read * 1e3,
            "gap_l[um]": (read - said) * 1e6,
        }
    if channels.inclination is not None and leans is not None:
        read, said = channels.inclination, leans
        told = {"predicted_inc[deg]": np.degrees(said), "inc[deg]": np.degrees(read)}
        out |= told | {"gap_inc[urad]": (read - said) * 1e6}
    return out
