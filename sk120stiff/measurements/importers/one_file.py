"""One file of readings, with those of the files beside it: before, joints, loads."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sk120stiff.measurements.importers.campaign.before_load import with_before
from sk120stiff.measurements.importers.campaign.campaign import Campaign
from sk120stiff.measurements.importers.campaign.pairing import paired
from sk120stiff.measurements.importers.campaign.pose_of_file import with_label
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.columns.not_taken import refuse_image_files
from sk120stiff.measurements.importers.columns.orientations import named
from sk120stiff.measurements.importers.columns.rows_in_words import understood_words
from sk120stiff.measurements.importers.contract import Formats, Role, Sheet, Source
from sk120stiff.measurements.importers.formats.matlab import is_matlab, matlab_grid
from sk120stiff.measurements.importers.formats.numpy_archive import is_numpy, numpy_grid
from sk120stiff.measurements.importers.formats.robot_program import is_program, program_grid
from sk120stiff.measurements.importers.formats.workbook import (
    fitting_sheets,
    is_workbook,
    workbook_grid,
)
from sk120stiff.measurements.importers.formats.workbook_sheets import under_load, without_used
from sk120stiff.measurements.importers.layout.header_rows import in_one_row
from sk120stiff.measurements.importers.layout.joints_above import with_joints_above
from sk120stiff.measurements.importers.layout.lost_readings import without_lost
from sk120stiff.measurements.importers.layout.markers_in_rows import with_numbered_markers
from sk120stiff.measurements.importers.layout.split_headers import with_whole_headers
from sk120stiff.measurements.importers.loads.hung_masses import with_mass
from sk120stiff.measurements.importers.loads.pairs import LOADS, unfolded
from sk120stiff.measurements.importers.loads.told_mass import with_told_mass
from sk120stiff.measurements.importers.told import Told
from sk120stiff.measurements.importers.tracker.several_markers import of_marker


@dataclass(frozen=True)
class FilesBeside:
    """Files beside that of the readings, where they were told.

    Args:
        sheets: What a sheet of a workbook is for, `workbook_sheets.ROLES` or nothing → its name.
        before, joints, loads: Positions without load, joints, and loads.
    """

    sheets: Mapping[str, str]
    before: Path | None = None
    joints: Path | None = None
    loads: Path | None = None


def read_file(
    source: Source,
    formats: Formats,
    name: str | None,
    files: FilesBeside,
    told: Told,
    campaign: Campaign,
) -> Sheet:
    """The readings of a file of a campaign, with those of the files beside it.

    Raises:
        InputError: A file that cannot be understood, or files that do not belong together.
    """
    sheets, beside = files.sheets, [each.stem for each in campaign.names]
    called, label = campaign.name(source), campaign.label(source)
    before, book = files.before, not source.path.is_dir() and is_workbook(source.data)
    same = book and before is not None and before.resolve() == source.path.resolve()
    if same:
        source = dataclasses.replace(source, state=WITH)
    refuse_image_files(source.path)
    whole = opened(source, above=files.joints is None and "joints" not in sheets)
    importer, why = formats.chosen(whole, name)
    sheet = dataclasses.replace(without_lost(importer.read(whole)), path=called)
    title = whole.grid.sheet if book else None
    used = [*source.parts, *([title] if title else [])]
    if why == "as told":
        sheet = dataclasses.replace(sheet, title=importer.title, why=why)
    if before is not None:
        free = opened(dataclasses.replace(
            source, path=before, sheet=sheets.get("before"), called="before",
            state=WITHOUT if same else None, beside=title if same else None,
        ))  # fmt: skip
        used += [free.given.sheet] if same and free.given and free.given.sheet else []
        sheet = with_before(sheet, without_lost(formats.chosen(free, name)[0].read(free)), told)
    if files.loads is None or told.payloads:
        sheet = with_mass(sheet, told, beside)
    roles: tuple[tuple[Role, Path | None], ...] = (("joints", files.joints), ("loads", files.loads))
    for role, path in roles:
        if path is None and book and _is_elsewhere(sheet, role, source, sheets, used, told):
            path = source.path  # another sheet of the workbook holds them
        if path is None:
            continue
        more = opened(Source(path, source.actuated, role, sheet=sheets.get(role), called=role))
        if path == source.path and more.given and more.given.sheet:
            used.append(more.given.sheet)
        other = formats.chosen(more)[0].read(more)
        if len(beside) > 1:
            sheet = with_label(sheet, label, other)
        sheet = paired(
            sheet, other, role,
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
    elsewhere = fitting_sheets(Source(source.path, source.actuated, role))
    if role == "joints":
        return bool(elsewhere) and not any(c.meaning.startswith("joint ") for c in sheet.columns)
    pushed = under_load(used[0]) if used else False
    if told.wrench is not None or not pushed or sheet.those(*LOADS):
        return False
    return len(elsewhere) == 1


def opened(source: Source, *, above: bool = True) -> Source:
    """The source with its rows, where a workbook, MATLAB, numpy or a robot's program holds them.

    Joint values that stand once `above` the table are columns, unless others were told.
    """
    if is_workbook(source.data):
        source = dataclasses.replace(source, given=workbook_grid(source))
    elif is_matlab(source.data):
        source = dataclasses.replace(source, given=matlab_grid(source))
    elif is_numpy(source.data):
        source = dataclasses.replace(source, given=numpy_grid(source))
    elif is_program(source):
        source = dataclasses.replace(source, given=program_grid(source))
    source = with_numbered_markers(in_one_row(with_whole_headers(source)))
    return with_joints_above(source) if above else source
