"""A file of readings becomes `Measurements`, with what was understood of it.

Points, joints and loads of separate files are put side by side.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.arrays import Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.files.reading import assembled
from sk120stiff.measurements.importers.campaign.campaign import campaign_of
from sk120stiff.measurements.importers.campaign.pose_of_file import with_poses
from sk120stiff.measurements.importers.contract import Formats, Source
from sk120stiff.measurements.importers.drafting import Draft, Written, drafted, paired_loads
from sk120stiff.measurements.importers.formats.catalogue import FORMATS
from sk120stiff.measurements.importers.formats.workbook_sheets import (
    named_sheets,
)
from sk120stiff.measurements.importers.holds.holds import as_repeats
from sk120stiff.measurements.importers.holds.log import standstills
from sk120stiff.measurements.importers.joint_units import blank_doubts, unit_doubts
from sk120stiff.measurements.importers.loads.hung_masses import (
    doubts_of_names,
    refuse_other_files,
    say_masses,
    with_masses_of_all,
)
from sk120stiff.measurements.importers.one_file import FilesBeside, read_file
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
    given = Source(
        Path(paths[0]), robot.actuated, "points", tuple(columns) if columns else None,
        of_sheets.get(""), topic, marker,
    )  # fmt: skip
    campaign = campaign_of(given, [Path(one) for one in paths], alone=before is not None)
    refuse_other_files(campaign.names, told)
    beside = FilesBeside(of_sheets, before, joints_file, loads_file)
    sheets = [
        read_file(source, formats, format_name, beside, told, campaign)
        for source in campaign.sources
    ]
    sheets = with_poses(with_masses_of_all(sheets), campaign.labels, told)
    whole = campaign.whole(sheets).noting(*say_masses(sheets))
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
