"""A CSV file as columns of text that know their line, and the complaints a spreadsheet earns."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff import files, units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError

_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")
_WITH_UNIT = re.compile(r"[+-]?[\d.]+\s*[^\d\s.,_+-]+.*")
_UNREAD = "An axis that was not read is a blank cell."
_COMMAS = (
    "Separate the cells by commas and write decimals with a point: 1.5, not 1,5. Files of other "
    "programs 'sk120stiff import' reads as they are."
)


@dataclass(frozen=True)
class Table:
    """The cells of a CSV file, column by column.

    Args:
        path: The file, for messages.
        headers: Name of each column, without its unit, and the header as written.
        column_units: Name of each column and its unit, None where the header has none.
        cells: Name of each column and its N texts, without blanks around them.
        lines: N line numbers, counted from 1.
        header_line: The line of the headers.
    """

    path: Path
    headers: dict[str, str]
    column_units: dict[str, str | None]
    cells: dict[str, tuple[str, ...]]
    lines: tuple[int, ...]
    header_line: int

    def place(self, name: str, row: int | None = None) -> str:
        """File, line and column for a message; the line of the headers where no row is given."""
        line = self.header_line if row is None else self.lines[row]
        return f"{self.path}, line {line}, column {self.headers.get(name, name)}"

    def numbers(self, name: str, *, allow_blank: bool = False) -> Array:
        """The column (N,) as finite numbers, as written; an allowed empty cell becomes NaN.

        Raises:
            InputError: A cell that is empty, no number, or not finite.
        """
        cells = self.cells[name]
        try:
            values = np.array([float(cell) for cell in cells])
        except ValueError:
            values = np.full(len(cells), np.nan)
        if np.all(np.isfinite(values)) and "_" not in "".join(cells):
            return values
        for row, cell in enumerate(cells):
            if cell == "" and allow_blank:
                continue
            complaint = _complaint(cell)
            if complaint is not None:
                what, remedy = complaint
                raise InputError(what, where=self.place(name, row), remedy=remedy)
        return np.array([float(cell) if cell else np.nan for cell in cells])

    def quantity(self, name: str, kind: str, *, allow_blank: bool = False) -> Array:
        """The column (N,) in SI; `numbers` with the unit of the header.

        Raises:
            InputError: As `numbers`, or the header has no unit, an unknown one, or one of another
                kind.
        """
        unit = self.column_units[name]
        if unit is None:
            raise InputError(
                f"the column {name!r} has no unit",
                where=self.place(name),
                remedy=f"Write its header as {name}[{units.KINDS[kind][1][0]}], "
                "with the unit that its numbers have.",
            )
        values = self.numbers(name, allow_blank=allow_blank)
        known = np.isfinite(values)
        values[known] = units.to_si(values[known], unit, kind, where=self.place(name))
        return values

    def quantities(self, names: Sequence[str], kind: str, *, allow_blank: bool = False) -> Array:
        """Several columns of one kind side by side (N, k), SI.

        Raises:
            InputError: As `quantity`, or one of them is missing.
        """
        for name in names:
            if name not in self.headers:
                raise InputError(
                    f"the column {name!r} is missing",
                    where=str(self.path),
                    remedy=f"There are: {', '.join(self.headers.values())}.",
                )
        return np.column_stack([self.quantity(n, kind, allow_blank=allow_blank) for n in names])


def read_table(path: Path) -> Table:
    """Read a comma-separated file with one line of headers.

    A byte-order mark, CRLF line ends, empty lines and lines that start with ``#`` are fine.

    Raises:
        InputError: Missing, unreadable, not UTF-8, empty, without rows, another separator, a
            repeated or nameless column, or a row with more or fewer cells than there are headers.
    """
    header: list[str] | None = None
    header_line = 0
    rows: list[list[str]] = []
    lines: list[int] = []
    text = files.read_text(path).replace("\r\n", "\n").replace("\r", "\n")
    for number, line in enumerate(text.split("\n"), start=1):
        if not line.strip(" \t,") or line.lstrip().startswith("#"):
            continue
        cells = _split(line, f"{path}, line {number}")
        if header is None:
            header, header_line = _headers(cells, line, f"{path}, line {number}"), number
            continue
        while len(cells) > len(header) and not cells[-1]:
            cells.pop()
        if len(cells) != len(header):
            raise InputError(
                f"{len(cells)} cells, but line {header_line} has {len(header)} headers",
                where=f"{path}, line {number}",
                remedy=_COMMAS if len(cells) > len(header) else "Fill the missing cells.",
            )
        rows.append(cells)
        lines.append(number)
    if header is None:
        raise InputError(
            "the file is empty",
            where=str(path),
            remedy="Its first line holds the headers, such as "
            "pose,joint_1_s[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm].",
        )
    return table_of(path, header, header_line, rows, lines)


def table_of(
    path: Path, header: list[str], header_line: int, rows: list[list[str]], lines: list[int]
) -> Table:
    """Rows of text under headers with units, as a table."""
    place = f"{path}, line {header_line}"
    headers: dict[str, str] = {}
    column_units: dict[str, str | None] = {}
    for text in header:
        name, unit = units.split_header(text, where=place)
        if name in headers:
            raise InputError(
                f"the column {name!r} stands there twice",
                where=f"{place}, column {text}",
                remedy="Delete or rename one of them.",
            )
        headers[name], column_units[name] = text, unit
    if not rows:
        raise InputError(
            "the file has headers but no row of data",
            where=str(path),
            remedy="Write one line per reading below the headers.",
        )
    cells = dict(zip(headers, zip(*rows, strict=True), strict=True))
    return Table(path, headers, column_units, cells, tuple(lines), header_line)


def _split(line: str, place: str) -> list[str]:
    try:
        (cells,) = csv.reader([line], strict=True, skipinitialspace=True)
    except csv.Error as error:
        raise InputError(
            f"this line is not comma-separated text ({error})",
            where=place,
            remedy="Quotation marks enclose a whole cell and end on its line.",
        ) from error
    stripped = [cell.strip() for cell in cells]
    return [files.plain_cell(cell) if cell[:1] == "'" else cell for cell in stripped]


def _headers(cells: list[str], line: str, place: str) -> list[str]:
    if len(cells) == 1:
        for mark, name in ((";", "semicolons"), ("\t", "tabs"), ("|", "bars")):
            if mark in line:
                raise InputError(f"the cells are separated by {name}", where=place, remedy=_COMMAS)
    while cells and not cells[-1]:
        cells.pop()
    if "" in cells:
        raise InputError(
            f"column {cells.index('') + 1} has no name",
            where=place,
            remedy="Name the column, or delete it.",
        )
    return cells


def _complaint(cell: str) -> tuple[str, str] | None:
    """What is wrong with a cell that should hold a number, and the remedy; None if nothing is."""
    row = "A row that cannot be used still needs numbers; mask it with a column use that holds 0."
    if cell == "":
        return "the cell is empty", f"Write a number. {row}"
    try:
        value = float(cell)
    except ValueError:
        if _DECIMAL_COMMA.fullmatch(cell):
            return f"{cell!r} is no number", "Write decimals with a point: 1.5, not 1,5."
        if _WITH_UNIT.fullmatch(cell):
            return f"{cell!r} is no number", "The unit stands in the header, not in the cell."
        return f"{cell!r} is no number", f"Write a number. {_UNREAD}"
    if "_" in cell:
        return f"{cell!r} is no number", "Write a number."
    return None if np.isfinite(value) else (f"{cell} is not a finite number", f"{_UNREAD} {row}")
