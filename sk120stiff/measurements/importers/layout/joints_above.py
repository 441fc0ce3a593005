"""Joint values that stand once above a table, in a few cells: they hold for all rows below.

Four ways: names with the numbers below them, a name and its number side by side, or one word for
joints with all numbers behind it, in cells of their own or in one.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence

from sk120stiff.measurements.importers.columns.words import is_unit, meaning_of, unit_of_header
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid, is_number
from sk120stiff.measurements.importers.layout.header_rows import OF_JOINTS
from sk120stiff.measurements.importers.layout.layout import Layout, layout_of

Row = tuple[str, ...]
Cells = list[tuple[str, str]]  # header and number of each joint, in their order
_OTHER = re.compile(  # what else is told of joints above a table
    r"limit|grenz|range|bereich|min(?![a-z])|max|home|start|ratio|[üu]bersetzung|gear|offset|zero|null|"
    r"speed|vel|torque|moment|stiff|steif|toleran|resol|backlash|spiel|encoder|target|command|cmd|soll",
    re.IGNORECASE,
)
_NUMBER = r"[-+]?\d+(?:\.\d+)?"
_ONE_CELL = re.compile(
    r"(?P<word>[^\W\d][^\d=:\[(]*?)\s*(?P<stated>[\[(][^\W\d]\w*[\])]|[\[(]°[\])])?\s*[=:]?\s*[\[(]?"
    rf"(?P<numbers>{_NUMBER}(?:(?:\s*[,;]\s*|\s+){_NUMBER})+)\s*[\])]?\s*(?P<unit>[^\d,;]*)"
)
NONE: tuple[Cells, range] = ([], range(0))


def with_joints_above(source: Source) -> Source:
    """The source with such values as columns; as it is where the table has joints, or none stand
    there, or more than once."""
    grid = source.unnamed_grid
    if grid is None or source.role != "points":
        return source
    layout = layout_of(source)
    if layout is None or layout.has("joint 1") or layout.has("joint 0") or not source.actuated:
        return source
    if _of_poses(layout, grid) > 1:  # then they are those of another place, as where it began
        return source
    width = len(layout.headers)
    at = next((k for k, r in enumerate(grid.rows) if r[:width] == layout.headers), None)
    if not at:
        return source
    above, n = grid.rows[:at], len(source.actuated)
    ways = (
        *(_below(above, k, source.actuated) for k in range(at - 1)),
        *(_behind_word(above, k, n) for k in range(at)),
        *(_in_one_cell(above, k, n) for k in range(at)),
        _side_by_side(above, source.actuated),
    )
    found = [
        (cells, rows)
        for cells, rows in ways
        if len(cells) == n and not any(_OTHER.search(c) for k in rows for c in above[k])
    ]
    if len(found) != 1:
        return source
    return dataclasses.replace(source, given=_widened(grid, at, width, *found[0]))


def _of_poses(layout: Layout, grid: Grid) -> int:
    """How many labels of poses the table has."""
    place = next((k for k, m in enumerate(layout.meanings) if m and m[0] == "pose"), None)
    rows = grid.rows[layout.first :] if place is not None else ()
    return len({row[place] for row in rows if place is not None and place < len(row)})


def _widened(grid: Grid, at: int, width: int, cells: Cells, used: range) -> Grid:
    """The grid with these columns behind its own, and without the rows that they were in."""
    rows = list(grid.rows)
    for k in range(at, len(rows)):
        values = [header if k == at else number for header, number in cells]
        filled = (*rows[k], *[""] * (width - len(rows[k])))
        if k > at and not any(map(is_number, rows[k])):  # units, or no reading
            values = [""] * len(cells)
        rows[k] = (*filled[:width], *values, *filled[width:])
    said = "joint values above the table, which hold for all its rows"
    kept = [k for k in range(len(rows)) if k not in used]
    how = f"{grid.how}, {said}" if grid.how else said
    return dataclasses.replace(
        grid,
        rows=tuple(rows[k] for k in kept),
        lines=tuple(grid.lines[k] for k in kept),
        how=how,
    )


def _number_of(cell: str, actuated: Row) -> int | None:
    """Which joint a cell names, or None."""
    known = meaning_of(unit_of_header(cell)[0], actuated) if cell and not is_number(cell) else None
    return int(known[0][6:]) if known and known[0].startswith("joint ") else None


def _in_turn(named: dict[int, tuple[str, str]], n: int) -> Cells:
    """From the first joint on or from 0 on, as many as there are; else none."""
    for first in (1, 0):
        if set(named) == set(range(first, first + n)):
            return [named[k] for k in sorted(named)]
    return []


def _below(above: Sequence[Row], at: int, actuated: Row) -> tuple[Cells, range]:
    """Names of joints in a row, with a number below each; units may stand between."""
    numbers = {k: _number_of(cell, actuated) for k, cell in enumerate(above[at])}
    joints = {k: joint for k, joint in numbers.items() if joint is not None}
    if len(joints) < len(actuated):
        return NONE
    below, end = above[at + 1], at + 2
    stated: dict[int, str] = {}
    units = [cell.strip("[]() ") for cell in below]
    if at + 2 < len(above) and all(is_unit(cell) for cell in units if cell):
        stated, below, end = dict(enumerate(units)), above[at + 2], at + 3
    named: dict[int, tuple[str, str]] = {}
    for k, joint in joints.items():
        number = below[k] if k < len(below) else ""
        if is_number(number) and joint not in named:
            unit = stated.get(k, "")
            named[joint] = (f"{above[at][k]} [{unit}]" if unit else above[at][k], number)
    return _in_turn(named, len(actuated)), range(at, end)


def _behind_word(above: Sequence[Row], at: int, n: int) -> tuple[Cells, range]:
    """``Joint angles [deg]`` and the numbers of all joints behind it."""
    cells = [cell for cell in above[at] if cell]
    if len(cells) < n + 1 or not OF_JOINTS.match(cells[0]) or not all(map(is_number, cells[1:])):
        return NONE
    unit = unit_of_header(cells[0])[1]
    named = [(f"J{k} [{unit}]" if unit else f"J{k}", cell) for k, cell in enumerate(cells[1:], 1)]
    return named, range(at, at + 1)


def _in_one_cell(above: Sequence[Row], at: int, n: int) -> tuple[Cells, range]:
    """``q = [10, -20.5, ...] deg`` or ``Joint angles [deg]: 10; -20.5; ...``."""
    cells = [cell for cell in above[at] if cell]
    found = _ONE_CELL.fullmatch(cells[0]) if len(cells) == 1 else None
    if not found or not (OF_JOINTS.match(found["word"]) or found["word"].lower() in ("q", "j")):
        return NONE
    numbers = re.split(r"[,;\s]+", found["numbers"].strip())
    unit = found["unit"].strip("[]() ") or unit_of_header(f"{found['word']} {found['stated']}")[1]
    if len(numbers) != n or (unit and not is_unit(unit)):
        return NONE
    named = [(f"J{k} [{unit}]" if unit else f"J{k}", cell) for k, cell in enumerate(numbers, 1)]
    return named, range(at, at + 1)


def _side_by_side(above: Sequence[Row], actuated: Row) -> tuple[Cells, range]:
    """A name, its number behind it, and perhaps a unit behind that."""
    named: dict[int, tuple[str, str]] = {}
    used: list[int] = []
    for at, row in enumerate(above):
        for k, cell in enumerate(row[:-1]):
            joint = _number_of(cell.rstrip("=: "), actuated)
            if joint is None or not is_number(row[k + 1]):
                continue
            if joint in named:  # of another pose, or commanded
                return NONE
            used.append(at)
            unit = row[k + 2].strip("[]() ") if k + 2 < len(row) else ""
            name = cell.rstrip("=: ")
            own = not unit_of_header(name)[1] and is_unit(unit)
            named[joint] = (f"{name} [{unit}]" if own else name, row[k + 1])
    cells = _in_turn(named, len(actuated))
    return (cells, range(used[0], used[-1] + 1)) if cells else NONE
