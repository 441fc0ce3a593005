"""Columns and settings of positions, single readings and plans of them, as they are read back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.files.entries import (
    Column,
    bare,
    column,
    columns,
    digits,
    instrument_entry,
    length_entry,
    point_entry,
)
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


def columns_of_positions(
    m: Measurements, said: Absolute, angle: str, length: str
) -> Iterable[Column]:
    """Headers with units, and cells; what was not read is a blank cell."""
    yield "pose", m.pose
    for k, name in enumerate(m.joint_names):
        if name not in m.spare:
            kind = m.joint_kinds[k]
            yield column(name, m.joints[:, k], angle if kind == "angle" else length, kind)
    if m.wrench.any():
        yield from columns(FORCES, m.wrench[:, :3], "N", "force")
    if m.wrench[:, 3:].any():
        yield from columns(MOMENTS, m.wrench[:, 3:], "N*m", "moment")
    if said.payload.any():
        yield "payload[kg]", map(digits, said.payload)
    if any(said.markers):
        yield "marker", said.markers
    if said.series is not None:
        yield "series", said.series
    if said.stations is not None:
        yield "station", said.stations
    yield from _channels(said.channels, length)
    if said.temperature is not None:
        yield "temperature[degC]", map(digits, said.temperature)
    for header, values in (("order", m.order), ("time[s]", m.time)):
        if values is not None:
            yield header, map(digits, values)
    if m.branch is not None:
        yield "branch", m.branch
    if m.repeat is not None:
        yield "repeat", map(str, m.repeat)
    if not m.use.all() and not m.is_plan:
        yield "use", ("1" if used else "0" for used in m.use)
    yield from m.extra.items()


def _channels(read: Channels, length: str) -> Iterable[Column]:
    if read.position is not None:
        yield from columns(POSITIONS, read.position, length, "length")
    if read.displacement is not None:
        yield from columns(DISPLACEMENTS, read.displacement, length, "length")
    if read.sigma_of_rows is not None and read.rays is None:
        yield from columns(UNCERTAINTIES, read.sigma_of_rows, length, "length")
    if read.rotation is not None:
        known = np.array([np.isfinite(turn).all() for turn in read.rotation])
        turns = np.full((len(known), 3), np.nan)
        turns[known] = rotation_vector(read.rotation[known])
        yield from columns(ROTATION_VECTOR, turns, "rad", "angle")
    if read.turn is not None:
        yield from columns(TURNS, read.turn, "mrad", "angle")
    if read.distance is not None and read.anchor is not None:
        yield column("l", read.distance, length, "length")
        yield from columns(ANCHORS, read.anchor, "m", "length")
    if read.shift is not None and read.along is not None:
        yield column("d", read.shift, length, "length")
        yield from bare(DIRECTIONS, read.along)
    if read.inclination is not None and read.level is not None:
        yield column("inc", read.inclination, "deg", "angle")
        yield from bare(LEVELS, read.level)


def settings_of_positions(m: Measurements, said: Absolute, length: str) -> dict[str, Any]:
    """Keys of the YAML file beside frames, source and gravity."""
    settings: dict[str, Any] = {"position": {"frame": said.frame}}
    if said.channels.rotation is not None:
        settings["rotation"] = {"axes": "target" if said.fit_axes else "tool"}
    fit = {"fit": True} if said.fit_point else {}
    places = {name: said.point[said.markers.index(name)] for name in dict.fromkeys(said.markers)}
    same = bool((said.point == said.point[0]).all())
    if not same:
        settings["points"] = {n: {**point_entry(at, length), **fit} for n, at in places.items()}
    else:
        settings["point"] = {**point_entry(said.point[0], length), **fit}
    hung: dict[str, Any] = (
        {"point": point_entry(said.payload_point, length)} if said.payload_placed else {}
    )
    hung |= {"fit": True} if said.fit_payload else {}
    settings |= {"payload": hung} if hung else {}
    if m.wrench.any():
        settings["force"] = {"frame": m.force_frame}
        if not np.array_equal(m.force_point, m.point):
            settings["force"]["point"] = point_entry(m.force_point, length)
    stated = said.channels.sigma
    size, turn = stated.get("position"), stated.get("rotation")
    noise: dict[str, Any] = {}
    if size is not None:
        noise |= {"sigma": length_entry(size, "um"), "unit": "um"}
        since_zero = max(stated.get(kind, size) for kind in ("shift", "displacement"))
        if since_zero > size:  # two readings of the gauge
            settings["displacement"] = {"frame": m.displacement_frame, "zero": "separate"}
    if m.noise.instrument is not None:
        place = {} if said.frame == "unknown" else point_entry(m.noise.instrument.place, "m")
        noise = {
            "unit": "um",
            "instrument": {**place, **instrument_entry(m.noise.instrument, "um")},
        }
    if turn is not None:
        noise |= {"rotation": float(f"{1e6 * turn:.12g}"), "rotation_unit": "urad"}
    if "displacement" not in settings and m.displacement_frame != "base":
        settings["displacement"] = {"frame": m.displacement_frame}
    return settings | ({"noise": noise} if noise else {})
