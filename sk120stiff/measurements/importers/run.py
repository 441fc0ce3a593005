"""A file of readings becomes `Measurements`, with what was understood of it.

Points, joints and loads of separate files are put side by side.
"""

from __future__ import annotations

import dataclasses
import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.arrays import Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.files.reading import assembled
from sk120stiff.measurements.importers.campaign.before_load import with_before
from sk120stiff.measurements.importers.campaign.pairing import paired
from sk120stiff.measurements.importers.campaign.several_files import joined
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.columns.orientations import named
from sk120stiff.measurements.importers.columns.rows_in_words import understood_words
from sk120stiff.measurements.importers.contract import Formats, Role, Sheet, Source
from sk120stiff.measurements.importers.drafting import Draft, Written, drafted, paired_loads
from sk120stiff.measurements.importers.formats.catalogue import FORMATS
from sk120stiff.measurements.importers.formats.matlab import is_matlab, matlab_grid
from sk120stiff.measurements.importers.formats.numpy_archive import is_numpy, numpy_grid
from sk120stiff.measurements.importers.formats.robot_program import is_program, program_grid
from sk120stiff.measurements.importers.formats.workbook import (
    fitting_sheets,
    is_workbook,
    workbook_grid,
)
from sk120stiff.measurements.importers.formats.workbook_sheets import (
    named_sheets,
    under_load,
    without_used,
)
from sk120stiff.measurements.importers.holds.holds import as_repeats
from sk120stiff.measurements.importers.holds.log import standstills
from sk120stiff.measurements.importers.joint_units import blank_doubts, unit_doubts
from sk120stiff.measurements.importers.layout.header_rows import in_one_row
from sk120stiff.measurements.importers.layout.lost_readings import without_lost
from sk120stiff.measurements.importers.layout.markers_in_rows import with_numbered_markers
from sk120stiff.measurements.importers.layout.split_headers import with_whole_headers
from sk120stiff.measurements.importers.loads.hung_masses import (
    doubts_of_names,
    refuse_other_files,
    say_masses,
    with_mass,
    with_masses_of_all,
)
from sk120stiff.measurements.importers.loads.pairs import LOADS, unfolded
from sk120stiff.measurements.importers.loads.told_mass import with_told_mass
from sk120stiff.measurements.importers.output import columns_for, settings_for, write_files
from sk120stiff.measurements.importers.told import Mode, Told
from sk120stiff.measurements.importers.tracker.frames import axes, placed
from sk120stiff.measurements.importers.tracker.orientation import (
    Orientation,
    understood,
    with_orientation,
)
from sk120stiff.measurements.importers.tracker.positions_or_differences import (
    TakenAs,
    first_mode,
    last_mode,
    unless_apart,
)
from sk120stiff.measurements.importers.tracker.several_markers import (
    of_marker,
    refuse_one_marker_twice,
    refuse_several_points,
    with_places,
)
from sk120stiff.measurements.importers.tracker.stations import with_stations
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.measurements.table.settings import settings_of
from sk120stiff.measurements.table.table import table_of
from sk120stiff.robot import Robot


@dataclass(frozen=True, eq=False)
class Imported:
    """What a file holds.

    Attributes:
        draft, told: Its rows, understood with what was told.
        mode: ``"displacements"`` as they stand in the file, ``"load pairs"`` (positions under two
            loads at one pose, whose differences are displacements), or ``"positions"`` as such.
        because: Why it is one of the last two where it may be either, and how to get the other.
        readings: What reading the written files gives.
        columns, settings: What is written.
        fitted: The rigid robot laid onto the positions, or None; `fitted_rows` (P,) are their
            rows, `wild` (N,) those that were set aside for it.
        registered: Are positions written in base axes because of it?
        turned: Angle between the axes of the positions and those of the base [rad], or None.
        reversed_rms: What remains if deviations had the other sign [m], or None.
        orientation: How orientations beside positions were understood, or None.
        differences, useful_poses: Rows with a load other than the lightest of their pose, and the
            poses that have such rows.
        doubts, said: What speaks against it, and what was decided, in sentences.
    """

    draft: Draft
    told: Told
    mode: Mode
    because: str
    readings: Measurements
    columns: Written
    settings: dict[str, Any]
    fitted: Registration | None
    fitted_rows: Index
    wild: Mask
    registered: bool
    turned: float | None
    reversed_rms: float | None
    orientation: Orientation | None
    differences: int
    useful_poses: int
    doubts: tuple[str, ...]
    said: tuple[str, ...]

    def write(self, out: Path) -> None:
        """Write the CSV file and the YAML file of the same stem.

        Raises:
            InputError: The name does not end in .csv, or the folder cannot be written to.
        """
        write_files(self.columns, self.settings, out)


def import_readings(
    path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    robot: Robot,
    told: Told | None = None,
    *,
    joints_file: Path | None = None,
    loads_file: Path | None = None,
    before: Path | None = None,
    format_name: str | None = None,
    columns: Sequence[str] | None = None,
    sheet: str | Sequence[str] | None = None,
    topic: str | None = None,
    marker: str | None = None,
    into_base: bool | None = None,
    taken_as: TakenAs | None = None,
    formats: Formats = FORMATS,
) -> Imported:
    """Read positions of a marker, or displacements, in any format of `formats`.

    Args:
        path: The file, or the folder of a ROS bag; or several of one campaign, with the same
            columns.
        robot: What was measured.
        told: Units and places that the file does not say.
        joints_file, loads_file: Joints and loads, where they stand in files of their own.
        before: Positions of the same poses without load; those of `path` are under it.
        format_name: The format, where the content leaves it open.
        columns: Names of the columns of a file without headers.
        sheet: Which sheet of a workbook; several with what each is for: ``"before=Unloaded"``,
            ``"joints=..."``, ``"loads=..."``, and that of the positions as it is called.
        topic, marker: Which topic of a recording, marker of several.
        into_base: Turn positions into base axes by the best placing of the robot; None: only where
            displacements are made of them and their axes are others.
        taken_as: Keep positions of a pose under several loads as ``"positions"``, or make
            ``"displacements"`` of them; None: as `positions_or_differences.last_mode` says.
        formats: The formats that are known.

    Raises:
        InputError: A file that cannot be understood, with what to tell or to mend.
        Refusal: The positions are not those of this robot.
    """
    told = told or Told()
    prismatic = tuple(n for n, s in zip(robot.actuated, robot.prismatic, strict=True) if s)
    paths = [path] if isinstance(path, str | os.PathLike) else path
    _refuse_beside_several(paths, before)
    of_sheets = named_sheets([sheet] if isinstance(sheet, str) else sheet or [])
    files = {"before": before, "joints": joints_file, "loads": loads_file}
    refuse_other_files([Path(one) for one in paths], told)
    sheets = [
        _sheet(
            Source(
                Path(one), robot.actuated, "points", tuple(columns) if columns else None,
                of_sheets.get(""), topic, marker,
            ),
            formats, format_name, files, of_sheets, told, [Path(each).stem for each in paths],
        )
        for one in paths
    ]  # fmt: skip
    sheets = with_masses_of_all(sheets)
    whole = sheets[0] if len(sheets) == 1 else joined(sheets)
    whole = whole.noting(*say_masses(sheets))
    draft = drafted(whole, told, robot.actuated, prismatic)
    held = standstills(draft) or as_repeats(draft)
    if held is not None:
        draft = drafted(held, told, robot.actuated, prismatic)
    draft = with_places(draft, told)
    refuse_one_marker_twice(draft)
    differences, paired_rows, shifted = paired_loads(draft)
    mode, because = first_mode(draft, paired_rows, taken_as), ""
    if mode != "positions":
        refuse_several_points(draft)
    draft = with_stations(draft, mode, robot, told)
    mode = unless_apart(draft, mode, taken_as)
    laid = placed(draft, mode, robot, told)
    if mode == "load pairs":
        of_pairs = understood(draft, robot, told, "positions", laid.fitted, laid.rows)
        turns = isinstance(of_pairs, Orientation)
        mode, because = last_mode(draft, laid, taken_as, turns=turns)
    turned, registered, doubts = axes(laid.fitted, mode, into_base, told)
    read = understood(draft, robot, told, mode, laid.fitted, laid.rows)
    draft = with_orientation(draft, read, laid.fitted, registered=registered)
    settings, point = settings_for(draft, mode, robot, told, laid.fitted, registered=registered)
    written = columns_for(draft, mode, differences, laid.fitted, registered=registered)
    readings = _assembled(draft, written, settings, robot, prismatic)
    said = list(draft.said)
    if shifted and mode == "load pairs":
        said.append(
            f"At {shifted} poses the lightest load is not zero: the load of a row is its "
            "difference to the lightest of its pose."
        )
    said.append(point)
    return Imported(
        draft=draft,
        told=told,
        mode=mode,
        because=because,
        readings=readings,
        columns=written,
        settings=settings,
        fitted=laid.fitted,
        fitted_rows=laid.rows,
        wild=laid.wild,
        registered=registered,
        turned=turned,
        reversed_rms=laid.reversed_rms,
        orientation=read if isinstance(read, Orientation) else None,
        differences=int(paired_rows.sum()),
        useful_poses=len({draft.pose[k] for k in np.flatnonzero(paired_rows)}),
        doubts=(
            *whole.doubts,
            *laid.doubts,
            *doubts,
            *([] if laid.fitted else unit_doubts(draft, robot)),
            *blank_doubts(draft),
            *(doubts_of_names(sheets) if told.wrench is None else []),
        ),
        said=tuple(said),
    )


def _refuse_beside_several(paths: Sequence[object], before: Path | None) -> None:
    if before is not None and len(paths) > 1:
        raise InputError(
            f"{len(paths)} files of positions, and one of positions without load",
            where="--before",
            remedy="Import them one by one, or put the columns of both into each file.",
        )
    if not paths:
        raise InputError("no file is given", remedy="Give one file, or several of one campaign.")


def _sheet(
    source: Source,
    formats: Formats,
    name: str | None,
    files: Mapping[str, Path | None],
    sheets: Mapping[str, str],
    told: Told,
    beside: Sequence[str],
) -> Sheet:
    """The readings of a file, with those of the files beside it: before, joints, loads."""
    before, book = files["before"], not source.path.is_dir() and is_workbook(source.data)
    same = book and before is not None and before.resolve() == source.path.resolve()
    if same:
        source = dataclasses.replace(source, state=WITH)
    whole = opened(source)
    importer, why = formats.chosen(whole, name)
    sheet = without_lost(importer.read(whole))
    title = whole.grid.sheet if book else None
    used = [title] if title else []
    if why == "as told":
        sheet = dataclasses.replace(sheet, title=importer.title, why=why)
    if before is not None:
        free = opened(dataclasses.replace(
            source, path=before, sheet=sheets.get("before"), called="before",
            state=WITHOUT if same else None, beside=title if same else None,
        ))  # fmt: skip
        used += [free.given.sheet] if same and free.given and free.given.sheet else []
        sheet = with_before(sheet, without_lost(formats.chosen(free, name)[0].read(free)), told)
    if files["loads"] is None or told.payloads:
        sheet = with_mass(sheet, told, beside)
    roles: tuple[Role, Role] = ("joints", "loads")
    for role in roles:
        path = files[role]
        if path is None and book and _is_elsewhere(sheet, role, source, sheets, used, told):
            path = source.path  # another sheet of the workbook holds them
        if path is None:
            continue
        more = opened(Source(path, source.actuated, role, sheet=sheets.get(role), called=role))
        if path == source.path and more.given and more.given.sheet:
            used.append(more.given.sheet)
        sheet = paired(
            sheet, formats.chosen(more)[0].read(more), role,
            by_clock=True, alone=len(beside) == 1, dates=told.dates,
        )  # fmt: skip
    sheet = understood_words(of_marker(sheet, source.marker), told)
    sheet = named(unfolded(with_told_mass(sheet, told)))
    if book:
        sheet = without_used(sheet, source.path, used)
    if under_load(title) and not sheet.those(*LOADS):
        said = (
            f"By its name the sheet {title} is under a load, and no column says which: it is taken "
            "to be without. Give --loads-file, or a column fx[N], fy[N], fz[N] or payload[kg]."
        )
        sheet = dataclasses.replace(sheet, doubts=(*sheet.doubts, said))
    return sheet


def _is_elsewhere(
    sheet: Sheet,
    role: Role,
    source: Source,
    sheets: Mapping[str, str],
    used: Sequence[str],
    told: Told,
) -> bool:
    """Are joints or loads, which these readings lack, in another sheet of their workbook?

    Loads only where the readings are under one by the name of their sheet, or were told to be.
    """
    if role in sheets:
        return True
    if role == "joints":
        return not any(c.meaning.startswith("joint ") for c in sheet.columns)
    pushed = under_load(used[0]) if used else False
    if told.wrench is not None or not pushed or sheet.those(*LOADS):
        return False
    return len(fitting_sheets(Source(source.path, source.actuated, role))) == 1


def opened(source: Source) -> Source:
    """The source with its rows, where a workbook, MATLAB, numpy or a robot's program holds them."""
    if is_workbook(source.data):
        source = dataclasses.replace(source, given=workbook_grid(source))
    elif is_matlab(source.data):
        source = dataclasses.replace(source, given=matlab_grid(source))
    elif is_numpy(source.data):
        source = dataclasses.replace(source, given=numpy_grid(source))
    elif is_program(source):
        source = dataclasses.replace(source, given=program_grid(source))
    return with_numbered_markers(in_one_row(with_whole_headers(source)))


def _assembled(
    draft: Draft,
    columns: Written,
    settings: dict[str, Any],
    robot: Robot,
    prismatic: tuple[str, ...],
) -> Measurements:
    path = draft.sheet.path
    rows = [list(row) for row in zip(*(cells for _, cells in columns), strict=True)]
    table = table_of(path, [header for header, _ in columns], 1, rows, list(draft.sheet.lines))
    file = settings_of(settings, path.with_suffix(".yaml"))
    digest = hashlib.sha256(repr((columns, settings)).encode()).hexdigest()
    return assembled(table, file, digest, robot.actuated, prismatic)
