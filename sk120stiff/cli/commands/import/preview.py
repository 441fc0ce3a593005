"""What an import understood of a file, for people and as a document."""

from __future__ import annotations

import re
from itertools import groupby
from pathlib import Path

import numpy as np

from sk120stiff import units
from sk120stiff.cli.tables import table
from sk120stiff.data_checks import without_copies
from sk120stiff.errors import listed
from sk120stiff.measurements.importers import Column, Imported, Sheet
from sk120stiff.measurements.importers.columns.words import kind_of, unit_of_header
from sk120stiff.measurements.importers.contract import Unpaired
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_length
from sk120stiff.robot.rotations import rotation_vector

SHOWN = 8  # skipped rows and worst rows that are told one by one
WORST = 3
MISCALIBRATED = 0.01  # of the stretched arm; arms as they are delivered leave 0.1 to 0.3 %

FOLLOWS = {
    "displacements": "Displacements as they stand in the file: springs and other elastic effects "
    "can be identified; the geometry of the arm cannot.",
    "positions": "No pose of the {poses} was read under two different loads. As "
    "positions they show the geometry of the arm, and springs as far as its weight and payload "
    "bend it.",
}
OF_SEVERAL = (
    "{rows} rows at {useful} of {poses} poses differ in load from the lightest of their pose. {of} "
    "they are taken as positions, not subtracted from one another: geometry, markers and springs "
    "come out of one fit, in which what a pose has of its own is one error of all its readings."
)
UNKNOWN = (
    "They stay in the tracker's own axes (position: {frame: unknown}): 'identify' and 'explain' "
    "register them together with all else, so that no error of this fit is left in them."
)


def document_of(found: Imported, out: Path | None, *, written: bool) -> dict[str, object]:
    """The keys of --json."""
    draft = found.draft
    wrench = draft.loads.wrench if found.mode == "positions" else found.readings.wrench
    return {
        "format": draft.sheet.title,
        "why": draft.sheet.why,
        "columns": [
            {"header": c.header, "meaning": c.meaning, "unit": unit or None, "stated": stated}
            for c in draft.sheet.columns
            for unit, stated in (_unit(c, found),)
        ],
        "unused": list(draft.unused),
        "skipped": [
            {"line": line, "reason": reason}
            for line, reason in (
                *draft.sheet.skipped,
                *((each.line, each.reason) for each in draft.sheet.unpaired),
            )
        ],
        "frame": draft.sheet.frame,
        "rows": len(draft.pose),
        "poses": len(set(draft.pose)),
        "mode": found.mode,
        "useful_poses": found.useful_poses,
        "rows_with_load_difference": found.differences,
        "stiffness_identifiable": found.mode == "displacements" or found.differences > 0,
        "identifiable": identifiable(found),
        "because": found.because or None,
        "assumed": list(found.said),
        "doubts": list(found.doubts),
        "orientation": orientation_of(found),
        "registration": registration_of(found),
        "registered": found.registered,
        "largest_load_N": float(np.linalg.norm(wrench[:, :3], axis=1).max()),
        "out": out if written else None,
    }


def orientation_of(found: Imported) -> dict[str, object] | None:
    """How orientations beside positions were understood, in numbers."""
    read = found.orientation
    if read is None:
        return None
    return {
        "columns": list(read.columns),
        "way": read.way,
        "off_deg": float(np.degrees(read.off)),
        "next_deg": float(np.degrees(read.next)),
        "turned_deg": float(np.degrees(read.turned)),
    }


def registration_of(found: Imported) -> dict[str, object] | None:
    """The rigid robot laid onto the positions, in numbers."""
    fitted = found.fitted
    if fitted is None:
        return None
    frames = _frames(found, fitted)
    order = np.argsort(-fitted.distance)[:WORST]
    rows = found.fitted_rows
    return {
        "rms_mm": fitted.rms * 1e3,
        "largest_mm": fitted.largest * 1e3,
        "worst_pose": found.draft.pose[rows[fitted.worst]],
        "worst": [
            {
                "pose": found.draft.pose[rows[k]],
                "line": found.draft.sheet.lines[rows[k]],
                "distance_mm": float(fitted.distance[k]) * 1e3,
            }
            for k in order
        ],
        "set_aside": [found.draft.sheet.lines[k] for k in np.flatnonzero(found.wild)],
        "poses": fitted.poses,
        "marker_m": fitted.marker,
        "marker_fitted": fitted.marker_fitted,
        "turned_deg": None if found.turned is None else float(np.degrees(found.turned)),
        **{key: value for key, value in frames[0].items() if key != "station"},
        "stations": frames if len(frames) > 1 else [],
        "reason": None
        if np.isfinite(fitted.covariances).all()
        else "the positions do not tell the tracker's frame",
    }


def _frames(found: Imported, fitted: Registration) -> list[dict[str, object]]:
    """The robot's base in the axes of the file, from each station."""
    known = bool(np.isfinite(fitted.covariances).all())
    return [
        {
            "station": station,
            "rotation_rad": rotation_vector(fitted.turns[k]),
            "shift_m": fitted.shifts[k],
            "std_rotation_rad": fitted.std[k, :3] if known else None,
            "std_shift_m": fitted.std[k, 3:] if known else None,
            "covariance": fitted.covariances[k] if known else None,
        }
        for k, station in enumerate(dict.fromkeys(found.draft.stations or ("",)))
    ]


def identifiable(found: Imported) -> str:
    """What follows: displacements, or positions as such."""
    poses = len(set(found.draft.pose))
    if found.mode != "load pairs":
        text = FOLLOWS[found.mode].format(poses=poses)
        if found.mode == "positions" and found.differences:
            of = "Of several markers" if found.orientation is None else "With their orientations"
            if len(set(found.draft.marker_of)) == 1 and found.orientation is None:
                of = "Of one marker" if found.because else "From several places of the tracker"
            text = OF_SEVERAL.format(
                rows=found.differences, useful=found.useful_poses, poses=poses, of=of
            )
        if found.mode == "displacements":
            return text
        axes = UNKNOWN if not found.registered else "They are written in base axes."
        return " ".join(filter(None, (text, found.because, axes)))
    text = (
        f"{found.differences} rows at {found.useful_poses} of {poses} poses differ in load from "
        f"the lightest row of their pose: {3 * found.differences} displacements, from which "
        "springs and other elastic effects can be identified, and the geometry of the arm cannot; "
        f"'identify' says which of them these poses and loads show. {found.because}"
    )
    if found.useful_poses < poses:
        text += (
            f" The other {poses - found.useful_poses} poses show stiffness through the arm's "
            "weight alone; they are left out."
        )
    return text


def doubts_of(found: Imported, robot: Robot) -> list[str]:
    """What speaks against the file being what it seems."""
    doubts = list(found.doubts)
    if (copied := without_copies(found.readings)[1]) is not None:
        doubts.append(copied.replace("masked here", "masked by 'identify' and 'explain'"))
    if found.fitted is not None and found.fitted.rms > MISCALIBRATED * arm_length(robot):
        doubts.append(
            f"{_against(found, robot)} A robot of this make is nearer: check signs and zeros of "
            "joints."
        )
    return doubts


def preview_of(found: Imported, robot: Robot) -> list[object]:
    """What was understood, before anything is written."""
    draft = found.draft
    sheet = draft.sheet
    parts: list[object] = [f"{sheet.path.name}: {sheet.title} ({sheet.why})."]
    shown = [(c.header, c.meaning, *_unit(c, found)) for c in sheet.columns]
    parts.append(table("Columns", ["column", "is", "unit", "stated in"], shown))
    parts.append(f"{len(draft.pose)} rows at {len(set(draft.pose))} poses.")
    if sheet.skipped or sheet.unpaired:
        count = len(sheet.skipped) + len(sheet.unpaired)
        parts.append(f"Left out, {count} {'row' if count == 1 else 'rows'}:")
        by_reason = groupby(sorted(sheet.skipped, key=lambda s: (s[1], s[0])), key=lambda s: s[1])
        for reason, group in by_reason:
            lines = [str(line) for line, _ in group]
            parts.append(f"- line {listed(lines, most=SHOWN)}: {reason}")
        parts += _unpaired(sheet)
    if draft.unused:
        parts.append("Not taken over:")
        parts += [f"- {item}" for item in draft.unused]
    parts.append(f"Axes of the positions, as the file calls them: {sheet.frame or 'not stated'}.")
    if not any(header.startswith("sx") for header, _ in found.columns):
        parts.append("Uncertainties: none stated along x, y, z; the fit estimates them.")
    parts += ["Assumed:", *(f"- {sentence}" for sentence in found.said)]
    parts += _placing(found, robot)
    parts += ["What can be identified:", identifiable(found)]
    return parts


def _unit(column: Column, found: Imported) -> tuple[str, str]:
    """Unit of a column, and where it is stated: of a joint that slides that of lengths."""
    if column.unit is not None:
        return column.unit, column.stated
    told, joints = found.told, found.draft.joints
    for own, (header, _) in zip(joints.taken, joints.written, strict=True):
        if own == column:
            written = unit_of_header(header)[1] or ""
            return written, "--angle" if written in units.KINDS["angle"][1] else "--length"
    kind = kind_of(column.meaning)
    unit = told.of(kind) if kind else None
    option = {"length": "--length", "angle": "--angle", "force": "--load"}.get(kind or "")
    return (unit, str(option)) if unit else ("", "")


def _against(found: Imported, robot: Robot) -> str:
    fitted = found.fitted
    if fitted is None:
        return ""
    freed = "the tracker's frame" + (" and the marker's place" if fitted.marker_fitted else "")
    length = arm_length(robot)
    poses = len({found.draft.pose[k] for k in found.fitted_rows})
    counted = "poses" if poses == fitted.poses else f"readings at {poses} poses"
    return (
        f"Against {robot.name} the positions are {fitted.rms * 1e3:.3g} mm off (rms of "
        f"{fitted.poses} {counted}, {freed} fitted), {fitted.largest * 1e3:.3g} mm at pose "
        f"{found.draft.pose[found.fitted_rows[fitted.worst]]}: {100 * fitted.rms / length:.2g} % "
        f"of the arm's {length:.3g} m."
    )


def _unpaired(sheet: Sheet) -> list[str]:
    """How many rows lack a partner, and the first of them, numbers in names in their order."""
    groups: dict[str, list[Unpaired]] = {}
    for each in sheet.unpaired:
        groups.setdefault(each._replace(name="").reason, []).append(each)
    said = []
    for reason, group in groups.items():
        group.sort(key=lambda each: (_natural(each.name), each.line))
        named = bool(group[0].name)
        shown = [each.name if named else str(each.line) for each in group]
        of = " " if group[0].beside else ": "
        said.append(f"- {'' if named else 'line '}{listed(shown, most=SHOWN)}{of}{reason}")
    return said


def _natural(name: str) -> list[tuple[bool, int, str]]:
    """What names are sorted by: P2 comes before P10."""
    parts = re.findall(r"\d+|\D+", name)
    return [(not p.isdecimal(), int(p) if p.isdecimal() else 0, p) for p in parts]


def _placing(found: Imported, robot: Robot) -> list[object]:
    fitted = found.fitted
    if fitted is None:
        if found.mode == "displacements":
            return ["Displacements say nothing of where the robot stands: no fit checks them."]
        return []
    parts: list[object] = [_against(found, robot)]
    worst = [
        (found.draft.pose[found.fitted_rows[k]],
         found.draft.sheet.lines[found.fitted_rows[k]], 1e3 * float(fitted.distance[k]))
        for k in np.argsort(-fitted.distance)[:WORST]
    ]  # fmt: skip
    parts.append(table("Worst rows", ["pose", "line", "off [mm]"], worst))
    aside = [str(found.draft.sheet.lines[k]) for k in np.flatnonzero(found.wild)]
    if aside:
        parts.append(
            f"Far off all others, and not counted here: line {listed(aside, most=SHOWN)}. They are "
            "written all the same."
        )
    stations = tuple(dict.fromkeys(found.draft.stations or ("",)))
    rows = [
        (station, f"{what} {axis} [{unit}]", f"{scale * value:.4f}", f"{scale * error:.4f}")
        for station, turn, shift, std in zip(
            stations, fitted.turns, fitted.shifts, fitted.std, strict=True
        )
        for what, unit, scale, values, errors in (
            ("shift", "mm", 1e3, shift, std[3:]),
            ("turn", "mrad", 1e3, rotation_vector(turn), std[:3]),
        )
        for axis, value, error in zip("xyz", values, errors, strict=True)
    ]  # fmt: skip
    head = ["station", "", "value", "std. error"]
    first = 0 if len(stations) > 1 else 1
    title = "The robot's base in the axes of the file"
    parts.append(table(title, head[first:], [row[first:] for row in rows]))
    parts.append(
        "Standard errors hold as far as what is left is independent from pose to pose."
        if np.isfinite(fitted.std).all()
        else "The positions do not tell the frame."
    )
    if found.registered:
        parts.append(
            "Positions are written in base axes by this fit, which the YAML file records "
            "(registered)."
        )
    return parts
