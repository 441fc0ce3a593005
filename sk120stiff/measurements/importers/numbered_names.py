"""Numbers in the names of files or sheets: their order, and which pose each is of."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

from sk120stiff.measurements.importers.columns.label_words import says_pose

OF_FILES, OF_SHEETS = "the names of the files", "the names of the sheets"
_NUMBERS = re.compile(r"\d+(?:[.,]\d+)?")
# A mass or a force in a name is no number of a pose.
_LOAD = re.compile(r"\d+(?:[.,p]\d+)?[ _-]?(?:kg|g|lbs?|k?N)(?![^\W_])")
_PARTS = re.compile(r"[^\W\d_]+|\d+")
Named = TypeVar("Named", Path, str)


@dataclass(frozen=True)
class NameLabel:
    """What the name of a file or a sheet calls the pose of its rows.

    Args:
        text: The label.
        others: Those of all files or sheets.
        said: Does a word for a pose or point stand before it?
        stated: `OF_FILES` or `OF_SHEETS`.
    """

    text: str
    others: frozenset[str]
    said: bool
    stated: str


def in_order(named: Sequence[Named]) -> list[Named]:
    """Names that are alike but for their numbers, in the order of these; others as they stand.

    A shell gives Pose_1, Pose_10, Pose_2.
    """
    names: list[str] = [_name(each) for each in named]
    if len({without_numbers(name) for name in names}) > 1:
        return list(named)
    numbers = [[float(n.replace(",", ".")) for n in _NUMBERS.findall(name)] for name in names]
    places = sorted(range(len(names)), key=lambda k: numbers[k])
    return [named[k] for k in places]


def without_numbers(name: str) -> str:
    """The name with every number as 0, decimals among them."""
    return _NUMBERS.sub("0", name)


def labels_of_files(paths: Sequence[Path]) -> list[NameLabel] | None:
    """The number behind a word for a pose in each name, else the only one by which names that are
    otherwise alike differ; None where neither is."""
    stems = [path.stem for path in paths]
    said = [_behind_word(stem) for stem in stems]
    labels = [text for text in said if text is not None]
    if len(labels) == len(stems):
        return _made(labels, said=True, stated=OF_FILES)
    stems = [_LOAD.sub("", stem) for stem in stems]
    numbers = [_NUMBERS.findall(stem) for stem in stems]
    if len({without_numbers(stem) for stem in stems}) > 1 or len(stems) < 2:
        return None
    varying = [each for each in zip(*numbers, strict=True) if len(set(each)) > 1]
    if len(varying) != 1:
        return None
    return _made([number.lstrip("0") or "0" for number in varying[0]], said=False, stated=OF_FILES)


def labels_of_sheets(titles: Sequence[str]) -> list[NameLabel]:
    """The names of the sheets themselves."""
    said = all(map(says_one_pose, titles))
    return _made(list(titles), said=said, stated=OF_SHEETS)


def says_one_pose(title: str) -> bool:
    """Is a name a word for a pose and a number or letter, as Pose 1, P2 or Stellung B?"""
    parts = _PARTS.findall(title)
    behind = len(parts) == 2 and (parts[1].isdigit() or len(parts[1]) == 1)
    return behind and says_pose(parts[0].lower())


def _made(labels: list[str], *, said: bool, stated: str) -> list[NameLabel]:
    return [NameLabel(text, frozenset(labels), said, stated) for text in labels]


def _behind_word(stem: str) -> str | None:
    """The number of ``pose`` in ``ur5_pose_03_5kg``, without leading zeros; None without one."""
    parts = _PARTS.findall(stem)
    found = [
        str(int(number))
        for word, number in pairwise(parts)
        if number.isdigit() and says_pose(word.lower())
    ]
    return found[0] if len(found) == 1 else None


def _name(named: Path | str) -> str:
    return named.stem if isinstance(named, Path) else named
