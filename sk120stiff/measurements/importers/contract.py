"""What an importer is: it says whether a file is of its format, and reads it into a `Sheet`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol

from sk120stiff import files
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.grid import Grid, text_grid

Role = Literal["points", "joints", "loads"]
FILE = "(file)"  # header of a column that holds the names of files
CLOSE = 0.1  # confidences that differ by less do not decide
_NEEDED: dict[Role, str] = {  # what to do where nothing of a file is understood
    "points": "Name its columns, e.g. --columns 'name,x,y,z,q1,q2,q3,q4,q5,q6' (a dash for one "
    "that is not needed; of several markers x1,y1,z1,x2,y2,z2). ",
    "joints": "Give its columns headers: a name, and the robot's joints or q1[deg], q2[deg], and "
    "so on. ",
    "loads": "Give its columns headers: a name, and one or more of fx[N], fy[N], fz[N] (axes of "
    "the base), or payload[kg], which hangs down, or load, which counts --wrench. ",
}


@dataclass(frozen=True, eq=False)
class Source:
    """A file, and what is known of it before it is read.

    Args:
        path: The file, or the folder of a recording.
        actuated: The robot's actuated joints.
        role: What it was given for: points (with or without joints), joints, or loads.
        columns: Names for its columns, where somebody told them.
        sheet, topic, marker: Which sheet of a workbook, topic of a recording, marker of several.
        given: Its rows, where they were made of something else.
        called: Which file of several it is, as --sheet names it: before, joints, loads or none.
        beside: A sheet of the same workbook that is used for another of them.
        parts: Sheets of the workbook that are read as one campaign, this one among them.
        state: ``unloaded`` or ``loaded``: of several sheets the one whose name says so.
    """

    path: Path
    actuated: tuple[str, ...]
    role: Role = "points"
    columns: tuple[str, ...] | None = None
    sheet: str | None = None
    topic: str | None = None
    marker: str | None = None
    given: Grid | None = None
    called: str = ""
    beside: str | None = None
    state: str | None = None
    parts: tuple[str, ...] = ()

    @cached_property
    def data(self) -> bytes:
        """The bytes; none of a folder."""
        return b"" if self.path.is_dir() else files.read_bytes(self.path)

    @cached_property
    def grid(self) -> Grid:
        """Rows of cells: those given, else of a text.

        Raises:
            InputError: A folder, or no text.
        """
        if self.given is not None:
            return self.given
        if self.path.is_dir():
            raise InputError(
                "this folder is no ROS 2 bag: it holds no metadata.yaml of one",
                where=str(self.path),
                remedy="Give a file, or the folder that holds metadata.yaml and the recording.",
            )
        return text_grid(self.path, self.data)

    @property
    def unnamed_grid(self) -> Grid | None:
        """Rows of cells whose columns nobody has named; None of a folder, or of what is no text."""
        if self.columns is not None or self.path.is_dir():
            return None
        try:
            return self.grid
        except InputError:  # its importer tells
            return None


class Guess(NamedTuple):
    """How sure an importer is that a file is its own (0 to 1: beyond doubt), and why."""

    confidence: float
    why: str = ""


NO = Guess(0.0)
Meanings = list[tuple[str, float] | None]  # of columns, as `words.meaning_of` tells them


@dataclass(frozen=True)
class Column:
    """A column and its meaning.

    Args:
        header: As it stands in the file.
        meaning: A word of `words.meaning_of`: ``x``, ``sx``, ``joint 3``, ``name``, ``fx`` ...
        unit: As stated, or None.
        stated: Where the unit is stated, in words.
        cells: N texts.
        factor: What the numbers are multiplied by: 1/2 for expanded uncertainties with k = 2.
        file: The file that it is from, where that is another than the points'.
    """

    header: str
    meaning: str
    unit: str | None
    stated: str
    cells: tuple[str, ...]
    factor: float = 1.0
    file: Path | None = None

    def rows(self, picked: Sequence[int]) -> Column:
        """Some of its cells."""
        return replace(self, cells=tuple(self.cells[k] for k in picked))


class Unpaired(NamedTuple):
    """A row that has none beside it in another file.

    Args:
        file, line, name: Where it stands, and its name if any.
        lacks: What it has not, in words.
        beside: Is it of a file beside the points, and no point?
    """

    file: Path
    line: int
    name: str
    lacks: str
    beside: bool = False

    @property
    def reason(self) -> str:
        """In words."""
        of = f"of {self.file.name}" if self.beside else ""
        return (
            " ".join(filter(None, (self.name, of))) + (": " if of or self.name else "") + self.lacks
        )


@dataclass(frozen=True)
class Sheet:
    """Readings as a file has them, all of one length N.

    Args:
        path, title, why: The file, its format, and how it was recognised.
        columns: What is used.
        lines: N lines of the file.
        unused: What is not, with the reason.
        skipped: Line and reason of rows that are not readings.
        rank, total: Place of each row among all rows with numbers, and how many those are.
        spare: Columns whose meaning is not known.
        frame: The axes that the file says positions are in.
        notes: What was decided or taken for granted, in sentences.
        marker: The one of several markers that these are readings of, where one was chosen.
        zero: Of readings with and without load: do rows of a pose share a zero reading?
        doubts: What speaks against it, in sentences.
        subtracted: Are displacements such readings, one less the other?
        remarks: Comments and lines above the table, with their numbers.
        unpaired: Rows without a partner in another file, or of such a file without a point.
        by_order: Files whose rows were put beside these by order alone.
    """

    path: Path
    title: str
    why: str
    columns: tuple[Column, ...]
    lines: tuple[int, ...]
    unused: tuple[str, ...] = ()
    skipped: tuple[tuple[int, str], ...] = ()
    rank: tuple[int, ...] = ()
    total: int = 0
    spare: tuple[Column, ...] = ()
    frame: str | None = None
    notes: tuple[str, ...] = ()
    marker: str | None = None
    zero: Literal["shared", "separate"] = "shared"
    subtracted: bool = False
    doubts: tuple[str, ...] = ()
    remarks: tuple[tuple[int, str], ...] = ()
    unpaired: tuple[Unpaired, ...] = ()
    by_order: tuple[Path, ...] = ()

    def get(self, meaning: str) -> Column | None:
        """The column of that meaning."""
        return next((c for c in self.columns if c.meaning == meaning), None)

    def those(self, *meanings: str) -> list[Column]:
        """The columns of these meanings, as far as they are there."""
        return [c for meaning in meanings if (c := self.get(meaning)) is not None]

    def has(self, *meanings: str) -> bool:
        """Are all of them there?"""
        return len(self.those(*meanings)) == len(meanings)

    def rows(self, picked: Sequence[int]) -> Sheet:
        """Some of the readings."""
        return replace(
            self,
            columns=tuple(column.rows(picked) for column in self.columns),
            spare=tuple(column.rows(picked) for column in self.spare),
            lines=tuple(self.lines[k] for k in picked),
            rank=tuple(self.rank[k] for k in picked) if self.rank else (),
        )

    def exchanged(self, gone: Sequence[Column], *made: Column) -> Sheet:
        """Without some columns, used or spare; others stand behind the rest."""
        columns, spare = (
            tuple(c for c in kind if not any(c is g for g in gone))
            for kind in (self.columns, self.spare)
        )
        return replace(self, columns=(*columns, *made), spare=spare)

    def swapped(self, column: Column, **changes: Any) -> Sheet:
        """With changes to a column, in its place."""
        new = replace(column, **changes)
        return replace(self, columns=tuple(new if c is column else c for c in self.columns))

    def noting(self, *sentences: str) -> Sheet:
        """With what was decided, behind the notes so far."""
        return replace(self, notes=(*self.notes, *sentences))

    def place(self, column: Column, row: int | None = None) -> str:
        """File, line and column for a message."""
        line = "" if row is None or column.file else f", line {self.lines[row]}"
        of = f" of the point in line {self.lines[row]}" if column.file and row is not None else ""
        return f"{column.file or self.path}{line}, column {column.header}{of}"


class Importer(Protocol):
    """One format."""

    @property
    def name(self) -> str:
        """As --format takes it."""

    @property
    def title(self) -> str:
        """As people call it."""

    def sniff(self, source: Source) -> Guess:
        """How sure it is that the file is of this format, by its content alone."""

    def read(self, source: Source) -> Sheet:
        """The readings."""


@dataclass(frozen=True)
class Formats:
    """Importers; a value that adds: ``FORMATS + (Mine(),)``."""

    importers: tuple[Importer, ...]

    def __add__(self, more: Sequence[Importer]) -> Formats:
        return Formats((*self.importers, *more))

    def __iter__(self) -> Iterator[Importer]:
        return iter(self.importers)

    def chosen(self, source: Source, name: str | None = None) -> tuple[Importer, str]:
        """The importer of a file, and why it is that one.

        Raises:
            InputError: No format fits, two fit as well, or the name is none.
        """
        names = ", ".join(i.name for i in self)
        if name is not None:
            for importer in self:
                if importer.name == name:
                    return importer, "as told"
            raise InputError(
                f"no format is called {name!r}", where="--format", remedy=f"There are {names}."
            )
        guesses = []
        for importer in self:
            guess = importer.sniff(source)
            if guess.confidence == 1.0:  # it is no text, and no other need look
                return importer, guess.why
            if guess.confidence > 0.0:
                guesses.append((guess, importer))
        if not guesses:
            raise InputError(
                "no format that is known fits this file",
                where=str(source.path),
                remedy=_NEEDED[source.role] + f"Formats are {names}.",
            )
        guesses.sort(key=lambda pair: -pair[0].confidence)
        best = guesses[0]
        rivals = [p for p in guesses if p[0].confidence > best[0].confidence - CLOSE]
        if len(rivals) > 1:
            raise InputError(
                "this file can be read in more than one way: "
                + listed([f"{i.title} ({guess.why})" for guess, i in rivals], "or"),
                where=str(source.path),
                remedy="Say which: "
                + listed([f"--format {i.name}" for _, i in rivals], "or")
                + "; or name the columns with --columns.",
            )
        return best[1], best[0].why
