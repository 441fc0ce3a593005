"""A CSV file and the YAML file of the same stem become `Measurements`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff import files, units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, warn
from sk120stiff.measurements.absolute import SAME_POSE, Absolute, is_absolute, read_absolute
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.files.subtraction import Displacements, displacements, undisplaced
from sk120stiff.measurements.noise.rays import along_rays
from sk120stiff.measurements.noise_statement import Instrument, NoiseStatement
from sk120stiff.measurements.poses import SAME_JOINT, refuse_differing_joints
from sk120stiff.measurements.sensor_axes import in_the_frame, stated_rpy
from sk120stiff.measurements.table import columns
from sk120stiff.measurements.table.branches import branches_of
from sk120stiff.measurements.table.columns import Roles
from sk120stiff.measurements.table.rows import SMALLEST_SIGMA, Rows, read_rows
from sk120stiff.measurements.table.table import Table, read_table
from sk120stiff.measurements.zero import of_one_reading

if TYPE_CHECKING:
    from sk120stiff.measurements.table.settings import InstrumentEntry, Settings, SettingsFile


_YAML = {".yaml", ".yml"}
_ROBOT_FILES = {".urdf", ".xacro", ".xml", *_YAML}
# Beyond these sizes a wrong unit is likelier than the number.
_LARGEST = (
    ("displacement", "the largest displacement", 0.1, "m"),
    ("force", "the largest force", 1e5, "N"),
    ("moment", "the largest moment", 1e5, "N*m"),
    ("angle", "the largest joint angle", 4 * np.pi, "rad"),
    ("point", "the distance of the measured point from the tool frame", 5.0, "m"),
)


def read_measurements(
    path: str | os.PathLike[str],
    actuated: Sequence[str] | None = None,
    prismatic: Sequence[str] | None = None,
) -> Measurements:
    """Read measurements, or a plan if no displacement is given.

    Args:
        path: The CSV file: one row per reading, units in the headers. Settings come from the YAML
            file of the same stem; without it every key has its default (`settings.Settings`).
        actuated: The robot's actuated joints. The joint columns are then checked against them and
            put in their order (`Measurements.with_joints` does the same later).
        prismatic: Those of them that slide and take a length; None takes the file's word.

    Raises:
        InputError: Anything that is missing, misspelt, unclear or impossible, with file, line and
            column.

    Warns:
        ToolkitWarning: A number so large that its unit is in doubt.

    Examples:
        >>> import sk120stiff as sk
        >>> folder = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(folder / "table2_measured.csv")
        >>> readings.n_readings, readings.poses
        (15, ('1', '2', '3'))
    """
    from sk120stiff.measurements.table.settings import find_settings, read_settings

    source = Path(path)
    if source.suffix.lower() in _ROBOT_FILES:
        raise InputError(
            f"a {source.suffix} file holds no readings",
            where=str(source),
            remedy="Give the CSV file; its YAML file of the same stem is found by itself.",
        )
    table = read_table(source)
    settings = read_settings(find_settings(source))
    both = [source] if settings.path is None else [source, settings.path]
    return assembled(table, settings, files.sha256_of(*both), actuated, prismatic)


def assembled(
    table: Table,
    file: SettingsFile,
    data_hash: str,
    actuated: Sequence[str] | None = None,
    prismatic: Sequence[str] | None = None,
) -> Measurements:
    """Measurements from a table and its settings; see `read_measurements`."""
    from sk120stiff.measurements.files.payload_as_force import refuse_payload_for_force

    named = _robot(file.settings.robot, table.path.parent)
    refuse_payload_for_force(table, file.settings, named)
    several = len(file.settings.points) > 1
    roles = columns.assign_roles(table, tuple(actuated or ()), several_points=several)
    _tell_unused_turns(table, roles)
    _refuse_markers_without_places(table, roles)
    measurements = _assemble(table, roles, file, data_hash)
    if actuated is not None:
        kinds = None
        if prismatic is not None:
            kinds = ["length" if name in prismatic else "angle" for name in actuated]
        measurements = measurements.with_joints(actuated, kinds)
    _doubt_units(measurements)
    return measurements


def _assemble(table: Table, roles: Roles, file: SettingsFile, data_hash: str) -> Measurements:
    settings = file.settings
    rows, kinds, spare = read_rows(table, roles, settings.joints, file.place("joints"))
    blank = rows.measured is not None and bool(np.isnan(rows.measured).any())
    orphaned = rows.loaded & ~np.isin(rows.pose_index, rows.pose_index[~rows.loaded])
    absolute = None
    if is_absolute(file, roles, bool(rows.loaded.any()), blank and bool(orphaned.any())):
        absolute = read_absolute(table, roles, file)
    refuse_differing_joints(
        rows.pose,
        rows.pose_index,
        rows.joints,
        tuple(kinds),
        tuple(kinds.values()),
        np.array(table.lines),
        str(table.path),
        SAME_JOINT if roles.measured == columns.DISPLACEMENTS else SAME_POSE,
    )
    said = settings.noise
    noise = NoiseStatement(_sigma(file), said.growth, _instrument(file), said.force)
    own = rows.sigma is not None
    if absolute is not None:
        own = absolute.channels.sigma_of_rows is not None
    if noise.instrument is not None and own:
        raise InputError(
            "an instrument's uncertainty along its ray serves readings that state none of their "
            "own",
            where=file.place("noise.instrument"),
            remedy="Write noise: {sigma: ..., unit: ...}, or keep the columns sx, sy, sz alone.",
        )
    if noise.force and noise.sigma is None and rows.sigma is None:
        raise InputError(
            "how far off forces are is stated, and what one reading is worth is not",
            where=file.place("noise.force"),
            remedy="Write noise.sigma too, or leave noise.force out: single poses with "
            "loads enough tell it.",
        )
    if absolute is not None and absolute.channels.present != ("shift",) and noise.force:
        raise InputError(
            "errors of forces are those of displacements of one point under forces, and other "
            "readings are here",
            where=file.place("noise.force"),
            remedy="Leave noise.force out.",
        )
    if absolute is not None and noise.instrument is not None:
        channels = along_rays(absolute.channels, noise.instrument)
        absolute = replace(absolute, channels=channels)
    point = np.zeros(3)
    if settings.point is not None:
        point = np.array(settings.point.in_metres(file.place("point.unit")))
    force_point = point
    if settings.force.point is not None:
        force_point = np.array(settings.force.point.in_metres(file.place("force.point.unit")))
    if absolute is None:
        found = displacements(table, roles, rows, settings.displacement.zero)
        branch, told = rows.branch, None
        if rows.measured is not None:
            branch, told = branches_of(branch, rows.pose_index, rows.wrench, rows.clock)
    else:
        found = undisplaced(rows, absolute.channels.filled)
        branch, told = rows.branch, None
    kept = found.rows
    return Measurements(
        path=table.path,
        robot=_robot(settings.robot, table.path.parent),
        base_frame=settings.base_frame,
        tool_frame=settings.tool_frame,
        pose=tuple(rows.pose[i] for i in kept),
        joint_names=tuple(kinds),
        joint_kinds=tuple(kinds.values()),
        joints=rows.joints[kept],
        wrench=in_the_frame(rows.wrench[kept], file),
        point=point,
        force_point=force_point,
        force_frame=settings.force.frame,
        sensor_rpy=stated_rpy(file),
        displacement_frame=settings.displacement.frame,
        noise=noise,
        sigma=_sigma_of_rows(rows, found, roles),
        order=None if rows.order is None else rows.order[kept],
        time=None if rows.time is None else rows.time[kept],
        branch=None if branch is None else tuple(branch[i] for i in kept),
        repeat=None if rows.repeat is None else rows.repeat[kept],
        line=np.array(table.lines)[kept],
        gravity=None if settings.gravity is None else np.array(settings.gravity or (0.0,) * 3),
        source=settings.source.strip(),
        extra={
            table.headers[name]: tuple(table.cells[name][i] for i in kept) for name in roles.extra
        },
        displacement=found.displacement,
        zero=found.zero,
        zero_group=found.group,
        zero_count=found.count,
        zero_order=found.order,
        zero_time=found.time,
        zero_joints=found.zero_joints,
        use=found.use,
        absolute=absolute,
        spare=spare,
        notes=(*_assumed_frames(settings, absolute, rows), *found.notes, *([told] if told else [])),
        data_hash=data_hash,
    )


def _tell_unused_turns(table: Table, roles: Roles) -> None:
    """Warn of turns and orientations beside readings that they say nothing of."""
    turns = [name for name in roles.extra if name in (*columns.TURNS, *columns.ROTATION_VECTOR)]
    if not turns:
        return
    if roles.measured == columns.DISPLACEMENTS:
        remedy = (
            "If they say how the load turned the tool, as a rotation vector, call them drx, dry, "
            "drz; if how the tool stood, write where the point stood as well: x y z."
        )
    else:
        remedy = "Turns by a load stand beside displacements dx dy dz."
    warn(f"{table.path}: {', '.join(turns)} are not used. {remedy}")


def _refuse_markers_without_places(table: Table, roles: Roles) -> None:
    """Several markers under one load went differently far, and nobody said where they sit.

    Raises:
        InputError: Two rows of one pose and one load name different markers.
    """
    if roles.measured != columns.DISPLACEMENTS or "marker" not in roles.extra:
        return
    load = [table.cells[n] for n in ("pose", *columns.FORCES, *columns.MOMENTS) if n in roles.has]
    seen: dict[tuple[str, ...], str] = {}
    for row, marker in enumerate(table.cells["marker"]):
        first = seen.setdefault(tuple(cells[row] for cells in load), marker)
        if marker != first:
            raise InputError(
                f"the markers {first!r} and {marker!r} were read under the same load, and where "
                "they sit on the tool is not stated",
                where=table.place("marker", row),
                remedy=f"State their places in the YAML file: points: {{{first}: {{xyz: [0, 0, "
                f"100], unit: mm}}, {marker}: {{xyz: [50, 0, 100], unit: mm}}}}; or rename the "
                "column if it is a note.",
            )


def _sigma_of_rows(rows: Rows, found: Displacements, roles: Roles) -> Array | None:
    """(N, 3) of one loaded reading; a row that states a displacement states that of it."""
    if rows.sigma is None or roles.measured != columns.DISPLACEMENTS:
        return None if rows.sigma is None else rows.sigma[found.rows]
    return of_one_reading(rows.sigma[found.rows], found.count)


def _assumed_frames(settings: Settings, absolute: Absolute | None, rows: Rows) -> list[str]:
    if absolute is not None and not rows.loaded.any():
        return []
    return [
        f"Nobody said in which axes the {name} is given: those of the base frame are taken."
        for name, said in (
            ("force", "force" in settings.model_fields_set),
            ("displacement", "frame" in settings.displacement.model_fields_set),
        )
        if not said
    ]


def _instrument(file: SettingsFile) -> Instrument | None:
    told, unit = file.settings.noise.instrument, file.settings.noise.unit
    if told is None:
        return None
    place = _place_of(file, told)
    along, across, along_per_m, across_per_m = units.to_si(
        (told.along, told.across, told.along_per_m, told.across_per_m),
        unit,
        "length",
        where=file.place("noise.unit"),
    )
    if file.settings.noise.sigma is not None:
        raise InputError(
            "both a standard uncertainty and an instrument are stated",
            where=file.place("noise.instrument"),
            remedy="Keep 'sigma' where all axes are alike, else 'instrument'.",
        )
    x, y, z = (float(v) for v in place)
    return Instrument((x, y, z), along, across, along_per_m, across_per_m)


def _place_of(file: SettingsFile, told: InstrumentEntry) -> Array:
    """(3,) where the instrument stands [m]: in the base frame, or at the origin of its own axes."""
    position = file.settings.position
    if position is not None and position.frame == "unknown":
        if told.xyz is not None:
            raise InputError(
                "these positions are in the instrument's own axes, at whose origin it stands",
                where=file.place("noise.instrument.xyz"),
                remedy="Leave xyz and its unit out.",
            )
        return np.zeros(3)
    if told.xyz is None:
        raise InputError(
            "nothing says where the instrument stands",
            where=file.place("noise.instrument"),
            remedy="Write its place in the base frame: xyz: [3.4, -2.7, 0.9], unit: m.",
        )
    return units.to_si(told.xyz, told.unit, "length", where=file.place("noise.instrument.unit"))


def _sigma(file: SettingsFile) -> float | None:
    noise = file.settings.noise
    if noise.sigma is None:
        return None
    sigma = float(units.to_si(noise.sigma, noise.unit, "length", where=file.place("noise.unit")))
    if sigma < SMALLEST_SIGMA:
        raise InputError(
            f"a standard uncertainty of {noise.sigma:g} {noise.unit} is smaller than any reading's",
            where=file.place("noise.sigma"),
            remedy="Write the standard uncertainty of one reading per axis, or leave it out.",
        )
    return sigma


def _robot(text: str | None, folder: Path) -> str | None:
    """A path is relative to the file it stands in; a bundled name stays as written."""
    if text is None:
        return None
    from sk120stiff.robot.naming import RobotName, robot_name  # Pinocchio comes with it

    place, arguments = robot_name(text)
    path = folder / place
    is_path = any(mark in place for mark in "/\\") or path.suffix.lower() in _ROBOT_FILES
    is_path = is_path or path.exists()
    return str(RobotName(str(path.resolve()), arguments)) if is_path else text


def _doubt_units(measurements: Measurements) -> None:
    angles = [k for k, kind in enumerate(measurements.joint_kinds) if kind == "angle"]
    sizes = {
        "displacement": measurements.displacement,
        "force": measurements.wrench[:, :3],
        "moment": measurements.wrench[:, 3:],
        "angle": measurements.joints[:, angles],
        "point": measurements.point,
    }
    for key, name, limit, unit in _LARGEST:
        values = sizes[key]
        if values is None or values.size == 0:
            continue
        size = np.nanmax(np.abs(values), axis=-1, initial=0.0)
        row = int(np.argmax(size))
        if size.flat[row] > limit:
            line = f", line {measurements.line[row]}" if values.ndim == 2 else ""
            warn(
                f"{measurements.path}{line}: {name} is {size.flat[row]:.4g} {unit}. "
                "Check the unit in the header.",
                stacklevel=3,
            )
