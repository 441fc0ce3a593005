"""Text of any encoding, separator and decimal mark as rows of cells."""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sk120stiff.errors import InputError

_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", ",": "commas", " ": "blanks", "": ""}
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:[.,']\d{3})*(?:(?<=\.\d{3}),|(?<=[,']\d{3})\.)\d+")
_TEXT_MARK = re.compile(r"^'(?=[^']*$)")  # by which spreadsheets mark a text
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
_COMMENT = ("//", "#", "%")
_NUMBER_SIGN = re.compile(r"\s*#\s*[,;\t]")  # the header of a column of numbers, no comment
_BEYOND_ASCII = re.compile(rb"[\x80-\xff]+")
_GB_TRAIL = 0xA1  # least byte of a sign of GB 2312
_GB_LEVEL_1 = range(0xB0, 0xD8)  # first bytes of its common signs
_LOOKED_AT = 400  # lines that tell the separator


@dataclass(frozen=True)
class Grid:
    """What stands in a file, before anybody knows what it means.

    Args:
        path: The file, for messages.
        rows: Cells without blanks around them; numbers have a decimal point.
        lines: Line (or row of the sheet) of each row, counted from 1.
        comments: Lines that are marked as comments, with their numbers.
        how: Encoding, separator and the like, in words.
        part: Sheet of a workbook, as it stands before a line number.
        left: What else the file holds, in words.
        sheet: Name of the sheet of a workbook.
    """

    path: Path
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]
    comments: tuple[tuple[int, str], ...] = ()
    how: str = ""
    part: str = ""
    left: tuple[str, ...] = ()
    sheet: str | None = None

    def place(self, row: int) -> str:
        """File and line for a message."""
        return f"{self.path}, {self.part}line {self.lines[row]}"


def is_number(cell: str) -> bool:
    """Is this the text of a finite number with a decimal point?"""
    return _NUMBER.fullmatch(cell) is not None


def text_grid(path: Path, data: bytes) -> Grid:
    """Rows of a text file.

    Raises:
        InputError: No text, an empty file, or numbers whose marks can be read in two ways.
    """
    text, encoding = decoded(path, data)
    comments: list[tuple[int, str]] = []
    content: list[tuple[int, str]] = []
    for number, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        if line.lstrip().startswith(_COMMENT) and not _NUMBER_SIGN.match(line):
            comments.append((number, line.strip().lstrip("/#% ").rstrip()))
        elif line.strip(" \t,;|"):
            content.append((number, line))
    if not content:
        raise InputError(
            "the file is empty", where=str(path), remedy="Export the readings once more."
        )
    mark = _separator([line for _, line in content[:_LOOKED_AT]])
    rows = [tuple(split(line, mark, f"{path}, line {number}")) for number, line in content]
    how = [encoding] if encoding != "UTF-8" else []
    if mark:
        how.append(f"cells separated by {_SEPARATORS[mark]}")
    grid = Grid(path, tuple(rows), tuple(k for k, _ in content), tuple(comments), ", ".join(how))
    return with_points(grid)


def decoded(path: Path, data: bytes) -> tuple[str, str]:
    """Text and the name of its encoding: a byte-order mark, else UTF-8, UTF-16, GB 18030 where all
    that is not ASCII are pairs of bytes of common Chinese signs, Windows-1252.

    Raises:
        InputError: The bytes are no text.
    """
    for mark, name, shown in (
        (codecs.BOM_UTF8, "utf-8-sig", "UTF-8"),
        (codecs.BOM_UTF16_LE, "utf-16", "UTF-16"),
        (codecs.BOM_UTF16_BE, "utf-16", "UTF-16"),
    ):
        if data.startswith(mark):
            return _decode(path, data, name), shown
    if b"\0" in data[:2000]:  # every other byte of plain letters in UTF-16
        even, odd = data[:2000:2].count(0), data[1:2000:2].count(0)
        if min(even, odd) * 10 > max(even, odd):
            raise _no_text(path)
        return _decode(path, data, "utf-16-be" if even > odd else "utf-16-le"), "UTF-16"
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        if _is_chinese(data):
            return _decode(path, data, "gb18030"), "GB 18030"
        return _decode(path, data, "cp1252"), "Windows-1252"
    return _decode(path, data, "utf-8"), "UTF-8"


def _is_chinese(data: bytes) -> bool:
    """Do the bytes beyond ASCII come in pairs, most of them of the first level of GB 2312?"""
    runs = _BEYOND_ASCII.findall(data)
    if any(len(run) % 2 or min(run) < _GB_TRAIL for run in runs):
        return False
    leads = [lead for run in runs for lead in run[::2]]
    return 2 * sum(lead in _GB_LEVEL_1 for lead in leads) > len(leads)


def _decode(path: Path, data: bytes, encoding: str) -> str:
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise _no_text(path) from error
    if _CONTROL.search(text):
        raise _no_text(path)
    return text


def _no_text(path: Path) -> InputError:
    return InputError(
        "this is no text, and no format that is known",
        where=str(path),
        remedy="Export the readings as text (CSV), .xlsx, .mat (version 7), .npz or a ROS 2 bag.",
    )


def _separator(lines: Sequence[str]) -> str:
    """The mark that makes most cells numbers and most lines equally long."""

    def score(mark: str) -> float:
        cells = [split(line, mark, "") for line in lines]
        many = [c for c in cells if len(c) > 1 or not mark]
        if not many:
            return 0.0
        width = Counter(map(len, many)).most_common(1)[0][0]
        whole = [c for c in many if len(c) == width]
        good = sum(is_number(cell) or bool(_COMMA.fullmatch(cell)) for c in whole for cell in c)
        filled = sum(cell != "" for c in whole for cell in c)
        return (good + 1e-3 * len(mark)) / (filled + 1) * len(whole) / len(cells)

    return max(_SEPARATORS, key=score)


def split(line: str, mark: str, place: str) -> list[str]:
    """Cells of a line, without blanks around them.

    Raises:
        InputError: A quotation mark that nothing closes.
    """
    if not mark:
        return [line.strip()]
    if mark == " ":
        line = line.replace("\t", " ").strip()
    try:
        (cells,) = csv.reader([line], delimiter=mark, skipinitialspace=True, strict=bool(place))
    except csv.Error as error:
        raise InputError(
            f"this line cannot be cut into cells ({error})",
            where=place,
            remedy="Quotation marks enclose a whole cell and end on its line.",
        ) from error
    return [_TEXT_MARK.sub("", cell.strip()).replace("\N{MINUS SIGN}", "-") for cell in cells]


def with_points(grid: Grid) -> Grid:
    """The same cells with decimal points.

    Raises:
        InputError: Marks between thousands, or commas and points side by side.
    """
    width = Counter(map(len, grid.rows)).most_common(1)[0][0]
    comma = point = ""
    for k, row in enumerate(grid.rows):
        for cell in row:
            if _THOUSANDS.fullmatch(cell):
                raise InputError(
                    f"{cell!r} has marks between its thousands",
                    where=grid.place(k),
                    remedy="Export without them: 1234.5 or 1234,5.",
                )
            if len(row) == width:
                comma = comma or (cell if _COMMA.fullmatch(cell) else "")
                point = point or (cell if "." in cell and is_number(cell) else "")
    if not comma:
        return grid
    if point:
        raise InputError(
            f"decimals stand with a comma ({comma}) and with a point ({point})",
            where=str(grid.path),
            remedy="Export with one decimal mark.",
        )
    rows = tuple(
        tuple(c.replace(",", ".") if _COMMA.fullmatch(c) else c for c in row) for row in grid.rows
    )
    return replace(grid, rows=rows, how=f"{grid.how}, decimal commas")
