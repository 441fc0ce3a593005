"""Columns and settings of positions, single readings and plans of them, as they are read back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.noise_statement import Instrument
from sk120stiff.measurements.table.columns import (
    ANCHORS,
    DIRECTIONS,
    DISPLACEMENTS,
    FORCES,
    LEVELS,
    MOMENTS,
    POSITIONS,
    ROTATION_VECTOR,
    TURNS,
    UNCERTAINTIES,
)
from sk120stiff.robot.rotations import rotation_vector

Written = Iterable[tuple[str, Iterable[str]]]


def columns_of_positions(m: Measurements, said: Absolute, angle: str, length: str) -> Written:
    """Headers with units, and cells; what was not read is a blank cell."""
    yield "pose", m.pose
    for k, name in enumerate(m.joint_names):
        if name not in m.spare:
            kind = m.joint_kinds[k]
            yield _column(name, m.joints[:, k], angle if kind == "angle" else length, kind)
    if m.wrench.any():
        yield from _columns(FORCES, m.wrench[:, :3], "N", "force")
    if m.wrench[:, 3:].any():
        yield from _columns(MOMENTS, m.wrench[:, 3:], "N*m", "moment")
    if said.payload.any():
        yield "payload[kg]", map(_digits, said.payload)
    if any(said.markers):
        yield "marker", said.markers
    if said.series is not None:
        yield "series", said.series
    if said.stations is not None:
        yield "station", said.stations
    yield from _channels(said.channels, length)
    if said.temperature is not None:
        yield "temperature[degC]", map(_digits, said.temperature)
    for header, values in (("order", m.order), ("time[s]", m.time)):
        if values is not None:
            yield header, map(_digits, values)
    if m.branch is not None:
        yield "branch", m.branch
    if m.repeat is not None:
        yield "repeat", map(str, m.repeat)
    if not m.use.all() and not m.is_plan:
        yield "use", ("1" if used else "0" for used in m.use)
    yield from m.extra.items()


def _channels(read: Channels, length: str) -> Written:
    if read.position is not None:
        yield from _columns(POSITIONS, read.position, length, "length")
    if read.displacement is not None:
        yield from _columns(DISPLACEMENTS, read.displacement, length, "length")
    if read.sigma_of_rows is not None and read.rays is None:
        yield from _columns(UNCERTAINTIES, read.sigma_of_rows, length, "length")
    if read.rotation is not None:
        known = np.array([np.isfinite(turn).all() for turn in read.rotation])
        turns = np.full((len(known), 3), np.nan)
        turns[known] = rotation_vector(read.rotation[known])
        yield from _columns(ROTATION_VECTOR, turns, "rad", "angle")
    if read.turn is not None:
        yield from _columns(TURNS, read.turn, "mrad", "angle")
    if read.distance is not None and read.anchor is not None:
        yield _column("l", read.distance, length, "length")
        yield from _columns(ANCHORS, read.anchor, "m", "length")
    if read.shift is not None and read.along is not None:
        yield _column("d", read.shift, length, "length")
        yield from _bare(DIRECTIONS, read.along)
    if read.inclination is not None and read.level is not None:
        yield _column("inc", read.inclination, "deg", "angle")
        yield from _bare(LEVELS, read.level)


def settings_of_positions(m: Measurements, said: Absolute, length: str) -> dict[str, Any]:
    """Keys of the YAML file beside frames, source and gravity."""
    settings: dict[str, Any] = {"position": {"frame": said.frame}}
    if said.channels.rotation is not None:
        settings["rotation"] = {"axes": "target" if said.fit_axes else "tool"}
    fit = {"fit": True} if said.fit_point else {}
    places = {name: said.point[said.markers.index(name)] for name in dict.fromkeys(said.markers)}
    same = bool((said.point == said.point[0]).all())
    if not same:
        settings["points"] = {n: {**_point(at, length), **fit} for n, at in places.items()}
    else:
        settings["point"] = {**_point(said.point[0], length), **fit}
    hung: dict[str, Any] = (
        {"point": _point(said.payload_point, length)} if said.payload_placed else {}
    )
    hung |= {"fit": True} if said.fit_payload else {}
    settings |= {"payload": hung} if hung else {}
    if m.wrench.any():
        settings["force"] = {"frame": m.force_frame}
        if not np.array_equal(m.force_point, m.point):
            settings["force"]["point"] = _point(m.force_point, length)
    stated = said.channels.sigma
    size, turn = stated.get("position"), stated.get("rotation")
    noise: dict[str, Any] = {}
    if size is not None:
        noise |= {"sigma": float(f"{1e6 * size:.12g}"), "unit": "um"}
        since_zero = max(stated.get(kind, size) for kind in ("shift", "displacement"))
        if since_zero > size:  # two readings of the gauge
            settings["displacement"] = {"frame": m.displacement_frame, "zero": "separate"}
    if m.noise.instrument is not None:
        noise = _of_instrument(m.noise.instrument, said.frame == "unknown")
    if turn is not None:
        noise |= {"rotation": float(f"{1e6 * turn:.12g}"), "rotation_unit": "urad"}
    if "displacement" not in settings and m.displacement_frame != "base":
        settings["displacement"] = {"frame": m.displacement_frame}
    return settings | ({"noise": noise} if noise else {})


def _of_instrument(instrument: Instrument, at_origin: bool) -> dict[str, Any]:
    """The entry `noise` of what is sharper along its ray."""
    sizes = ("along", "across", "along_per_m", "across_per_m")
    told = {name: float(f"{1e6 * getattr(instrument, name):.12g}") for name in sizes}
    place = {} if at_origin else {"xyz": list(map(float, instrument.place)), "unit": "m"}
    return {"unit": "um", "instrument": {**place, **{k: v for k, v in told.items() if v}}}


def _point(xyz: ArrayLike, length: str) -> dict[str, Any]:
    shown = units.from_si(xyz, length, "length")
    return {"xyz": [float(f"{x:.15g}") + 0.0 for x in shown], "unit": length}


def _columns(names: tuple[str, ...], values: Array, unit: str, kind: str) -> Written:
    for k, name in enumerate(names):
        yield _column(name, values[:, k], unit, kind)


def _bare(names: tuple[str, ...], values: Array) -> Written:
    for k, name in enumerate(names):
        yield name, map(_digits, values[:, k])


def _column(name: str, values: ArrayLike, unit: str, kind: str) -> tuple[str, Iterable[str]]:
    numbers = np.array(values, dtype=np.float64)
    known = np.isfinite(numbers)  # else it was not read
    numbers[known] = units.from_si(numbers[known], unit, kind)
    return f"{name}[{unit}]", map(_digits, numbers)


def _digits(value: float) -> str:
    """Fifteen digits, without the rounding of a unit; NaN is an empty cell."""
    return "" if np.isnan(value) else f"{value + 0.0:.15g}"
