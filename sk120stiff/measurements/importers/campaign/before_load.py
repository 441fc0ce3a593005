"""Positions of the same poses without load, in a file of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.campaign.by_label import label_of
from sk120stiff.measurements.importers.campaign.pairing import paired
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.loads.pairs import LOADS
from sk120stiff.measurements.importers.told import Told, numbers
from sk120stiff.measurements.table.columns import POSITIONS

APART = {"deg": 0.06, "°": 0.06, "rad": 1e-3}  # of joint values of one pose: an encoder's jitter

_OF_BEFORE = "before "  # stands before the meaning of joints, which both files may hold


def with_before(sheet: Sheet, before: Sheet, told: Told) -> Sheet:
    """The positions under load, with those without as ``unloaded x`` and so on in the same row.

    Rows belong together by their names, else by order.

    Args:
        sheet: The positions under load.
        before: The positions without.
        told: With `Told.wrench`, and without a column that says the load, it acts in every row.

    Raises:
        InputError: One of the files holds no positions, the first a load, the names or the joints
            of the rows do not agree, or no row has a partner.
    """
    for each in (sheet, before):
        if not each.has(*POSITIONS):
            raise InputError(
                "this file holds no positions x, y, z, and with --before both files do",
                where=str(each.path),
                remedy="Give the positions under load as FILE and those without as --before.",
            )
    _refuse_loads(before)
    mine, theirs = label_of(sheet), label_of(before)
    if mine and theirs and len(set(theirs.cells)) < len(theirs.cells):
        _refuse_other_names(sheet, before, mine, theirs)
    apart = replace(before, columns=_renamed(before, WITHOUT))
    pushed = replace(sheet, columns=_renamed(sheet, WITH))
    whole = paired(pushed, _labelled(apart), "positions without load")
    _refuse_the_same(whole, before)
    whole = _with_joints_once(whole, told)
    if told.wrench is not None and not whole.those(*LOADS):
        count = Column("--wrench", "load", None, "", ("1",) * len(whole.lines))
        whole = whole.exchanged((), count)
    whole = replace(whole, title=f"{sheet.title}, with {before.path.name}")
    return whole.noting(f"The positions of {sheet.path.name} are under load.")


def _renamed(sheet: Sheet, kind: str) -> tuple[Column, ...]:
    return tuple(
        replace(c, meaning=f"{kind} {c.meaning}") if c.meaning in POSITIONS else c
        for c in sheet.columns
    )


def _labelled(before: Sheet) -> Sheet:
    """Its joints under meanings of their own, to be held against those of the other file."""
    columns = tuple(
        replace(c, meaning=_OF_BEFORE + c.meaning) if c.meaning.startswith("joint ") else c
        for c in before.columns
    )
    return replace(before, columns=columns)


def _refuse_loads(before: Sheet) -> None:
    for column in before.those(*LOADS):
        values = numbers(before, column)
        if values.any():
            raise InputError(
                "a load stands in the file of positions without load",
                where=before.place(column, int(np.flatnonzero(values)[0])),
                remedy="Give the file without load as --before, and the other as FILE; if both "
                "are under load, put the rows into one file with their loads.",
            )


def _refuse_the_same(whole: Sheet, before: Sheet) -> None:
    pairs = [(whole.get(f"{WITHOUT} {a}"), whole.get(f"{WITH} {a}")) for a in POSITIONS]
    if all(free and pushed and free.cells == pushed.cells for free, pushed in pairs):
        raise InputError(
            "the positions with and without load are the same to the last digit",
            where=f"{whole.path} and {before.path}",
            remedy="Give the positions under load as FILE and those without as --before.",
        )


def _refuse_other_names(sheet: Sheet, before: Sheet, mine: Column, theirs: Column) -> None:
    """Names that come twice tell no partner: they have to agree row by row."""
    if mine.cells == theirs.cells:
        return
    twice = next(name for name in theirs.cells if theirs.cells.count(name) > 1)
    raise InputError(
        f"{twice} stands there more than once, and the rows of both files are not the same",
        where=f"{before.path} and {sheet.path}",
        remedy="Give every reading a name of its own, the same in both files; or the same rows in "
        "the same order.",
    )


def _with_joints_once(whole: Sheet, told: Told) -> Sheet:
    """Joints of either file; where both hold them they are the same.

    Raises:
        InputError: They are not.
    """
    columns: list[Column] = []
    for column in whole.columns:
        if not column.meaning.startswith(_OF_BEFORE):
            columns.append(column)
            continue
        own = replace(column, meaning=column.meaning.removeprefix(_OF_BEFORE))
        other = whole.get(own.meaning)
        if other is None:
            columns.append(own)
            continue
        limit = APART.get(own.unit or told.angle or "")
        apart = np.abs(numbers(whole, own) - numbers(whole, other))
        if limit is not None and own.unit == other.unit and apart.max() > limit:
            row = int(np.argmax(apart))
            raise InputError(
                f"{other.header} is {other.cells[row]} under load and {own.cells[row]} without: "
                "another pose",
                where=f"{whole.path}, line {whole.lines[row]}, and {own.file}",
                remedy="Both files hold the same poses, in the same order or under the same names.",
            )
    return replace(whole, columns=tuple(columns))
