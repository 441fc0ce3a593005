"""Which row of another file each reading belongs to, by the labels of both.

Labels of one file may be written otherwise than those of another: ``P1`` there and ``Pose 1`` or
``1`` here. And their column may have a header that is not understood.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

from sk120stiff.measurements.importers.contract import FILE, Column, Sheet

SHARED = 0.5  # of the names of the shorter file, from which on names decide
_COUNTED = re.compile(r"(?P<word>.*?)[\s_.\-#:]*(?P<number>\d+)(?:\.0+|\.[A-Za-z]\w{1,4})?")
Keys = tuple[str, ...] | None  # what is compared instead of labels; None where they have none such

_Comparison = Callable[[tuple[str, ...], tuple[str, ...]], tuple[Keys, Keys]]


@dataclass(frozen=True)
class ByLabel:
    """Columns of labels that agree.

    Attributes:
        mine, theirs: The columns, of the readings and of the other file.
        keys, other_keys: What agrees of them, row by row.
        shared: Those of both files.
        how: How they were compared, in words; empty where letter by letter.
    """

    mine: Column
    theirs: Column
    keys: tuple[str, ...]
    other_keys: tuple[str, ...]
    shared: frozenset[str]
    how: str

    @property
    def agreeing(self) -> tuple[int, int]:
        """How many labels are in both files, and how many readings have one of them."""
        return len(self.shared), sum(key in self.shared for key in self.keys)

    @property
    def enough(self) -> bool:
        """Do so many agree that the others are rows without a partner?"""
        least = min(len(set(self.keys)), len(self.other_keys))
        return len(self.shared) >= SHARED * least


def label_of(sheet: Sheet) -> Column | None:
    """The column of names, else that of poses if every row has one."""
    return next(iter(labels_of(sheet)), None)


def labels_of(sheet: Sheet) -> list[Column]:
    """The columns of names and of poses, the latter if every row has one; where the name of the
    file told the pose, that alone: names of its rows may be those of other poses' rows, too."""
    pose = sheet.get("pose")
    if pose is not None and pose.header == FILE:
        return [pose]
    return [*sheet.those("name"), *([pose] if pose is not None and all(pose.cells) else [])]


def by_label(points: Sheet, other: Sheet) -> ByLabel | None:
    """The labels of both that agree best, letter by letter, else by their numbers; None where no
    label is in both files, or one comes twice in the other.

    A column that no header explains is one of labels where it holds those of the other file.
    """
    own, theirs = labels_of(points), labels_of(other)
    found = _best(own, theirs, _letters, "")
    if found is None or not found.enough:
        numbered = _best(own, theirs, _numbers, "by their numbers")
        inside = numbered is not None and set(numbered.keys) <= set(numbered.other_keys)
        found = numbered if inside else found
    if found is None or found.agreeing[1] < len(found.keys):
        unknown = [
            _best([*own, *points.spare], [*theirs, *other.spare], keys, how)
            for keys, how in ((_letters, "by what they hold"), (_numbers, "by their numbers"))
        ]
        found = next((each for each in unknown if each and _is_same(each)), found)
    return found


def _best(
    own: Sequence[Column], theirs: Sequence[Column], keys_of: _Comparison, how: str
) -> ByLabel | None:
    best: ByLabel | None = None
    for mine, column in product(own, theirs):
        keys, others = keys_of(mine.cells, column.cells)
        if keys is None or others is None or len(set(others)) < len(others):
            continue
        shared = frozenset(keys) & frozenset(others)
        each = ByLabel(mine, column, keys, others, shared, how)
        if shared and (best is None or each.agreeing > best.agreeing):
            best = each
    return best


def _is_same(found: ByLabel) -> bool:
    """Are the labels of both the same without exception, so that no chance made them agree?"""
    return len(found.shared) == len(set(found.keys)) == len(found.other_keys) > 1


def _letters(own: tuple[str, ...], theirs: tuple[str, ...]) -> tuple[Keys, Keys]:
    return own, theirs


def _numbers(own: tuple[str, ...], theirs: tuple[str, ...]) -> tuple[Keys, Keys]:
    """The numbers behind one word each, where one word begins with the other, as Pose with P."""
    (word, keys), (other, others) = _counted(own), _counted(theirs)
    short, long = sorted((word, other), key=len)
    return (keys, others) if long.startswith(short) else (None, None)


def _counted(cells: Sequence[str]) -> tuple[str, Keys]:
    """The one word before all numbers, in small letters, and these; None where it is not so."""
    found = [_COUNTED.fullmatch(cell.strip()) for cell in cells]
    words = {match["word"].strip().lower() if match else None for match in found}
    if len(words) != 1 or None in words:
        return "", None
    return str(words.pop()), tuple(str(int(match["number"])) for match in found if match)
