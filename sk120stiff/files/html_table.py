"""Tables as a notebook shows them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape

SHOWN = 10  # rows; more are counted


def html_table(lead: str, columns: Mapping[str, Iterable[object]]) -> str:
    """A line and a table under it; numbers with four digits, nothing where they are not known."""
    rows = list(zip(*columns.values(), strict=True))
    lines = [_line("th", columns), *(_line("td", map(_cell, row)) for row in rows[:SHOWN])]
    more = len(rows) - SHOWN
    rest = f"<p>… {more} more rows</p>" if more > 0 else ""
    return f"<div><p>{escape(lead)}</p><table>{''.join(lines)}</table>{rest}</div>"


def _line(tag: str, cells: Iterable[str]) -> str:
    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"


def _cell(value: object) -> str:
    if hasattr(value, "__float__") and not isinstance(value, int):
        return "" if value != value else f"{value:.4g}"
    return str(value)
