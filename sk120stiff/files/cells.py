"""CSV files that we write; a spreadsheet must not take labels of others for formulas."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

FORMULA = ("=", "+", "-", "@", "\t", "\r")


def csv_text(columns: Iterable[tuple[str, Iterable[object]]]) -> str:
    """Columns of one length under their headers, as the text of a CSV file.

    Numbers carry all digits of a float, NaN is an empty cell, and labels are guarded.
    """
    named = list(columns)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([guarded_cell(header) for header, _ in named])
    writer.writerows(map(_text, row) for row in zip(*(cells for _, cells in named), strict=True))
    return stream.getvalue()


def _text(cell: object) -> str:
    """The shortest text that reads back as the same float; anything else as it prints."""
    if isinstance(cell, float):
        return "" if cell != cell else repr(float(cell))
    return guarded_cell(str(cell))


def guarded_cell(text: str) -> str:
    """A label as it is written: with an apostrophe before it where it could begin a formula.

    Spreadsheets show such a cell as text. Numbers stay numbers. A label that begins with such an
    apostrophe already gets one more, so that `plain_cell` gives every label back.
    """
    return f"'{text}" if _formula(text.lstrip("'")) and not _number(text) else text


def plain_cell(text: str) -> str:
    """The label that `guarded_cell` has written."""
    return text[1:] if text.startswith("'") and _formula(text.lstrip("'")) else text


def _formula(text: str) -> bool:
    return text.startswith(FORMULA) and not _number(text)


def _number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
