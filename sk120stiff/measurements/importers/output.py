"""What an import writes: columns, settings, files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from sk120stiff import files, units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.files.writing import check_name, robot_seen_from
from sk120stiff.measurements.importers.drafting import Draft, Written
from sk120stiff.measurements.importers.told import Mode, Told
from sk120stiff.measurements.importers.tracker.frames import points_of, stood_of
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.measurements.table.columns import QUATERNION
from sk120stiff.robot import Robot
from sk120stiff.robot.naming import RobotName, robot_name
from sk120stiff.robot.rotations import rotation_vector


def _point_entry(xyz: Array, *, fit: bool = False) -> dict[str, Any]:
    entry = {"xyz": [round(float(v), 6) + 0.0 for v in 1e3 * xyz], "unit": "mm"}
    return {**entry, "fit": True} if fit else entry


def _hangs(mode: Mode, told: Told) -> str:
    """Where the payload is taken to hang, as a sentence with a blank before it."""
    if told.payload_point is not None:
        return " The payload hangs where --payload-point says."
    if mode == "positions":
        return (
            " Where the payload hangs is not known: where masses differ, 'identify' fits it; "
            "else state the centre of its mass, --payload-point '0,0,120 mm' "
            "(payload.point in the YAML file)."
        )
    return (
        " The payload is taken to hang at the origin of the tool frame, and its weight to act "
        "there; if the centre of its mass is elsewhere, state it: --payload-point '0,0,120 mm' "
        "(force.point in the YAML file)."
    )


def _acts(draft: Draft, where: str) -> str:
    """Where a force is taken to act, as a sentence with a blank before it."""
    if draft.loads.payload is not None:
        return ""  # a weight acts where it hangs
    return (
        f" The load is taken to act {where}; where else it does is what force.point in the YAML "
        "file says."
    )


def settings_for(
    draft: Draft,
    mode: Mode,
    robot: Robot,
    told: Told,
    fitted: Registration | None,
    *,
    registered: bool,
) -> tuple[dict[str, Any], str]:
    """Keys of the YAML file, and what is said of the marker's place."""
    point, known = points_of(draft, told)
    several = mode == "positions" and len(set(draft.marker_of)) > 1
    settings: dict[str, Any] = {
        "robot": _lasting(robot.source),
        "base_frame": robot.base_frame,
        "tool_frame": robot.tool_frame,
    }
    xyz, sensed = point[0], bool(np.any(draft.loads.wrench[:, 3:]))
    weight = draft.loads.payload is not None
    said = "The marker and the load sit at the origin of the tool frame."
    if weight:
        said = "The marker sits at the origin of the tool frame."
    if several and not known:
        said = (
            "Where the markers sit is not known; the fit finds the place of each."
            f"{_acts(draft, 'at the origin of the tool frame')}"
            if draft.loads.taken
            else "Where the markers sit is not known; the fit finds the place of each."
        )
    elif told.point is not None:
        said = f"The marker sits{'' if weight else ', and the load acts,'} where --point says."
    elif known:
        where = "--point says" if told.points else "the file says (TCP)"
        said = f"The markers sit where {where}."
        if mode == "displacements" and len(draft.markers[1]) > 1 and not weight:
            said += (
                " The load is taken to act at the origin of the tool frame; elsewhere it is what "
                "force.point in the YAML file says."
            )
    elif fitted is not None and fitted.marker_fitted:
        xyz = fitted.marker
        shown = ", ".join(f"{round(1e3 * float(v), 1) + 0.0:.1f}" for v in xyz)
        said = (
            f"The marker sits at ({shown}) mm in the tool frame: the best place for these "
            "positions."
        )
        if draft.loads.taken and not sensed:
            said += _acts(draft, "there, too")
    elif mode == "positions":
        said = "Where the marker sits is not known; the fit finds it."
    if weight:
        said += _hangs(mode, told)
    places = draft.markers[1]
    if len(places) > 1:
        settings["points"] = {name: _point_entry(place) for name, place in places.items()}
    elif mode == "positions" and not known:
        # a model holds what was found beyond the stated place: one that every file states alike
        settings["point"] = _point_entry(np.zeros(3), fit=True)
    else:
        settings["point"] = _point_entry(xyz)
    hung = _point_entry(np.zeros(3) if told.payload_point is None else told.payload_point)
    if mode != "positions" or (not weight and np.any(draft.loads.wrench)):
        frame = draft.loads.frame  # those of the instrument are turned, see `columns_for`
        settings["force"] = {"frame": "base" if frame == "instrument" else frame}
        if told.forces_rpy is not None:
            degrees = [float(f"{v:.12g}") for v in np.degrees(told.forces_rpy)]
            settings["force"] |= {"rpy": degrees, "rpy_unit": "deg"}
        if weight:
            settings["force"]["point"] = hung
        elif mode == "positions" and sensed and told.point is None:
            settings["force"]["point"] = _point_entry(np.zeros(3))
            said += (
                " Forces and moments are taken about the origin of the tool frame, where a sensor "
                "on the flange has them; about another point, write it under force.point."
            )
        elif mode == "positions" and not several and not known and xyz.any():
            settings["force"]["point"] = _point_entry(xyz)
    if mode == "positions":
        settings["position"] = {"frame": "base" if registered else "unknown"}
        if any(header in QUATERNION for header, _ in draft.other):
            settings["rotation"] = {"axes": "target"}
        if weight and told.payload_point is not None:
            settings["payload"] = {"point": hung}
    else:
        known = mode == "load pairs" or draft.sheet.subtracted
        zero = {"zero": draft.sheet.zero} if known else {}
        settings["displacement"] = {"frame": "base", **zero}
    if registered and fitted is not None:
        settings["registered"] = _registered(fitted, draft)
    if draft.joints.mapping:
        settings["joints"] = draft.joints.mapping
    settings["source"] = f"imported from {draft.sheet.path.name} ({draft.sheet.title})"
    return settings, said


def columns_for(
    draft: Draft,
    mode: Mode,
    differences: Array,
    fitted: Registration | None,
    *,
    registered: bool,
) -> Written:
    """Headers and cells of the CSV file; what the source prints stays as it is, digit by digit."""
    columns = [("pose", draft.pose), *draft.joints.written]
    if draft.markers[0] and len(draft.markers[1]) > 1:
        columns.append(("marker", draft.markers[0]))
    forces = draft.loads.wrench if mode != "load pairs" else differences
    if draft.loads.frame == "instrument":
        forces = _in_base(forces, fitted, draft, registered=registered)
    if mode == "positions" and draft.loads.payload is not None:
        columns.append(("payload[kg]", _reprs(draft.loads.payload)))
    elif mode != "positions" or forces.any():
        columns += [(f"{n}[N]", _reprs(forces[:, k])) for k, n in enumerate(("fx", "fy", "fz"))]
        if forces[:, 3:].any():
            names = enumerate(("mx", "my", "mz"), 3)
            columns += [(f"{n}[N*m]", _reprs(forces[:, k])) for k, n in names]
    readings, other = list(draft.readings), list(draft.other)
    if mode != "positions":  # where the column marker means positions as such, here it is a note
        other = [("marker_name" if h == "marker" else h, cells) for h, cells in other]
    if registered and fitted is not None:
        at = 1e3 * fitted.in_base(draft.measured, stood_of(draft))
        readings = [(f"{a}[mm]", _reprs(at[:, k])) for k, a in enumerate("xyz")]
        other = _turned_sigmas(other, fitted.turns[stood_of(draft)])
    columns += readings + other
    if not draft.use.all():
        columns.append(("use", tuple("1" if used else "0" for used in draft.use)))
    return tuple(columns)


def _registered(fitted: Registration, draft: Draft) -> dict[str, Any] | list[dict[str, Any]]:
    """The fit that turned positions into base axes, on record; of several stations each."""
    quality = {"rms": 1e3 * fitted.rms, "poses": fitted.poses}
    std = np.where(np.isfinite(fitted.std), fitted.std, 0.0)
    frames = [
        {
            "xyz": [float(v) for v in 1e3 * shift],
            "unit": "mm",
            "rotation": [float(v) for v in rotation_vector(turn)],
            "rotation_unit": "rad",
            "std_xyz": [float(v) for v in 1e3 * error[3:]],
            "std_rotation": [float(v) for v in error[:3]],
            **quality,
        }
        for turn, shift, error in zip(fitted.turns, fitted.shifts, std, strict=True)
    ]
    if draft.stations is None:
        return frames[0]
    named = zip(dict.fromkeys(draft.stations), frames, strict=True)
    return [{"station": station, **frame} for station, frame in named]


def _in_base(
    wrench: Array, fitted: Registration | None, draft: Draft, *, registered: bool
) -> Array:
    """(N, 6) loads in the instrument's axes, turned into those of the base.

    Raises:
        InputError: Nothing tells how the instrument stands.
    """
    if fitted is None or not registered:
        raise InputError(
            "how the instrument's axes stand to those of the base is not known, or not to be used",
            where="--forces instrument",
            remedy="Give positions with and without load, or --register; forces of displacements "
            "in axes of their own have to be turned by hand.",
        )
    turns = fitted.turns[stood_of(draft)]
    parts = [np.einsum("nji,nj->ni", turns, wrench[:, part]) for part in (slice(3), slice(3, 6))]
    return np.hstack(parts)


def _turned_sigmas(other: list[tuple[str, tuple[str, ...]]], turn: Array) -> list[Any]:
    """Standard uncertainties along the axes of the base, of those along the tracker's."""
    sizes = [k for k, (header, _) in enumerate(other) if header[:2] in ("sx", "sy", "sz")]
    if not sizes:
        return other
    metres = np.column_stack(
        [units.to_si([float(c) for c in other[k][1]], other[k][0][3:-1], "length") for k in sizes]
    )
    along = 1e3 * np.sqrt(np.einsum("ni,nij->nj", metres**2, turn**2))
    turned = {
        k: (f"s{a}[mm]", _reprs(along[:, i]))
        for i, (k, a) in enumerate(zip(sizes, "xyz", strict=True))
    }
    return [turned.get(k, column) for k, column in enumerate(other)]


def _reprs(values: Array) -> tuple[str, ...]:
    return tuple(repr(float(v) + 0.0) for v in values)


def _lasting(source: str) -> str:
    """The robot's name as it holds in any folder."""
    name = robot_name(source)
    path = Path(name.place)
    return str(RobotName(str(path.resolve()), name.arguments)) if path.exists() else source


def write_files(columns: Written, settings: dict[str, Any], out: Path) -> None:
    """Write the CSV file and the YAML file of the same stem.

    Raises:
        InputError: As `measurements.files.writing.check_name`, or the folder cannot be written to.
    """
    check_name(out)
    keys = {**settings, "robot": robot_seen_from(settings["robot"], out.parent)}
    text = yaml.safe_dump(keys, sort_keys=False, allow_unicode=True)
    with files.together():
        files.write_atomically(out.with_suffix(".yaml"), text)
        files.write_atomically(out, files.csv_text(columns))
