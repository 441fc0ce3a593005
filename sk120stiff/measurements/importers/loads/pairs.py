"""Rows that hold a pose twice, ``x unloaded`` and ``x loaded``, as two readings each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from typing import Literal, TypeVar

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.columns.unread_axes import GAUGE
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.told import numbers, two_units
from sk120stiff.measurements.table.columns import FORCES, MOMENTS, POSITIONS

T = TypeVar("T")

LOADS = (*FORCES, *MOMENTS, "payload", "load")
_OWN = {  # has every row a zero reading of its own?
    True: "Every row has a zero reading of its own (displacement: {zero: separate}).",
    False: "Rows of one pose share a zero reading (displacement: {zero: shared}).",
}
_ZERO: dict[bool, Literal["separate", "shared"]] = {True: "separate", False: "shared"}
_OF_ONE = ("order", "time")  # of two readings, which one it was is not said


def unfolded(sheet: Sheet) -> Sheet:
    """The sheet with a row without load before each row under load, N → 2 N.

    Of one axis or two alone, and of a gauge's direction, rows become displacements instead.
    Where no two rows have the same reading without load, each has one of its own.

    A sheet without columns of both kinds comes back as it is.

    Raises:
        InputError: Half of the pairs is missing, their units differ, or no column says the load.
    """
    names = [f"{kind} {axis}" for kind in (WITHOUT, WITH) for axis in POSITIONS]
    if not sheet.those(*names, f"{WITH} {GAUGE}"):
        return sheet
    some = _differences(sheet)
    if some is not None:
        return some
    missing = [name for name in names if not sheet.get(name)]
    if missing:
        raise InputError(
            f"of the readings with and without load the columns {', '.join(missing)} are not there",
            where=str(sheet.path),
            remedy="Name the columns with --columns: 'x_unloaded,y_unloaded,z_unloaded,x_loaded,"
            "y_loaded,z_loaded', or 'x,y,z' where one reading alone counts.",
        )
    _refuse_no_load(sheet)
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
            raise two_units(sheet, free, pushed)
        header = f"{free.header}, {pushed.header}"
        cells = _woven(free.cells, pushed.cells)
        columns.append(replace(free, header=header, meaning=axis, cells=cells))
    free_cells = [c.cells for c in sheet.those(*names[: len(POSITIONS)])]
    own = len(set(zip(*free_cells, strict=True))) == len(sheet.lines)
    left = tuple(
        f"column {c.header}: one for two readings" for c in sheet.columns if c.meaning in _OF_ONE
    )
    whole = replace(
        sheet,
        columns=tuple(columns),
        lines=_woven(sheet.lines, sheet.lines),
        rank=tuple(range(2 * len(sheet.lines))),
        total=2 * len(sheet.lines),
        spare=tuple(replace(c, cells=_woven(c.cells, c.cells)) for c in sheet.spare),
        unused=(*sheet.unused, *left),
        notes=(
            *sheet.notes,
            "Each row is two readings, without load and with the load that it states. " + _OWN[own],
        ),
        zero=_ZERO[own],
    )
    return whole if own else whole.rows(_once(whole))


def _once(whole: Sheet) -> list[int]:
    """Rows of readings, those without load that come again left out: one serves several loads."""
    seen: set[tuple[str, ...]] = set()
    kept = []
    for row in range(len(whole.lines)):
        cells = tuple(column.cells[row] for column in whole.columns)
        if row % 2 or cells not in seen:
            kept.append(row)
        seen.add(cells)
    return kept


def _refuse_no_load(sheet: Sheet) -> None:
    if not sheet.those(*LOADS):
        raise InputError(
            "positions stand there with and without load, and no column says the load",
            where=str(sheet.path),
            remedy="Add the columns fx[N], fy[N], fz[N] or payload[kg], or give --loads-file; with "
            "--before one load in all rows is --wrench '0,0,-490 N'.",
        )


def _differences(sheet: Sheet) -> Sheet | None:
    """Displacements of readings with and without load along some axes or along a direction.

    A dial gauge reads one axis, and where the others were is not known: no position, but what the
    load moved is the difference. None where all three axes are there, or half of a pair.

    Raises:
        InputError: As `unfolded`.
    """
    known = (*POSITIONS, GAUGE)
    words = [w for w in known if sheet.those(f"{WITHOUT} {w}", f"{WITH} {w}")]
    pairs = {
        word: (free, pushed)
        for word in words
        if (free := sheet.get(f"{WITHOUT} {word}")) and (pushed := sheet.get(f"{WITH} {word}"))
    }
    if len(pairs) < len(words) or set(POSITIONS) <= set(words):
        return None
    _refuse_no_load(sheet)
    made, said = [], []
    for word, (free, pushed) in pairs.items():
        if free.unit != pushed.unit:
            raise two_units(sheet, free, pushed)
        for column in (free, pushed):
            numbers(sheet, column)
        both = zip(free.cells, pushed.cells, strict=True)
        cells = tuple(str(Decimal(after) - Decimal(before)) for before, after in both)
        header = f"{pushed.header} less {free.header}"
        meaning = word if word == GAUGE else f"d{word}"
        made.append(replace(pushed, header=header, meaning=meaning, cells=cells))
        said.append(f"{meaning if word != GAUGE else 'the gauge'} is {header}")
    own = _read_anew(sheet, [free.cells for free, _ in pairs.values()])
    taken = [column for pair in pairs.values() for column in pair]
    return replace(
        sheet,
        columns=(*(c for c in sheet.columns if not any(c is t for t in taken)), *made),
        notes=(
            *sheet.notes,
            f"Displacements are readings with load less those without: {listed(said)}. {_OWN[own]}",
        ),
        zero=_ZERO[own],
        subtracted=True,
    )


def _read_anew(sheet: Sheet, before: Sequence[tuple[str, ...]]) -> bool:
    """Do readings without load differ from row to row of a pose? Of one axis, two rows of other
    poses may well have the same."""
    at = [c.cells for c in sheet.columns if c.meaning == "pose" or c.meaning.startswith("joint ")]
    poses: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    labels = zip(*(at or [tuple(map(str, sheet.lines))]), strict=True)
    for pose, zero in zip(labels, zip(*before, strict=True), strict=True):
        poses.setdefault(pose, []).append(zero)
    again = [len(set(zeros)) > 1 for zeros in poses.values() if len(zeros) > 1]
    return not again or sum(again) * 2 > len(again)


def _woven(first: Sequence[T], second: Sequence[T]) -> tuple[T, ...]:
    return tuple(item for pair in zip(first, second, strict=True) for item in pair)
