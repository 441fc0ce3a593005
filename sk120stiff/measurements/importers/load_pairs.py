"""Rows that hold a pose twice, ``x unloaded`` and ``x loaded``, as two readings each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.load_states import WITH, WITHOUT

T = TypeVar("T")

POSITIONS = ("x", "y", "z")
LOADS = ("fx", "fy", "fz", "mx", "my", "mz", "payload", "load")
_OF_ONE = ("order", "time")  # of two readings, which one it was is not said


def unfolded(sheet: Sheet) -> Sheet:
    """The sheet with a row without load before each row under load, N → 2 N.

    Where no two rows have the same reading without load, each has one of its own.

    A sheet without columns of both kinds comes back as it is.

    Raises:
        InputError: Half of the pairs is missing, their units differ, or no column says the load.
    """
    names = [f"{kind} {axis}" for kind in (WITHOUT, WITH) for axis in POSITIONS]
    if not any(sheet.get(name) for name in names):
        return sheet
    missing = [name for name in names if not sheet.get(name)]
    if missing:
        raise InputError(
            f"of the readings with and without load the columns {', '.join(missing)} are not there",
            where=str(sheet.path),
            remedy="Name the columns with --columns: 'x_unloaded,y_unloaded,z_unloaded,x_loaded,"
            "y_loaded,z_loaded', or 'x,y,z' where one reading alone counts.",
        )
    if not any(sheet.get(name) for name in LOADS):
        raise InputError(
            "positions stand there with and without load, and no column says the load",
            where=str(sheet.path),
            remedy="Add the columns fx[N], fy[N], fz[N] or payload[kg], or give --loads-file; with "
            "--before one load in all rows is --wrench '0,0,-490 N'.",
        )
    columns: list[Column] = []
    for column in sheet.columns:
        if column.meaning in (*names, *_OF_ONE):
            continue
        before = ("0",) * len(column.cells) if column.meaning in LOADS else column.cells
        columns.append(replace(column, cells=_woven(before, column.cells)))
    for axis in POSITIONS:
        free, pushed = (sheet.get(f"{kind} {axis}") for kind in (WITHOUT, WITH))
        if free is None or pushed is None:
            continue
        if free.unit != pushed.unit:
            raise InputError(
                f"{free.header} and {pushed.header} have different units",
                where=str(sheet.path),
                remedy="Export both in one unit.",
            )
        header = f"{free.header}, {pushed.header}"
        cells = _woven(free.cells, pushed.cells)
        columns.append(replace(free, header=header, meaning=axis, cells=cells))
    free_cells = [c.cells for axis in POSITIONS if (c := sheet.get(f"{WITHOUT} {axis}"))]
    own = len(set(zip(*free_cells, strict=True))) == len(sheet.lines)
    left = tuple(
        f"column {c.header}: one for two readings" for c in sheet.columns if c.meaning in _OF_ONE
    )
    return replace(
        sheet,
        columns=tuple(columns),
        lines=_woven(sheet.lines, sheet.lines),
        rank=tuple(range(2 * len(sheet.lines))),
        total=2 * len(sheet.lines),
        spare=tuple(replace(c, cells=_woven(c.cells, c.cells)) for c in sheet.spare),
        unused=(*sheet.unused, *left),
        notes=(
            *sheet.notes,
            "Each row is two readings, without load and with the load that it states. "
            + (
                "Every row has a zero reading of its own (displacement: {zero: separate})."
                if own
                else "Rows of one pose share a zero reading (displacement: {zero: shared})."
            ),
        ),
        zero="separate" if own else "shared",
    )


def _woven(first: Sequence[T], second: Sequence[T]) -> tuple[T, ...]:
    return tuple(item for pair in zip(first, second, strict=True) for item in pair)
