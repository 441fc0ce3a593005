"""Files or sheets that hold one pose each, which their names tell."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from sk120stiff.measurements.importers.campaign.before_load import APART
from sk120stiff.measurements.importers.campaign.by_label import labels_of
from sk120stiff.measurements.importers.contract import FILE, Column, Sheet
from sk120stiff.measurements.importers.numbered_names import (
    OF_FILES,
    OF_SHEETS,
    NameLabel,
)
from sk120stiff.measurements.importers.told import Told, numbers

ENCODERS = 1e-3  # by so much joint values of one pose may differ, where no unit is known
_NUMBER = re.compile(r"\d+")


def with_label(sheet: Sheet, label: NameLabel | None, other: Sheet) -> Sheet:
    """The rows of one file with the pose that its name tells, where another file has that pose, or
    names this file.

    Without a word for a pose in the names, the numbers of all files have to be those of the poses.
    """
    if sheet.get("pose") is not None:
        return sheet
    for column in labels_of(other):
        called = [each for each in (sheet.path.name, sheet.path.stem) if each in column.cells]
        if called:
            name = frozenset(called[:1])
            return _labelled(sheet, NameLabel(called[0], name, said=True, stated=OF_FILES))
        if label is None:
            continue
        theirs = set(column.cells)
        if label.text in theirs and (label.said or label.others == theirs):
            return _labelled(sheet, label)
        mine, counts = _last(label.text), {_last(cell) for cell in theirs}
        alike = counts == {_last(text) for text in label.others}
        if None not in counts and mine in counts and (label.said or alike):
            return _labelled(sheet, label)
    return sheet


def with_poses(
    sheets: Sequence[Sheet], labels: Sequence[NameLabel] | None, told: Told
) -> list[Sheet]:
    """The files of a campaign with the poses that their names tell, where each holds one pose."""
    if labels is None or len(sheets) < 2:
        return list(sheets)
    own = any((column := s.get("pose")) and not of_names(column) for s in sheets)
    if not own and all(_is_one_pose(sheet, told) for sheet in sheets):
        first, last = labels[0].text, labels[-1].text
        said = f"Each holds one pose, labelled after {labels[0].stated}: {first} to {last}."
        pairs = zip(sheets, labels, strict=True)
        return [_labelled(each, label).noting(said) for each, label in pairs]
    return [s.exchanged([c for c in s.those("pose") if of_names(c)]) for s in sheets]


def of_names(column: Column) -> bool:
    """Is it a column of labels that the names of files or sheets tell?"""
    return column.header == FILE and column.stated in (OF_FILES, OF_SHEETS)


def _labelled(sheet: Sheet, label: NameLabel) -> Sheet:
    if sheet.get("pose") is not None:
        return sheet
    cells = (label.text,) * len(sheet.lines)
    return sheet.exchanged((), Column(FILE, "pose", None, label.stated, cells))


def _is_one_pose(sheet: Sheet, told: Told) -> bool:
    joints = [c for c in sheet.columns if c.meaning.startswith("joint ")]
    if not joints:
        return False
    for column in joints:
        limit = APART.get(column.unit or told.angle or "", ENCODERS)
        if np.ptp(numbers(sheet, column)) > limit:
            return False
    return True


def _last(text: str) -> int | None:
    found = _NUMBER.findall(text.removesuffix(".0"))
    return int(found[-1]) if found else None
