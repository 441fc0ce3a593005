"""Readings of where a marker stands, with what the file says of frames, markers and payload."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff import units
from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError, warn
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.table.columns import (
    ANCHORS,
    DIRECTIONS,
    DISPLACEMENTS,
    LEVELS,
    POSITIONS,
    QUATERNION,
    ROTATION_VECTOR,
    TURNS,
    UNCERTAINTIES,
    Roles,
)
from sk120stiff.measurements.table.table import Table

if TYPE_CHECKING:
    from sk120stiff.measurements.table.settings import SettingsFile

STEEP = np.radians(85.0)  # an inclination beyond tells nothing more
SAME_POSE = 1e-3  # rad or m: encoder values of one pose that differ by less are of one pose


@dataclass(frozen=True, eq=False)
class Absolute:
    """What N rows say of where markers stand.

    Attributes:
        channels: The readings themselves.
        frame: ``"base"``, or ``"unknown"``: the instrument's own axes, registered by the fit.
        point: (N, 3) marker of each row in the tool frame as stated [m].
        fit_point: The marker's place is known only roughly.
        fit_axes: The axes whose rotation is read are those of a target, and how it is turned on the
            tool is not known.
        markers: N names of markers.
        payload, payload_point, fit_payload: (N,) mass [kg] on the tool, (3,) where it hangs in the
            tool frame [m], and whether mass and centre are in doubt.
        payload_placed: The file says where it hangs; else it is taken to at the tool's origin.
        temperature: (N,) [degC], or None.
        series: N labels of what may have changed in between, or None.
        stations: N labels of where the instrument stood, or None.
        zero: How the zero readings of gauges are shared, as stated.
        found: Which of ``station`` and ``series`` no file states: they were found (`moved.py`).
    """

    channels: Channels
    frame: Literal["base", "unknown"]
    point: Array
    fit_point: bool
    markers: tuple[str, ...]
    payload: Array
    payload_point: Array = field(default_factory=lambda: np.zeros(3))
    fit_payload: bool = False
    payload_placed: bool = True
    temperature: Array | None = None
    series: tuple[str, ...] | None = None
    fit_axes: bool = False
    stations: tuple[str, ...] | None = None
    zero: Literal["shared", "separate", "unknown"] = "unknown"
    found: tuple[str, ...] = ()

    def select(self, index: Index) -> Absolute:
        """Some of the rows."""

        def cut(labels: tuple[str, ...] | None) -> tuple[str, ...] | None:
            return None if labels is None else tuple(labels[i] for i in index)

        return dataclasses.replace(
            self,
            channels=self.channels.select(index),
            point=self.point[index],
            markers=cut(self.markers) or (),
            payload=self.payload[index],
            temperature=None if self.temperature is None else self.temperature[index],
            series=cut(self.series),
            stations=cut(self.stations),
        )

    @property
    def stated_stations(self) -> tuple[str, ...] | None:
        """`stations`, where the file states them."""
        return None if "station" in self.found else self.stations

    @property
    def stated_series(self) -> tuple[str, ...] | None:
        """`series`, where the file states them."""
        return None if "series" in self.found else self.series

    @property
    def payload_differs(self) -> bool:
        """More than one mass: that they hang elsewhere is no moment that stays the same."""
        return len(set(self.payload)) > 1

    @property
    def groups(self) -> tuple[str, ...] | None:
        """N labels of series and markers whose places may differ; None where all is one.

        Markers whose places are known need no group of their own.
        """
        apart = self.markers if self.fit_point and len(set(self.markers)) > 1 else None
        if self.series is None or apart is None:
            return self.series or apart
        return tuple(f"{a}/{b}" for a, b in zip(self.series, apart, strict=True))

    @property
    def stood(self) -> tuple[tuple[str, ...], Index]:
        """Labels of the places that the instrument stood at with axes of its own, and (N,) which.

        One without a label where no column tells of any, or where all axes are those of the base.
        """
        if self.stations is None or self.frame == "base":
            return ("",), np.zeros(len(self.point), dtype=np.intp)
        names = tuple(dict.fromkeys(self.stations))
        return names, np.array([names.index(label) for label in self.stations])


def is_absolute(file: SettingsFile, roles: Roles, loaded: bool, unlike: bool) -> bool:
    """Are these positions to be predicted as such, not as differences to a zero reading?

    So are those with a load that have blank cells, where poses lack a zero reading (`unlike`).
    """
    settings = file.settings
    point = settings.point is not None and settings.point.fit
    told = settings.position is not None and settings.position.frame == "unknown"
    if roles.absolute or told or point or settings.points or settings.payload:
        return True
    return roles.measured == POSITIONS and (not loaded or unlike)


def read_absolute(table: Table, roles: Roles, file: SettingsFile) -> Absolute:
    """Channels and what stands beside them.

    Raises:
        InputError: A group of columns in part, an unknown marker, a direction that is none.
    """
    settings, count = file.settings, len(table.lines)
    channels = _channels(table, roles, file)
    markers = table.cells["marker"] if "marker" in roles.has else ("",) * count
    fit_point = settings.point is not None and settings.point.fit
    point = np.zeros((count, 3))
    if settings.point is not None:
        point[:] = settings.point.in_metres(file.place("point.unit"))
    if settings.points:
        known = {
            name: entry.in_metres(file.place(f"points.{name}.unit"))
            for name, entry in settings.points.items()
        }
        if "marker" not in roles.has and len(known) > 1:
            raise InputError(
                "several points are stated, and no column says which one was read",
                where=f"{table.path}, line {table.header_line}",
                remedy="Add a column marker with one of: " + ", ".join(known) + ".",
            )
        if "marker" not in roles.has:
            markers = (next(iter(known)),) * count
        point = _places(markers, known, table)
        fit_point = fit_point or any(entry.fit for entry in settings.points.values())
    payload = np.zeros(count)
    if "payload" in roles.has:
        payload = _payload(table)
    hung = np.zeros(3)
    placed = settings.payload is not None and settings.payload.point is not None
    if settings.payload is not None and settings.payload.point is not None:
        hung = np.array(settings.payload.point.in_metres(file.place("payload.point.unit")))
    return Absolute(
        channels=channels,
        frame="base" if settings.position is None else settings.position.frame,
        point=point,
        fit_point=fit_point,
        markers=markers,
        payload=payload,
        payload_point=hung,
        fit_payload=settings.payload is not None and settings.payload.fit,
        payload_placed=placed,
        temperature=_temperature(table) if "temperature" in roles.has else None,
        series=table.cells["series"] if "series" in roles.has else None,
        stations=table.cells["station"] if "station" in roles.has else None,
        fit_axes=fit_point if settings.rotation is None else settings.rotation.axes == "target",
        zero=settings.displacement.zero,
    )


def _places(markers: tuple[str, ...], known: Mapping[str, object], table: Table) -> Array:
    for row, name in enumerate(markers):
        if name not in known:
            raise InputError(
                f"the marker {name!r} has no place",
                where=table.place("marker", row),
                remedy=f"Markers under points are: {', '.join(known)}.",
            )
    return np.array([known[name] for name in markers], dtype=float)


def _payload(table: Table) -> Array:
    """(N,) [kg]; a blank cell is no payload, which is told."""
    if table.column_units["payload"] != "kg":
        raise InputError(
            "the column 'payload' is a mass, in kg",
            where=table.place("payload"),
            remedy="Write its header as payload[kg].",
        )
    mass = table.numbers("payload", allow_blank=True)
    negative = np.flatnonzero(mass < 0.0)
    if len(negative):
        raise InputError(
            f"a payload of {mass[negative[0]]:.4g} kg: no mass is negative",
            where=table.place("payload", int(negative[0])),
            remedy="Write the mass that hangs on the tool; 0 or a blank cell where there is none.",
        )
    blank = np.flatnonzero(~np.isfinite(mass))
    if len(blank):
        cells = "1 blank cell counts" if len(blank) == 1 else f"{len(blank)} blank cells count"
        warn(
            f"{table.place('payload', int(blank[0]))}: {cells} as no payload. Write 0 where none "
            "hangs on the tool, the mass where one does."
        )
    return np.where(np.isfinite(mass), mass, 0.0)


def _temperature(table: Table) -> Array:
    """(N,) [degC]; only differences matter, so kelvin do as well."""
    unit = table.column_units["temperature"]
    if unit not in ("degC", "°C", "C", "K"):
        raise InputError(
            f"a temperature in {unit!r}" if unit else "the column 'temperature' has no unit",
            where=table.place("temperature"),
            remedy="Write its header as temperature[degC].",
        )
    return table.numbers("temperature")


def _channels(table: Table, roles: Roles, file: SettingsFile) -> Channels:
    found: dict[str, Array] = {}
    if roles.has & set(POSITIONS):
        found["position"] = table.quantities(POSITIONS, "length", allow_blank=True)
    rotation = _rotation(table, roles)
    if rotation is not None:
        found["rotation"] = rotation
    if roles.has & set(DISPLACEMENTS):
        found["displacement"] = table.quantities(DISPLACEMENTS, "length", allow_blank=True)
    if roles.has & set(TURNS):
        found["turn"] = np.full((len(table.lines), 3), np.nan)
        for k, name in enumerate(TURNS):
            if name in roles.has:  # a level reads two of them
                found["turn"][:, k] = table.quantity(name, "angle", allow_blank=True)
    if "l" in roles.has:
        found["distance"] = table.quantity("l", "length", allow_blank=True)
        found["anchor"] = _anchors(table, found["distance"])
    if "d" in roles.has:
        found["shift"] = table.quantity("d", "length", allow_blank=True)
        found["along"] = _directions(table, DIRECTIONS, found["shift"])
    if "inc" in roles.has:
        found["inclination"] = table.quantity("inc", "angle", allow_blank=True)
        found["level"] = _directions(table, LEVELS, found["inclination"])
        found["inclination"] = _without_steep(table, found["inclination"])
    sigma, noise = {}, file.settings.noise
    twice = file.settings.displacement.zero == "separate"  # two readings of the gauge
    since_zero = np.sqrt(2.0) if twice else 1.0
    if noise.sigma is not None:
        size = float(units.to_si(noise.sigma, noise.unit, "length", where=file.place("noise.unit")))
        sigma = dict.fromkeys(("position", "distance"), size)
        sigma |= dict.fromkeys(("shift", "displacement"), size * since_zero)
    if noise.rotation is not None:
        turn = float(
            units.to_si(
                noise.rotation, noise.rotation_unit, "angle",
                where=file.place("noise.rotation_unit"),
            )
        )  # fmt: skip
        sigma |= {"rotation": turn, "inclination": turn, "turn": turn * since_zero}
    rows = table.quantities(UNCERTAINTIES, "length") if "sx" in roles.has else None
    return Channels(**found, sigma=sigma, sigma_of_rows=rows)


def _anchors(table: Table, read: Array) -> Array:
    """(N, 3) fixed points [m]; NaN where none is written, for no distance is read there.

    Raises:
        InputError: A distance was read from no point, or a point lacks a coordinate.
    """
    found = table.quantities(ANCHORS, "length", allow_blank=True)
    known = np.isfinite(found)
    bad = ~known & (np.isfinite(read) | known.any(axis=1))[:, None]
    if bad.any():
        row, axis = (int(each[0]) for each in np.nonzero(bad))
        raise InputError(
            "the fixed point that this distance is read from lacks a coordinate",
            where=table.place(ANCHORS[axis], row),
            remedy=f"Write {', '.join(ANCHORS)}; where no distance is read all may be blank.",
        )
    return found


def _without_steep(table: Table, inclination: Array) -> Array:
    """(N,) inclinations [rad], blank near the plumb line, where they tell nothing; told.

    Raises:
        InputError: All are near it.
    """
    steep = np.abs(inclination) > STEEP
    if not steep.any():
        return inclination
    first = int(np.argmax(steep))
    size = f"an inclination of {np.degrees(inclination[first]):.4g} deg"
    near = "Near the plumb line an inclination tells nothing"
    other = "give one of another direction vx, vy, vz of the tool, between -85 and 85 deg above"
    if steep[np.isfinite(inclination)].all():
        raise InputError(
            size, where=table.place("inc", first), remedy=f"{near}: {other} the horizon."
        )
    more = f" and {steep.sum() - 1} more" if steep.sum() > 1 else ""
    warn(f"{table.place('inc', first)}: {size}{more} left out. {near}; {other} the horizon.")
    return np.where(steep, np.nan, inclination)


def _directions(table: Table, names: tuple[str, ...], read: Array) -> Array:
    """(N, 3) unit vectors.

    Raises:
        InputError: A row that was read has none.
    """
    along = np.column_stack([table.numbers(name, allow_blank=True) for name in names])
    length = np.linalg.norm(along, axis=1)
    bad = np.isfinite(read) & ~(length > 0.0)
    if bad.any():
        raise InputError(
            "this reading has no direction",
            where=table.place(names[0], int(np.argmax(bad))),
            remedy=f"Write the direction it was read along as {', '.join(names)}.",
        )
    return np.asarray(along / np.where(length > 0.0, length, 1.0)[:, None])


def _rotation(table: Table, roles: Roles) -> Array | None:
    """(N, 3, 3); NaN where a cell of a row is blank."""
    if roles.has & set(QUATERNION):
        q = np.column_stack([table.numbers(name, allow_blank=True) for name in QUATERNION])
        length = np.linalg.norm(q, axis=1)
        bad = np.isfinite(length) & (np.abs(length - 1.0) > 1e-2)
        if bad.any():
            raise InputError(
                f"a quaternion of length {length[bad][0]:.3g}",
                where=table.place("qw", int(np.argmax(bad))),
                remedy="Write unit quaternions, qw first.",
            )
        q = q / length[:, None]
        vector = None
    elif roles.has & set(ROTATION_VECTOR):
        vector = table.quantities(ROTATION_VECTOR, "angle", allow_blank=True)
        far = np.linalg.norm(vector, axis=1) > 2.0 * np.pi * (1.0 + 1e-6)
        if far.any():
            raise InputError(
                f"a rotation vector of {np.linalg.norm(vector[far][0]):.4g} rad, more than a turn",
                where=table.place("rx", int(np.argmax(far))),
                remedy="If these are degrees, write rx[deg], ry[deg], rz[deg].",
            )
        q = vector
    else:
        return None
    out = np.full((len(q), 3, 3), np.nan)
    known = np.isfinite(q).all(axis=1)
    if not known.any():  # a plan; older scipy refuses an empty stack of rotations
        return out
    turn = (
        Rotation.from_quat(np.roll(q[known], -1, axis=1))  # scalar last there
        if vector is None
        else Rotation.from_rotvec(vector[known])
    )
    out[known] = turn.as_matrix()
    return out
