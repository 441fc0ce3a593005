"""Headers in two rows become one: what stands above x y z says what they are of.

``Position before`` above ``x y z`` is a position without load, ``Force [N]`` above them a force,
and ``Joint angles [deg]`` above ``q1 ... q6`` states their unit.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence

from sk120stiff import units
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.load_states import (
    WITH,
    WITHOUT,
    state_of,
    with_states,
)
from sk120stiff.measurements.importers.columns.words import (
    is_unit,
    kind_of,
    meaning_of,
    unit_of_header,
)
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid, is_number
from sk120stiff.measurements.table.columns import POSITIONS

SEARCHED = 80  # rows that may stand above the headers
FEWEST = 3  # columns that the lower row, alone or with the upper one, names at least
SHORTEST = 3  # letters of a word above x y z; fewer may be the name of a marker, if no unit follows
_MARKERS = ("nominal x", "measured x", "tcp x")  # words such as Target, Tracker, Tool: markers, too
_NO_GROUP = ("x", "orientation x", "qx", "tx")
OF_JOINTS = re.compile(  # a word above 1 2 3 ..., or before the values of joints
    r"(?:robot )?(?:joint|axis|axes|gelenk|achs|axe|assi|giunt|eje|articula|junta|eixo|关节|轴)",
    re.IGNORECASE,
)
Row = tuple[str, ...]


def in_one_row(source: Source) -> Source:
    """The source with such headers in one row; as it is where it has none.

    Raises:
        InputError: Several markers without and with load side by side.
    """
    grid = source.unnamed_grid
    if grid is None:
        return source
    grid = _of_sheet(grid, len(source.actuated))
    source = source if grid is source.grid else dataclasses.replace(source, given=grid)
    for k in range(1, min(SEARCHED, len(grid.rows))):
        if _worded(grid.rows[k - 1]):
            grid = _with_joints(grid, k)
        if _worded(grid.rows[k - 1]) and _worded(grid.rows[k]):
            made = _joined(grid, k, source.actuated)
            if made is not None:
                return dataclasses.replace(source, given=made)
    return source


def _of_sheet(grid: Grid, joints: int) -> Grid:
    """The grid with a first row of 1 2 3 ... as J1 J2 J3 ..., where the sheet is called Joints."""
    first = grid.rows[0] if grid.rows else ()
    numbers = [cell for cell in first if is_number(cell)]
    counted = numbers == [str(k + 1) for k in range(joints)]
    if not (grid.sheet and OF_JOINTS.match(grid.sheet) and counted):
        return grid
    named = tuple(f"J{cell}" if is_number(cell) else cell for cell in first)
    return dataclasses.replace(grid, rows=(named, *grid.rows[1:]))


def _with_joints(grid: Grid, at: int) -> Grid:
    """The grid with 1 2 3 ... below a word for joints as J1 J2 J3 ...; as it is without such."""
    upper, lower = grid.rows[at - 1], grid.rows[at]
    above = _spread(upper, lower)
    counts = [k for k, cell in enumerate(lower) if cell.isdigit() and OF_JOINTS.match(above[k])]
    numbers = [int(lower[k]) for k in counts]
    begins = numbers[:1] in ([0], [1]) and len(numbers) > 1
    if not begins or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        return grid
    named = tuple(f"J{cell}" if k in counts else cell for k, cell in enumerate(lower))
    return dataclasses.replace(grid, rows=(*grid.rows[:at], named, *grid.rows[at + 1 :]))


def _worded(row: Row) -> bool:
    """Several cells, none of them a number, and not units alone."""
    cells = [cell for cell in row if cell]
    if len(cells) < 2 or any(map(is_number, cells)):
        return False
    return not all(is_unit(cell.strip("[]() ")) for cell in cells)


def _joined(grid: Grid, at: int, actuated: Row) -> Grid | None:
    upper, lower = grid.rows[at - 1], grid.rows[at]
    above = _spread(upper, lower)
    named = [unit_of_header(cell) for cell in lower]
    if any("rotation" in cell.lower() for cell in above):  # of mocap programs, known elsewhere
        return None
    place = f"{grid.path}, line {grid.lines[at - 1]}"
    told = _told(above, [name for name, _ in named], _units(grid, at, above), place)
    headers: list[str] = []
    for k, cell in enumerate(lower):
        if k in told:
            unit = named[k][1] or (of if _is_load(of := unit_of_header(above[k])[1]) else None)
            headers.append(told[k] + (f" [{unit}]" if unit else ""))
        elif (not cell or (told and is_unit(cell.strip("[]() ")))) and _known(
            name := _at(upper, k), actuated
        ):
            headers.append(f"{name} [{cell.strip('[]() ')}]" if cell else name)
        else:
            headers.append(cell)
    headers = [_with_unit(h, a, actuated) for h, a in zip(headers, above, strict=True)]
    own = sum(k in told or _known(cell, actuated) for k, cell in enumerate(lower))
    if tuple(headers) == lower or own < FEWEST:  # the lower row may be one of units
        return None
    rows, lines = list(grid.rows), list(grid.lines)
    rows[at] = tuple(headers)
    if not any(name.lower() in POSITIONS and k not in told for k, (name, _) in enumerate(named)):
        del rows[at - 1], lines[at - 1]  # else names of markers may stand there
    said = f"headers of lines {grid.lines[at - 1]} and {grid.lines[at]} together"
    how = f"{grid.how}, {said}" if grid.how else said
    return dataclasses.replace(grid, rows=tuple(rows), lines=tuple(lines), how=how)


def _at(row: Row, k: int) -> str:
    return row[k] if k < len(row) else ""


def _spread(upper: Row, lower: Row) -> list[str]:
    """What stands above every cell of the lower row: of an empty one, what stands left of it."""
    out: list[str] = []
    for k in range(len(lower)):
        out.append(_at(upper, k) or (out[-1] if out and lower[k] else ""))
    return out


def _units(grid: Grid, at: int, above: Sequence[str]) -> list[str | None]:
    """The unit of each column of the lower row: in its header, in the one above, or below it."""
    below = grid.rows[at + 1] if at + 1 < len(grid.rows) else ()
    texts = [cell.strip("[]() ") for cell in below]
    stated = [cell if is_unit(cell) else None for cell in texts]
    of_rows = stated if not any(map(is_number, below)) and any(stated) else []
    own = [unit_of_header(cell)[1] for cell in grid.rows[at]]
    return [
        unit or unit_of_header(cell)[1] or (of_rows[k] if k < len(of_rows) else None)
        for k, (unit, cell) in enumerate(zip(own, above, strict=True))
    ]


def _told(
    above: Sequence[str], below: Sequence[str], stated: Sequence[str | None], where: str
) -> dict[int, str]:
    """Column → its header, where only both rows together tell what it is.

    Raises:
        InputError: As `in_one_row`.
    """
    groups: dict[str, list[int]] = {}
    for k, (cell, name) in enumerate(zip(above, below, strict=True)):
        if cell and name.lower() in POSITIONS:
            groups.setdefault(cell, []).append(k)
    whole = {c: p for c, p in groups.items() if [below[k].lower() for k in p] == list(POSITIONS)}
    names = {cell: unit_of_header(cell)[0] for cell in whole}
    loads = {cell for cell, places in whole.items() if _is_load(stated[places[0]])}
    called = _called({c: n for c, n in names.items() if c not in loads}, where)
    called |= {cell: names[cell] for cell in loads}
    out = {k: f"{called[c]} {below[k]}" for c, p in whole.items() if c in called for k in p}
    pairs = [unit_of_header(cell)[0] if cell else "" for cell in above]
    both = [f"{a} {b}" if b else "" for a, b in zip(pairs, below, strict=True)]
    states = with_states(both, [meaning_of(each) for each in both])
    for k, known in enumerate(states):  # x above before and after
        if known and known[0].startswith((WITHOUT, WITH)) and state_of(_plain(below[k])):
            out[k] = both[k]
    return out


def _is_load(unit: str | None) -> bool:
    return unit is not None and (units.is_kind(unit, "force") or units.is_kind(unit, "moment"))


def _called(names: dict[str, str], where: str) -> dict[str, str]:
    """What stands above x y z → what the headers say of it; names of markers are left out."""
    states = {cell: state_of(_plain(name)) for cell, name in names.items()}
    pair = {cell: state for cell, state in states.items() if state}
    rests = {re.sub(r"(?<!\w)\d+(?!\w)", "", rest).strip() for _, rest in pair.values()}
    if len(pair) > len({state for state, _ in pair.values()}):
        raise InputError(
            f"{listed(list(pair))}: positions of several markers without and with load stand side "
            "by side",
            where=where,
            remedy="Write a row for each reading, with columns marker, x, y, z and its load; or "
            "give the columns of one marker alone.",
        )
    axes = [f"{name} x" for name in names.values()]
    known = with_states(axes, [meaning_of(axis) for axis in axes])
    of = {cell: each[0] for cell, each in zip(names, known, strict=True) if each}
    if len(pair) == 2 and len(rests) == 1 and meaning_of(f"{rests.pop()} x") in (None, ("x", 1.0)):
        beside = {cell: names[cell] for cell in of if _is_sure(of[cell])}
        return {cell: state for cell, (state, _) in pair.items()} | beside
    all_known = len(set(of.values())) == len(names) > 1
    return {
        cell: names[cell]
        for cell, meaning in of.items()
        if (_is_sure(meaning) or (all_known and meaning in _MARKERS[:2]) or "tcp" in cell.lower())
        and (len(names[cell]) >= SHORTEST or names[cell] != cell)
    }


def _plain(name: str) -> str:
    return " ".join(re.sub(r"[_.\-:()\[\],]+", " ", name).lower().split())


def _is_sure(meaning: str) -> bool:
    return meaning not in (*_MARKERS, *_NO_GROUP)


def _known(header: str, actuated: Row) -> bool:
    return bool(header) and meaning_of(unit_of_header(header)[0], actuated) is not None


def _with_unit(header: str, above: str, actuated: Row) -> str:
    """The header with the unit that stands above, where it has none and that is of its kind."""
    name, unit = unit_of_header(header)
    known = meaning_of(name, actuated) if name else None
    stated = unit_of_header(above)[1]
    if known is None or unit or stated is None or header == above:
        return header
    kind = "moment" if known[0] in ("mx", "my", "mz") else kind_of(known[0])
    fits = kind is not None and units.is_unit(stated) and units.is_kind(stated, kind)
    return f"{header} [{stated}]" if fits else header
