"""Labels of others in cells of a CSV file: a spreadsheet must not take them for formulas."""

from __future__ import annotations

FORMULA = ("=", "+", "-", "@", "\t", "\r")


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
