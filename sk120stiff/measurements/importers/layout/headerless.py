"""Rows of numbers: how many stand in a row without headers, where they begin, and if none does."""

from __future__ import annotations

from collections import Counter

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.clock import is_clock
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import is_number


def numeric(row: tuple[str, ...]) -> bool:
    """Is this a row of readings: as many numbers as words, where a date or a time is neither?"""
    count = sum(map(is_number, row))
    return 2 * count >= sum(cell != "" and not is_clock(cell) for cell in row) and count > 0


def shaped(source: Source) -> tuple[int, bool, int]:
    """Of a grid without headers: numbers in a row, is there a name before them, the first row.

    Raises:
        InputError: No row holds numbers.
    """
    rows = source.grid.rows
    first = next((k for k, row in enumerate(rows) if numeric(row)), None)
    if first is None:
        raise InputError(
            "no line of this file holds readings",
            where=str(source.path),
            remedy="Its columns have headers such as name, x [mm], y [mm], z [mm]; or name them "
            "with --columns.",
        )
    width = Counter(len(cut(row)) for row in rows[first:]).most_common(1)[0][0]
    some = [row for row in rows[first:] if len(cut(row)) == width]
    named = not all(is_number(row[0]) for row in some)
    return width - named, named, first


def of_other_columns(source: Source) -> bool:
    """Does a row of headers stand above the numbers that `layout_of` did not understand?

    How many numbers stand in a row then tells nothing: they have names, and others. Three numbers
    are positions whatever is written above them; of joints or loads they may be anything.
    """
    count, named, first = shaped(source)
    above = cut(source.grid.rows[first - 1]) if first else ()
    few = source.role == "points" and count <= len("xyz")
    if len(above) != count + named or few:
        return False
    return not any(map(is_number, above)) and source.columns is None


def cut(row: tuple[str, ...], width: int = 0) -> tuple[str, ...]:
    """The row without empty cells behind the last column."""
    while len(row) > width and not row[-1]:
        row = row[:-1]
    return row


def no_rows(source: Source, needed: list[str], total: int) -> InputError:
    """What is wrong with a table that has no reading below its headers, though `total` rows.

    Recordings that were exported as they came have the columns of one topic in each row.
    """
    topics = len({header.rpartition("/")[0] for header in needed if "/" in header}) > 1
    if total and topics:
        return InputError(
            f"in none of {total} rows stand the values of all topics together: each has those of "
            "one, and the cells of the others are blank",
            where=str(source.path),
            remedy="Export with the last value of every topic in each row (in pandas: "
            "pd.read_csv(...).ffill().dropna()), or the arm's joints and the positions at the same "
            "times.",
        )
    return InputError(
        "the table has headers but no row of readings",
        where=str(source.path),
        remedy="Export the readings once more.",
    )
