"""A sheet of an Excel workbook (.xlsx) as rows of cells."""

from __future__ import annotations

import datetime as dt
import io
import re
from dataclasses import replace
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

from sk120stiff.errors import InputError, require
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.formats.workbook_sheets import load_state
from sk120stiff.measurements.importers.grid import Grid, is_number, with_points
from sk120stiff.measurements.importers.layout.header_rows import in_one_row
from sk120stiff.measurements.importers.layout.joints_above import with_joints_above
from sk120stiff.measurements.importers.layout.layout import Layout, layout_of
from sk120stiff.measurements.importers.numbered_names import in_order, without_numbers

_MARKERS = re.compile(r"(?:marker|smr|target|reflector|reflektor|prism)", re.IGNORECASE)
_OLD = b"\xd0\xcf\x11\xe0"


def is_workbook(data: bytes) -> bool:
    """Is this a workbook: a zip archive with sheets, or the older .xls?"""
    return data.startswith(_OLD) or (data.startswith(b"PK\x03\x04") and b"xl/" in data)


def workbook_grid(source: Source) -> Grid:
    """The sheet that was named, else the only one that holds what is needed, or the one of several
    whose name says the state, unloaded or loaded, that is asked for.

    Raises:
        InputError: An .xls file, no such sheet, several, or formulas without values.
        MissingPart: openpyxl is not installed.
    """
    where = str(source.path)
    sheets = _sheets(source)
    if source.sheet is not None:
        if source.sheet not in sheets:
            raise InputError(
                f"no sheet with rows is called {source.sheet!r}",
                where=where,
                remedy=f"There are {', '.join(sheets)}.",
            )
        grid = _with_others(sheets, source.sheet)
        one = f"sheet {source.sheet} of"  # of a campaign each would be told
        return replace(grid, how=grid.how.replace(one, "sheets of", 1)) if source.parts else grid
    fit = _with_headers(source, sheets)
    fit = fit or [n for n, g in sheets.items() if any(map(_numbers, g.rows))]
    if len(fit) > 1:
        fit = [name for name in fit if name != source.beside]
    if len(fit) > 1 and source.state is not None:
        fit = [name for name in fit if load_state(name) == source.state] or fit
    if len(fit) != 1:
        raise (
            _several(source, sheets, fit)
            if fit
            else InputError("no sheet holds readings", where=where, remedy="Check the file.")
        )
    return _with_others(sheets, fit[0])


def fitting_sheets(source: Source) -> list[str]:
    """Names of the sheets whose headers name what the file was given for.

    Raises:
        InputError, MissingPart: As `workbook_grid`.
    """
    return _with_headers(source, _sheets(source))


def _with_headers(source: Source, sheets: dict[str, Grid]) -> list[str]:
    return [n for n, grid in sheets.items() if _holds(replace(source, given=grid))]


def parts_of(source: Source) -> list[str]:
    """The sheets of a workbook that are read as one campaign, where no sheet was told: those whose
    names are alike but for their numbers, with the same columns; else all with readings, if they
    have the same columns and each is of one pose by its joints, or by its name in another sheet.
    Empty where they are no campaign.

    Raises:
        InputError, MissingPart: As `workbook_grid`.
    """
    if source.sheet is not None or source.path.is_dir() or not is_workbook(source.data):
        return []
    if source.columns is not None or source.data.startswith(_OLD):
        return []
    tables: dict[str, Layout] = {}
    one_pose = True
    sheets = _sheets(source)
    for name, grid in sheets.items():
        each = with_joints_above(in_one_row(replace(source, given=grid)))
        table = layout_of(each)
        if table is not None:
            tables[name], one_pose = table, one_pose and _is_one_pose(each.grid, table)
    if any(load_state(name) for name in tables):
        return []
    alike: dict[str, list[str]] = {}
    for name in tables:
        if not _MARKERS.match(name):
            alike.setdefault(without_numbers(name), []).append(name)
    numbered = max(alike.values(), key=len, default=[])
    if len(numbered) < 2:
        others = [grid for name, grid in sheets.items() if name not in tables]
        one_pose = one_pose or any(_names(grid, set(tables)) for grid in others)
        numbered = list(tables) if one_pose and len(tables) > 1 else []
    kinds = {(tables[name].meanings, tables[name].units) for name in numbered}
    return in_order(numbered) if len(kinds) == 1 else []


def _is_one_pose(grid: Grid, table: Layout) -> bool:
    """Are all joint values of a table the same, cell by cell?"""
    joints = [k for k, m in enumerate(table.meanings) if m and m[0].startswith("joint ")]
    rows = [row for row in grid.rows[table.first :] if any(map(is_number, row))]
    return bool(joints) and all(len({row[k] for row in rows if k < len(row)}) == 1 for k in joints)


def all_sheets(source: Source) -> list[Grid]:
    """All sheets with rows.

    Raises:
        InputError, MissingPart: As `workbook_grid`.
    """
    return list(_sheets(source).values())


def _names(grid: Grid, titles: set[str]) -> bool:
    """Do all of these stand in one column?"""
    return any(titles <= set(column) for column in zip_longest(*grid.rows))


def _sheets(source: Source) -> dict[str, Grid]:
    """Sheets with rows by their names."""
    return _read(source.path, source.data)


@lru_cache(maxsize=2)  # each sheet of a campaign is sought in the whole workbook
def _read(path: Path, data: bytes) -> dict[str, Grid]:
    where = str(path)
    if data.startswith(_OLD):
        raise InputError(
            "this is a workbook of the older kind (.xls)",
            where=where,
            remedy="Save it as .xlsx or CSV.",
        )
    require("openpyxl", needed_for="reading an Excel workbook")
    import openpyxl

    try:
        book, formulas = (
            openpyxl.load_workbook(io.BytesIO(data), data_only=values) for values in (True, False)
        )
    except Exception as error:  # whatever a broken archive makes of it
        raise InputError(
            f"this workbook cannot be read ({error})", where=where, remedy="Save it once more."
        ) from error
    return {s.title: _grid(path, s, formulas[s.title]) for s in book.worksheets if s.max_row > 1}


def _with_others(sheets: dict[str, Grid], name: str) -> Grid:
    others = tuple(f"sheet {other}" for other in sheets if other != name)
    return replace(sheets[name], left=others)


def _several(source: Source, sheets: dict[str, Grid], fit: list[str]) -> InputError:
    role = f"{source.called}=" if source.called else ""
    pushed = [name for name in fit if load_state(name) == WITH]
    free = [name for name in fit if load_state(name) == WITHOUT]
    with_joints = [n for n in fit if _holds(replace(source, given=sheets[n], role="joints"))]
    apart = len(fit) == len(with_joints) + 1 and len(with_joints) == 1 and not source.called
    readings = next((name for name in fit if name not in with_joints), "")
    both = len(pushed) == len(free) == 1 and not source.called
    return InputError(
        f"the sheets {', '.join(fit)} hold readings",
        where=str(source.path),
        remedy=f"Choose one: --sheet '{role}{fit[0]}'."
        + (
            f" If they are the same poses without and with a load: --sheet '{pushed[0]}' --before "
            f"{source.path.name}."
            if both
            else ""
        )
        + (
            f" If {with_joints[0]} has the joints, and positions that the robot itself says: "
            f"--sheet '{readings}' --sheet 'joints={with_joints[0]}'."
            if apart
            else ""
        ),
    )


def _holds(source: Source) -> bool:
    return layout_of(in_one_row(source)) is not None


def _numbers(row: tuple[str, ...]) -> bool:
    return sum(map(is_number, row)) > 2


def _grid(path: Path, sheet: Any, formulas: Any) -> Grid:
    rows, lines = [], []
    merged = _merged(sheet)
    for number, (cells, written) in enumerate(
        zip(sheet.iter_rows(values_only=True), formulas.iter_rows(values_only=True), strict=True), 1
    ):
        for value, text in zip(cells, written, strict=True):
            if value is None and isinstance(text, str) and text.startswith("="):
                raise InputError(
                    f"the formula {text!r} has no stored value",
                    where=f"{path}, sheet {sheet.title}, line {number}",
                    remedy="Open the workbook in its program, save it, and try again.",
                )
        filled = (merged.get((number, k), cell) for k, cell in enumerate(cells, 1))
        row = tuple(_text(cell) for cell in filled)
        if any(row):
            rows.append(row)
            lines.append(number)
    how = f"sheet {sheet.title} of an Excel workbook"
    part = f"sheet {sheet.title}, "
    grid = Grid(path, tuple(rows), tuple(lines), (), how, part, sheet=sheet.title)
    return with_points(grid) if rows else grid


def _merged(sheet: Any) -> dict[tuple[int, int], object]:
    """Row and column → value of cells that are merged with one above: it holds for all of them.

    What is merged across columns is a title or stands above several headers: its first column
    alone is filled.
    """
    return {
        (row, area.min_col): sheet.cell(area.min_row, area.min_col).value
        for area in sheet.merged_cells.ranges
        for row in range(area.min_row + 1, area.max_row + 1)
    }


def _text(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        return repr(value)
    return value.isoformat() if isinstance(value, dt.datetime) else str(value).strip()
