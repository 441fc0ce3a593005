"""A sheet of an Excel workbook (.xlsx) as rows of cells."""

from __future__ import annotations

import datetime as dt
import io
from dataclasses import replace
from typing import Any

from sk120stiff.errors import InputError, require
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid, is_number, with_points
from sk120stiff.measurements.importers.header_rows import in_one_row
from sk120stiff.measurements.importers.layout import layout_of

_OLD = b"\xd0\xcf\x11\xe0"


def is_workbook(data: bytes) -> bool:
    """Is this a workbook: a zip archive with sheets, or the older .xls?"""
    return data.startswith(_OLD) or (data.startswith(b"PK\x03\x04") and b"xl/" in data)


def workbook_grid(source: Source) -> Grid:
    """The sheet that was named, else the only one that holds what is needed.

    Raises:
        InputError: An .xls file, no such sheet, several, or formulas without values.
        MissingPart: openpyxl is not installed.
    """
    where = str(source.path)
    if source.data.startswith(_OLD):
        raise InputError(
            "this is a workbook of the older kind (.xls)",
            where=where,
            remedy="Save it as .xlsx or CSV.",
        )
    require("openpyxl", needed_for="reading an Excel workbook")
    import openpyxl

    try:
        book, formulas = (
            openpyxl.load_workbook(io.BytesIO(source.data), data_only=values)
            for values in (True, False)
        )
    except Exception as error:  # whatever a broken archive makes of it
        raise InputError(
            f"this workbook cannot be read ({error})", where=where, remedy="Save it once more."
        ) from error
    sheets = {
        s.title: _grid(source, s, formulas[s.title]) for s in book.worksheets if s.max_row > 1
    }
    if source.sheet is not None:
        if source.sheet not in sheets:
            raise InputError(
                f"no sheet with rows is called {source.sheet!r}",
                where=where,
                remedy=f"There are {', '.join(sheets)}.",
            )
        return sheets[source.sheet]
    fit = {n: g for n, g in sheets.items() if _has_headers(replace(source, given=g))}
    fit = fit or {n: g for n, g in sheets.items() if any(map(_numbers, g.rows))}
    if len(fit) != 1:
        raise InputError(
            f"the sheets {', '.join(fit)} hold readings" if fit else "no sheet holds readings",
            where=where,
            remedy=f"Choose one: --sheet '{next(iter(fit))}'." if fit else "Check the file.",
        )
    (grid,) = fit.values()
    others = tuple(f"sheet {name}" for name in sheets if sheets[name] is not grid)
    return replace(grid, left=others)


def _has_headers(source: Source) -> bool:
    return layout_of(in_one_row(source)) is not None


def _numbers(row: tuple[str, ...]) -> bool:
    return sum(map(is_number, row)) > 2


def _grid(source: Source, sheet: Any, formulas: Any) -> Grid:
    rows, lines = [], []
    merged = _merged(sheet)
    for number, (cells, written) in enumerate(
        zip(sheet.iter_rows(values_only=True), formulas.iter_rows(values_only=True), strict=True), 1
    ):
        for value, text in zip(cells, written, strict=True):
            if value is None and isinstance(text, str) and text.startswith("="):
                raise InputError(
                    f"the formula {text!r} has no stored value",
                    where=f"{source.path}, sheet {sheet.title}, line {number}",
                    remedy="Open the workbook in its program, save it, and try again.",
                )
        filled = (merged.get((number, k), cell) for k, cell in enumerate(cells, 1))
        row = tuple(_text(cell) for cell in filled)
        if any(row):
            rows.append(row)
            lines.append(number)
    how = f"sheet {sheet.title} of an Excel workbook"
    grid = Grid(source.path, tuple(rows), tuple(lines), (), how, f"sheet {sheet.title}, ")
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
