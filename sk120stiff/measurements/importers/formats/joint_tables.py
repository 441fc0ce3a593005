"""Tables of calibration programs with joints, a position and three numbers more in every row.

RoboDK's: a line of headers, then the joints [deg], X Y Z of the tracker [mm] and X Y Z of the
marker in the flange frame (TCP) [mm], as the macros that RoboDK ships read it.

DELMIA's: tag name (a tag group may stand before it), X Y Z [mm], Roll Pitch Yaw [deg] as measured,
then the joints [deg, mm]; separated by tabs or blanks, or a spreadsheet; headers are optional.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.layout.headerless import of_other_columns, shaped
from sk120stiff.measurements.importers.layout.layout import (
    layout_of,
    sheet_by_order,
)

MARKER = 3  # numbers that say where it sits


@dataclass(frozen=True)
class JointTable:
    """One such table.

    Attributes:
        name, title: As of every `Importer`.
        columns: Names of the columns without headers; ``joints`` stands for all of them.
        meanings, why: What headers must mean, in the same way; the same in words.
        row: What the numbers of a row are, in words.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    meanings: tuple[str, ...]
    why: str
    row: str

    def sniff(self, source: Source) -> Guess:
        """By the meanings of its headers; without headers, by as many numbers in a row."""
        if source.role != "points":
            return NO
        layout, n = layout_of(source), len(source.actuated)
        if layout is not None:
            wanted = _with_joints(self.meanings, [f"joint {k + 1}" for k in range(n)])
            return Guess(0.9, self.why) if layout.has(*wanted) else NO
        count, named, _ = shaped(source)
        if named != ("tag" in self.columns) or count != n + 6 or of_other_columns(source):
            return NO
        if "tcp x" in self.columns and not _few_places(source):
            return NO  # an orientation, more likely
        return Guess(0.5, f"{'a tag and ' * named}{count} numbers in a row: {self.row}")

    def read(self, source: Source) -> Sheet:
        """The readings; mm and degrees are prescribed, where headers show the table."""
        columns = _with_joints(self.columns, [f"q{k + 1}" for k in range(len(source.actuated))])
        units = {"length": "mm", "angle": "deg"}
        return sheet_by_order(source, columns, self.title, self.sniff(source).why, units)


def _few_places(source: Source) -> bool:
    """Do the last three numbers of the rows repeat, as the places of a few markers do?"""
    rows = [row for row in source.grid.rows if len(row) >= MARKER and is_number(row[-1])]
    return len({row[-MARKER:] for row in rows}) <= max(1, len(rows) // 2)


def _with_joints(words: Sequence[str], joints: Sequence[str]) -> tuple[str, ...]:
    return tuple(own for word in words for own in (joints if word == "joints" else [word]))


ROBODK = JointTable(
    "robodk",
    "RoboDK's calibration measurements",
    columns=("joints", "x", "y", "z", "tcp x", "tcp y", "tcp z"),
    meanings=("joints", "x", "y", "z", "tcp x", "tcp y", "tcp z"),
    why="joints, X Y Z and TCP X Y Z",
    row="joints, position, marker place",
)
DELMIA = JointTable(
    "delmia",
    "a DELMIA tag table",
    columns=("tag", "x", "y", "z", "roll", "pitch", "yaw", "joints"),
    meanings=("x", "y", "z", *(f"orientation {word}" for word in ("roll", "pitch", "yaw"))),
    why="Roll, Pitch and Yaw beside X, Y, Z",
    row="position, roll pitch yaw, joints",
)
