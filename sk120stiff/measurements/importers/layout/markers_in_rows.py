"""Names of markers in a row above X Y Z X Y Z, as mocap programs write them, become numbers."""

from __future__ import annotations

import dataclasses

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid
from sk120stiff.measurements.table.columns import POSITIONS

SEARCHED = 20  # rows that may stand above the headers


def with_numbered_markers(source: Source) -> Source:
    """The source with headers ``M1 x`` ... in the place of two rows; as it is where it has none."""
    if source.role != "points" or source.columns is not None or source.path.is_dir():
        return source
    try:
        grid = source.grid
    except InputError:  # no text: its importer tells
        return source
    for k, row in enumerate(grid.rows[:SEARCHED]):
        first = _triples(row)
        if len(first) > 1:
            names = _names_above(grid, k, first)
            return source if names is None else _numbered(source, grid, k, first, names)
    return source


def _triples(row: tuple[str, ...]) -> list[int]:
    """Where X of every X Y Z in turn stands; none where other cells are called so."""
    words = tuple(unit_of_header(cell)[0].lower() for cell in row)
    first = [k for k in range(len(words) - 2) if words[k : k + 3] == POSITIONS]
    return first if words.count("x") == words.count("z") == len(first) else []


def _names_above(grid: Grid, at: int, first: list[int]) -> list[str] | None:
    """The names in the nearest row above that has one for each, once or above all three axes."""
    for k in range(at - 1, -1, -1):
        row = (*grid.rows[k], *[""] * (max(first) + 3))
        words = {cell.strip().lower() for cell in row}
        if "rotation" in words:  # three of these are no place
            return None
        names = [row[place].strip() for place in first]
        alone = all(
            {row[place + 1].strip(), row[place + 2].strip()} <= {"", name}
            for place, name in zip(first, names, strict=True)
        )
        if all(names) and len(set(names)) == len(names) and alone:
            return names
    return None


def _numbered(source: Source, grid: Grid, at: int, first: list[int], names: list[str]) -> Source:
    headers = list(grid.rows[at])
    for number, place in enumerate(first, 1):
        stated = [unit_of_header(cell)[1] for cell in headers[place : place + 3]]
        headers[place : place + 3] = [
            f"M{number} {axis} [{unit}]" if unit else f"M{number} {axis}"
            for axis, unit in zip(POSITIONS, stated, strict=True)
        ]
    above = tuple(
        (line, "  ".join(cell for cell in row if cell))
        for line, row in zip(grid.lines[:at], grid.rows[:at], strict=True)
    )
    called = ", ".join(f"{number} is {name}" for number, name in enumerate(names, 1))
    given = dataclasses.replace(
        grid,
        rows=(tuple(headers), *grid.rows[at + 1 :]),
        lines=grid.lines[at:],
        comments=(*grid.comments, *above),
        how=f"{grid.how}; marker {called}" if grid.how else f"a table; marker {called}",
    )
    return dataclasses.replace(source, given=given)
