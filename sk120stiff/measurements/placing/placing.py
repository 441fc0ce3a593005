"""Where the tracker stands, in closed form: what is left tells bad input before anything else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.placing.cloud import FEWEST, Cloud
from sk120stiff.measurements.placing.distances import place_distances
from sk120stiff.measurements.placing.from_a_row_on import refuse_from_a_row_on
from sk120stiff.measurements.placing.groups import of_all_groups
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.measurements.placing.slips import (
    MIRRORED,
    ONE_COLUMN,
    Convention,
    markers,
    nearer,
    one_zero,
    signs_and_turns,
    slips,
    to_the_floor,
    with_sums,
)
from sk120stiff.measurements.placing.under_load import refuse_far_under_load
from sk120stiff.measurements.placing.untold import with_told_place
from sk120stiff.measurements.placing.upside_down import OtherConvention, standing
from sk120stiff.measurements.placing.zeros import small_zeros
from sk120stiff.robot import STANDARD_GRAVITY, Robot
from sk120stiff.robot.rotations import rotation_vector

FITS = 0.03  # of the spread of the positions: what no calibrated arm leaves after placing
AS_WELL = 1.1  # times what mirrored positions leave, up to which other signs of joints do as well
SUSPECT = 1e-3  # of the spread of the positions: what is worth a look for slips of the pen
BETTER = 0.2  # of what is left, by which a slip of the pen must explain it
FEWER = 50  # rows that sums of joints are looked for in: there are many
TURNED, SHIFTED = np.radians(3.0), 0.05  # against base axes, and of the spread
MOVED = 3.0  # times less left with the marker elsewhere: its stated place is wrong
COMPUTED = 2e-6  # m; no arm is built, and no tracker reads, as well as that


@dataclass(frozen=True, eq=False)
class Placing:
    """The rigid robot laid onto the positions.

    Attributes:
        shift, turn: (S, 3) [m] and (S, 3) rotation vector of the base frame as the instrument sees
            it from each of `Absolute.stood`.
        marker: (3,) how far markers are off their stated place, tool axes [m].
        apart: (G, 3) how much farther than the first each group of `Absolute.groups` is off [m].
        rms: Distance that is left, rows that are wild set aside [m].
        wild: (N,) rows far off all others.
        distance: (N,) what is left at each row [m]; NaN where no whole position was read.
        notes: What is to be said, in sentences.
        far_off: Other zeros of the joints are needed: the rigid arm is far off without.
    """

    shift: Array
    turn: Array
    marker: Array
    apart: Array
    rms: float
    wild: Mask
    distance: Array
    notes: tuple[str, ...] = ()
    far_off: bool = False


def place(robot: Robot, readings: Measurements) -> Placing | None:
    """Register the positions, or distances where fewer than three whole ones were read.

    None where neither tells where the tracker stands.

    Raises:
        InputError: They are not of this robot, or of joints or lengths in other units, of mirrored
            axes, of columns in another order; the message says which slip would explain it.
    """
    said = readings.absolute
    if said is None:
        return None
    x = said.channels.position
    x = np.full((readings.n_readings, 3), np.nan) if x is None else x
    whole = np.flatnonzero(np.isfinite(x).all(axis=1) & readings.use)
    lost = whole[(x[whole] == 0.0).all(axis=1)]  # a tracker that saw nothing
    every = whole if len(lost) == len(whole) else np.setdiff1d(whole, lost)
    whole = _lightest(readings, said, every)
    if len(whole) < FEWEST:
        return _by_distances(robot, readings)
    stations, stood = said.stood
    stands_for_all(stations, stood[whole], readings)
    free = said.fit_point
    groups = [] if said.groups is None else [said.groups[k] for k in whole]
    labels = list(dict.fromkeys(groups))

    def of(rows: Index) -> Cloud:
        names, one = np.array(said.markers)[rows], np.zeros(len(rows), dtype=np.intp)
        parts = readings.joints[rows], x[rows], said.point[rows], names, one, stood[rows]
        return Cloud(robot, *parts)

    cloud = of(whole)
    found, kept = cloud.placed(fit_marker=True)
    spread = cloud.spread
    if free and len(labels) > 1 and found.rms > SUSPECT * spread:
        # No one shift of all markers will do: exchanged, or each somewhere of its own.
        _refuse_exchange(cloud, found, readings)
        cloud = replace(cloud, group=np.array([labels.index(label) for label in groups]))
        found, kept = cloud.placed(fit_marker=True)
    notes, far_off = list[str](), False
    if found.rms > SUSPECT * spread:
        _refuse_slips(cloud, found, readings, whole, spread)
    if found.rms > FITS * spread:
        if free and not found.marker_fitted:
            raise InputError(
                f"{len(whole)} positions cannot tell the tracker's frame and the marker's place",
                where=readings.place,
                remedy="Measure more poses, or state where the marker sits, without 'fit: true'.",
            )
        notes, far_off = [_of_small_zeros(cloud, found, readings, whole, spread)], True
    if not free:
        stated, at = cloud.placed(fit_marker=False)
        if stated.rms > MOVED * found.rms and found.marker_fitted:
            off = ", ".join(f"{1e3 * value:.1f}" for value in found.marker)
            told = (
                f"he marker seems to sit ({off}) mm off its stated place, tool axes: "
                f"{1e3 * stated.rms:.2f} mm are left with it where it is stated, "
                f"{1e3 * found.rms:.2f} mm with it there"
            )
            remedy = "Write 'point: {..., fit: true}'."
            if stated.rms > FITS * spread:
                raise InputError("t" + told, where=str(readings.path or ""), remedy=remedy)
            notes.append(f"T{told}. {remedy}")
        found, kept = stated, at
    found, notes[len(notes) :] = with_told_place(cloud, found, kept)
    if len(every) > len(whole) and len(found.apart) == 1:
        refuse_far_under_load(of(every), found, readings, every)
    if said.frame == "base":
        _refuse_other_axes(found, cloud, spread, readings)
    if found.rms < COMPUTED:
        notes.append(
            f"These positions follow the rigid robot of the URDF to {1e6 * found.rms:.2g} µm, "
            "nearer than any instrument reads and than any arm is built: they look computed, as a "
            "controller shows them, not measured. Check which columns are the measurement."
        )
    if said.frame == "unknown" and len(stations) == 1:
        notes += _say_if_it_hangs(cloud, readings)
    distance, wild = np.full(readings.n_readings, np.nan), np.zeros(readings.n_readings, dtype=bool)
    distance[whole], wild[whole[~kept]] = cloud.left(found), True
    if len(lost) and not np.isin(lost, whole).any():
        wild[lost] = True
        lines = listed([str(readings.line[row]) for row in lost])
        notes.append(
            f"The position is exactly 0, 0, 0 in line{'s' * (len(lost) > 1)} {lines}, as where a "
            "tracker saw nothing: set aside. Leave such cells blank."
        )
    marker, apart = of_all_groups(found.marker, found.apart, labels, said)
    return Placing(
        shift=found.shifts,
        turn=rotation_vector(found.turns),
        marker=marker if free else np.zeros(3),
        apart=apart,
        rms=found.rms,
        wild=wild,
        distance=distance,
        notes=tuple(notes),
        far_off=far_off,
    )


def stands_for_all(stations: tuple[str, ...], stood: Index, readings: Measurements) -> None:
    """Each station must have enough positions to tell where it is."""
    counts = np.bincount(stood, minlength=len(stations))
    few = [f"{name} ({n})" for name, n in zip(stations, counts, strict=True) if n < FEWEST]
    if few:
        raise InputError(
            f"too few positions to tell where the tracker stood: {listed(few)}",
            where=f"{readings.path or 'measurements'}, column station",
            remedy=f"From {FEWEST} whole positions on they tell it, from some ten on well. Leave "
            "these rows out (use: 0), or measure more from there.",
        )


def _lightest(readings: Measurements, said: Absolute, rows: Index) -> Index:
    """Of these rows those under the least load that their marker was read under at their pose, from
    each place of the tracker: a file of each load may be from a place of its own.
    """
    load = np.abs(said.payload) * STANDARD_GRAVITY + np.linalg.norm(readings.wrench[:, :3], axis=1)
    stood = said.stood[1]
    where = [f"{readings.pose[k]}\n{said.markers[k]}\n{stood[k]}" for k in rows]
    own = np.unique(np.array(where), return_inverse=True)
    least = np.full(len(own[0]), np.inf)
    np.minimum.at(least, own[1], load[rows])
    return np.asarray(rows[load[rows] <= least[own[1]]])


def _by_distances(robot: Robot, readings: Measurements) -> Placing | None:
    found, said = place_distances(robot, readings), readings.absolute
    if found is None or said is None or said.channels.distance is None:
        return None
    if len(said.stood[0]) > 1:
        raise InputError(
            "distances to fixed points know no stations: ax, ay, az are in one frame",
            where=f"{readings.path or 'measurements'}, column station",
            remedy="State the fixed points in one frame and take the column out.",
        )
    if said.frame == "base" and found.off > max(SHIFTED * found.spread, 10.0 * found.rms):
        raise InputError(
            f"the fixed points are not where ax, ay, az state them in axes of the base frame: "
            f"{1e3 * found.off:.4g} mm rms are left with them there, {1e3 * found.rms:.3g} mm with "
            "them elsewhere",
            where=readings.place,
            remedy="Write 'position: {frame: unknown}' into the YAML file: the places are then "
            "known against each other alone. Or state them in base axes.",
        )
    rows = np.flatnonzero(np.isfinite(said.channels.distance) & readings.use)
    distance, wild = np.full(readings.n_readings, np.nan), np.zeros(readings.n_readings, dtype=bool)
    distance[rows], wild[rows] = np.abs(found.left), ~found.kept
    notes = (
        f"{len(found.fixed)} fixed point{'s' * (len(found.fixed) > 1)}: about "
        f"{'it' if len(found.fixed) == 1 else 'the line through them'} distances do not tell how "
        "the axes of ax, ay, az are turned, and nothing else depends on it.",
    )
    return Placing(
        shift=found.shift[None],
        turn=rotation_vector(found.turn)[None],
        marker=found.marker,
        apart=np.zeros((1, 3)),
        rms=found.rms,
        wild=wild,
        distance=distance,
        notes=() if found.told or said.frame == "base" else notes,
    )


def _refuse_slips(
    cloud: Cloud, found: Registration, readings: Measurements, rows: Index, spread: float
) -> None:
    """Refuse positions that one slip of the pen explains far better.

    So many conventions are tried that one of them always does better on few poses: it has to leave
    what a calibrated arm leaves, too.
    """
    where = readings.place
    told = _left(found)
    few = cloud.some()
    base = few.placed(fit_marker=True)[0].rms
    least = min(BETTER * base, FITS * spread)
    explains, rms, what, remedy = min(slips(few, readings.joint_names), key=lambda item: item[0])
    one = InputError(
        f"{told}. {what}: then {1e3 * rms:.3g} mm are left", where=where, remedy=remedy
    )
    mirrored = what.endswith(MIRRORED)  # joints that count the other way do the same to most arms
    if explains < least and not mirrored:
        raise one
    refuse_from_a_row_on(cloud, told, least, readings, rows)
    ways = [
        (signs_and_turns, "other zeros or signs of joints"),
        (to_the_floor, "other zeros, signs or sums of joints"),
        (with_sums, "other zeros, signs or sums of joints"),
    ]
    if found.rms > FITS * spread:  # what is less a fit finds, and says of it that it is an error
        ways.insert(0, (one_zero, "the zero of one joint elsewhere"))
    for found_by, other in ways:
        way = found_by(cloud.some(FEWER))
        as_mirrored = mirrored and explains < BETTER * base and way.rms < AS_WELL * explains
        if way.changed(readings.joint_names) and (way.rms < least or as_mirrored):
            way = nearer(cloud.some(FEWER), way)
            stands = standing(cloud.some(FEWER), way, _gravity(cloud.robot, readings))
            way, written = stands.way, _as_written(readings)
            or_else = (
                f"; or else the positions look {MIRRORED}: then {1e3 * rms:.3g} mm are left"
                if mirrored
                else ""
            )
            raise OtherConvention(
                f"{told}. With {other} {1e3 * way.rms:.3g} mm are left{or_else}",
                where=where,
                remedy="Check the controller's convention. If it is so, write into the YAML file: "
                f"{written(way)}; where a joint has an expression there already, put that in its "
                f"place on the right.{stands.beside(written)}",
                standing=stands,
            )
    if explains < least or (explains < BETTER * base and not what.startswith(ONE_COLUMN)):
        raise one  # not all of it: a column alone in another unit would be


def _gravity(robot: Robot, readings: Measurements) -> Array:
    """(3,) in axes of the base, as the file or else the robot has it."""
    return robot.gravity_in_base if readings.gravity is None else readings.gravity


def _as_written(readings: Measurements) -> Callable[[Convention], str]:
    """How a convention stands in the YAML file."""

    def written(way: Convention) -> str:
        mapping = way.changed(readings.joint_names)
        return f"joints: {{{', '.join(f'{n}: {e}' for n, e in mapping.items())}}}"

    return written


def _say_if_it_hangs(cloud: Cloud, readings: Measurements) -> list[str]:
    """A sentence where the base stands upside down, and upright fits as well."""
    n = cloud.a.shape[1]
    as_it_is = Convention(0.0, np.eye(n), np.zeros(n))
    found = standing(cloud.some(FEWER), as_it_is, _gravity(cloud.robot, readings))
    turned = bool(found.way.changed(readings.joint_names))
    if not (turned and found.upright and found.other is not None and found.other.hangs):
        return []
    first, second = readings.joint_names[:2]
    return [
        "These positions put the base upside down against their z axis, and the arm fits them as "
        f"well upright: with {first} of the other sign and {second} half a turn on. If z is up and "
        "the arm hangs from no ceiling, the joint columns have that other convention. If z points "
        "down, nothing is to be done; if the arm hangs, state gravity in the YAML file."
    ]


def _refuse_exchange(cloud: Cloud, found: Registration, readings: Measurements) -> None:
    """Refuse names of markers whose exchange explains what one shift of all leaves."""
    tried = min(markers(cloud.some()), key=lambda item: item[0], default=None)
    if tried is not None and tried[0] < BETTER * found.rms:
        what = f"{_left(found)}. {tried[2]}: then {1e3 * tried[1]:.3g} mm are left"
        raise InputError(what, where=readings.place, remedy=tried[3])


def _left(found: Registration) -> str:
    return (
        f"these positions are not where this robot's marker goes: {1e3 * found.rms:.4g} mm are "
        "left after the best placing of the tracker"
    )


def _of_small_zeros(
    cloud: Cloud, found: Registration, readings: Measurements, whole: Index, spread: float
) -> str:
    """That zeros of joints, a little off, bring this arm where the positions are.

    Raises:
        InputError: They do not: no placing of this robot gives these positions.
    """
    stated = readings.absolute is not None and not readings.absolute.fit_point
    zeros = small_zeros(cloud, fit_marker=not stated)
    if zeros.small and zeros.rms <= FITS * spread:
        return zeros.sentence(readings.joint_names, found.rms)
    distance = cloud.left(found)
    worst = np.argsort(-distance)[:3]
    lines = ", ".join(str(readings.line[whole[k]]) for k in worst)
    raise InputError(
        f"{_left(found)}, of positions that spread over {1e3 * spread:.4g} mm rms about their "
        f"middle, and {1e3 * zeros.rms:.4g} mm with other zeros of the joints",
        where=f"{readings.path or 'measurements'}, worst in lines {lines}",
        remedy="Check that they are of this robot, that rows of joints and positions belong "
        "together, units, signs and order of the joint columns, and the names of markers.",
    )


def _refuse_other_axes(
    found: Registration, cloud: Cloud, spread: float, readings: Measurements
) -> None:
    """Positions said to be in base axes must be there."""
    screws = cloud.robot.screws(cloud.a)
    marker = cloud.point + found.marker
    at = screws.frame_position + np.einsum("nij,nj->ni", screws.rotation, marker)
    angle = float(np.linalg.norm(rotation_vector(found.turns[0])))
    off = float(np.median(np.linalg.norm(cloud.x - at, axis=1)))
    if angle < TURNED and off < max(SHIFTED * spread, 10.0 * found.rms):
        return
    raise InputError(
        "these positions are not in axes of the base frame: they are turned by "
        f"{np.degrees(angle):.1f} deg and {1e3 * off:.4g} mm off",
        where=readings.place,
        remedy="Write 'position: {frame: unknown}' into the YAML file: the tracker's own axes are "
        "then found by the fit. Or turn them into base axes.",
    )
