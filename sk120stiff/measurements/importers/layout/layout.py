"""Where in a grid the table is, and what its columns are called."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from sk120stiff import units
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.clock import in_seconds
from sk120stiff.measurements.importers.columns.compound_groups import with_compounds
from sk120stiff.measurements.importers.columns.gauge_units import counted_unit, multiplied
from sk120stiff.measurements.importers.columns.joint_names import with_joint_names
from sk120stiff.measurements.importers.columns.label_words import with_labels
from sk120stiff.measurements.importers.columns.load_states import with_states
from sk120stiff.measurements.importers.columns.masses import with_masses
from sk120stiff.measurements.importers.columns.matrices import with_matrices
from sk120stiff.measurements.importers.columns.orientations import with_quaternions
from sk120stiff.measurements.importers.columns.unread_axes import (
    BLANK,
    GAUGE,
    axes_among,
    say_unread,
    with_gauges,
    without_blanks,
)
from sk120stiff.measurements.importers.columns.vendor_joints import with_vendor_joints
from sk120stiff.measurements.importers.columns.words import (
    UNITS_IN_WORDS,
    as_measured,
    file_units,
    is_needed,
    is_unit,
    kind_of,
    meaning_of,
    unit_of_header,
    with_forces,
    with_torques,
)
from sk120stiff.measurements.importers.contract import Column, Meanings, Sheet, Source
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.layout.headerless import cut, no_rows, numeric
from sk120stiff.measurements.table.columns import DISPLACEMENTS, FORCES, POSITIONS

NEEDED = {
    "points": (
        POSITIONS,
        ("measured x", "measured y", "measured z"),
        ("nominal x", "nominal y", "nominal z"),
        ("loaded x", "loaded y", "loaded z"),
        *((axis,) for axis in (*DISPLACEMENTS, GAUGE)),
        *((f"loaded {word}", f"unloaded {word}") for word in (*POSITIONS, GAUGE)),
    ),
    "joints": (("joint 1",), ("joint 0",)),
    "loads": tuple(
        (word,) for word in (*FORCES, "payload", "load", "direction", "force direction")
    ),
}
SEARCHED = 80  # rows that may stand above the headers
LISTED = 12  # comments and lines above the table that are shown one by one
_UNIT_WORDS = ("unit", "units", "einheit", "einheiten", "unité", "unités", "unidad", "unità")
ABOVE = "the lines above the table"
_FRAME = re.compile(r"(?:working )?frame\W+(?!rate)(.+)", re.IGNORECASE)

Meaning = Callable[[str, tuple[str, ...]], tuple[str, float] | None]


@dataclass(frozen=True)
class Layout:
    """A table within a grid.

    Args:
        headers: Name of each column as written.
        meanings: What each means and its factor, or None.
        units: Unit of each as stated, or None, and `stated` in which place; without a unit, what
            stands in that place instead.
        first: Index of the first row below the headers.
        above: Lines above the table, as text with their numbers.
        notes: What is to be said of the units, in sentences.
    """

    headers: tuple[str, ...]
    meanings: tuple[tuple[str, float] | None, ...]
    units: tuple[str | None, ...]
    stated: tuple[str, ...]
    first: int
    above: tuple[tuple[int, str], ...]
    notes: tuple[str, ...] = ()

    def has(self, *meanings: str) -> bool:
        """Are all of these among the columns?"""
        return set(meanings) <= {m[0] for m in self.meanings if m}


def layout_of(source: Source, meaning: Meaning = meaning_of) -> Layout | None:
    """The table with headers of a grid, or None where no row is one of headers.

    Headers are those that were told, with a row of units that stands above the numbers, else the
    first row that names what is needed, else a comment above the numbers that does.
    """
    grid = source.grid
    if source.columns is not None:
        first = next((k for k, row in enumerate(grid.rows) if numeric(row)), len(grid.rows))
        if 0 < first < len(grid.rows) and _is_units(grid.rows[first - 1]):
            first -= 1  # names were told, units stand in the file
        return _laid_out(source, tuple(source.columns), first, first, "as told", meaning)
    for k in range(min(SEARCHED, len(grid.rows))):
        row = _with_what_stands_above(grid.rows, k)
        if numeric(row):  # a point may be called A1, as an axis is
            continue
        if _names_enough(row, source, meaning, grid.rows[k + 1 :]):
            return _laid_out(source, row, k, k + 1, f"line {grid.lines[k]}", meaning)
    start = next((k for k, row in enumerate(grid.rows) if numeric(row)), None)
    for number, text in reversed(grid.comments):
        if start is None or number > grid.lines[start]:
            continue
        for mark in (r"\s*[,;\t]\s*", r"\s*[,;\t]\s*|\s+"):
            headers = tuple(c for c in re.split(mark, text) if c)
            long = len(headers) == len(grid.rows[start])
            if long and _names_enough(headers, source, meaning, grid.rows[start:]):
                return _laid_out(source, headers, start, start, f"line {number}", meaning)
    return None


def _with_what_stands_above(rows: tuple[tuple[str, ...], ...], k: int) -> tuple[str, ...]:
    """Headers in two rows, as mocap programs write them: Rotation above X, Position above X."""
    row, above = rows[k], rows[k - 1] if k else ()
    words = [cell.strip().lower() for cell in above]
    if len(above) != len(row) or not {"rotation", "position"} <= set(words):
        return row
    axes = [cell.strip().lower() for cell in row]
    turned = {axis for word, axis in zip(words, axes, strict=True) if word == "rotation"}
    called = {"position": "position", "rotation": "quat" if "w" in turned else "rotation"}
    return tuple(
        f"{called[word]} {cell}" if word in called and axis in "xyzw" else cell or name
        for word, axis, cell, name in zip(words, axes, row, above, strict=True)
    )


def _names_enough(
    row: tuple[str, ...], source: Source, meaning: Meaning, below: tuple[tuple[str, ...], ...]
) -> bool:
    known, _, _ = _understood(source, ["" if is_number(c) else c for c in row], meaning, below)
    found = {each[0] for each in known if each}
    return any(set(group) <= found for group in NEEDED[source.role])


def _laid_out(
    source: Source, headers: tuple[str, ...], at: int, first: int, stated: str, meaning: Meaning
) -> Layout:
    grid = source.grid
    longest = max((len(cut(row)) for row in grid.rows[first:]), default=0)
    headers = cut(headers, min(len(headers), longest))  # cells may stand below a blank one
    named = [unit_of_header(h) if h else ("", None) for h in headers]
    units = [unit for _, unit in named]
    places = [f"the header, {stated}" if unit else "" for unit in units]
    strange: list[str] = []
    if first < len(grid.rows) and _is_units(grid.rows[first]):
        line = f"line {grid.lines[first]}"
        for k, cell in enumerate(grid.rows[first][: len(units)]):
            text = _unit_in(cell)
            if text.lower() in (*BLANK, *_UNIT_WORDS) or units[k] or cell == headers[k]:
                continue
            if is_unit(text):
                units[k], places[k] = text, line
            else:
                places[k] = f"{line}: {text!r}"
                strange.append(f"{text!r} ({headers[k]})")
        first += 1
        if strange:
            strange = [f"In the units of {line} these are not known: {', '.join(strange)}."]
    above = [
        (grid.lines[k], "  ".join(c for c in row if c)) for k, row in enumerate(grid.rows[:at])
    ]
    known, units, told = _understood(source, headers, meaning, grid.rows[first:], units)
    places = [p or f"the header, {stated}" * bool(u) for p, u in zip(places, units, strict=True)]
    below = grid.rows[first:]
    meanings = as_measured(with_quaternions([name for name, _ in named], known, below))
    said = file_units([text for _, text in (*above, *grid.comments)])
    for k, each in enumerate(meanings):
        kind = kind_of(each[0]) if each else None
        if kind in said and units[k] is None:
            units[k], places[k] = said[kind], ABOVE
    for k, stated_there in enumerate(_of_title(grid.sheet, meanings)):
        if stated_there and units[k] is None:
            units[k], places[k] = stated_there, f"the name of the sheet {grid.sheet}"
    return Layout(
        headers, meanings, tuple(units), tuple(places), first, tuple(above), (*strange, *told)
    )


def _of_title(title: str | None, meanings: Sequence[tuple[str, float] | None]) -> list[str | None]:
    """The unit in brackets behind a sheet's name, for each column of which it may be the unit."""
    unit = unit_of_header(title)[1] if title and title.endswith((")", "]")) else None
    kinds = [kind_of(known[0]) if known else None for known in meanings]
    return [unit if unit and kind and units.is_kind(unit, kind) else None for kind in kinds]


def _understood(
    source: Source,
    headers: Sequence[str],
    meaning: Meaning,
    below: tuple[tuple[str, ...], ...],
    stated: Sequence[str | None] | None = None,
) -> tuple[Meanings, list[str | None], list[str]]:
    """What columns mean, each by its name and by those beside it, their units, and what was chosen.

    Units are those that are `stated` in headers or in a row of units, else those of the headers.
    """
    named = [unit_of_header(header) if header else ("", None) for header in headers]
    names = [name for name, _ in named]
    units_of = list(stated) if stated is not None else [unit for _, unit in named]
    known = [meaning(name, source.actuated) if name else None for name in names]
    known = with_forces(names, with_gauges(names, with_states(names, known)), units_of)
    where = str(source.path)
    known, units_of, notes = with_compounds(
        headers, known, units_of, source.actuated, source.topic,
        where if source.role == "points" else None,
    )  # fmt: skip
    known, units_of = with_masses(names, known, units_of)
    known = with_torques(known, units_of)
    known = with_vendor_joints(names, known, source.actuated)
    known, of_matrix = with_matrices(names, known, below)
    known, of_joints = with_joint_names(headers, known, below, source.actuated, where)
    known = with_labels(names, known, units_of)
    return known, units_of, [*notes, *of_matrix, *of_joints]


def _unit_in(cell: str) -> str:
    """The text of a cell in a row of units, without brackets and in the words of units."""
    return UNITS_IN_WORDS.get(cell.strip("[]() ").lower(), cell.strip("[]() "))


def _is_units(row: tuple[str, ...]) -> bool:
    """Is this a row of units: no number, and as many cells that are units as others?"""
    cells = [c for cell in row if (c := _unit_in(cell)).lower() not in (*BLANK, *_UNIT_WORDS)]
    known = sum(map(is_unit, cells))
    return known > 0 and not any(map(is_number, cells)) and 2 * known >= len(cells)


def sheet_of(
    source: Source,
    layout: Layout,
    title: str,
    why: str,
    *,
    assumed_units: Mapping[str, str] | None = None,
    notes: tuple[str, ...] = (),
) -> Sheet:
    """The readings of a table.

    Args:
        source, layout: The file and where its table is.
        title, why: The format and how it was recognised.
        assumed_units: Units that the format itself prescribes, by ``length`` and ``angle``.
        notes: What else is to be said.

    Raises:
        InputError: A row of another length, or no row of readings.
    """
    grid, width = source.grid, len(layout.headers)
    rows: list[tuple[str, ...]] = []
    lines: list[int] = []
    rank: list[int] = []
    skipped: list[tuple[int, str]] = []
    total = 0
    needed = [k for k, m in enumerate(layout.meanings) if m and is_needed(m[0])]
    axes = axes_among(layout.meanings)
    for k in range(layout.first, len(grid.rows)):
        row = cut(grid.rows[k], width)
        named = len(row) == width and row[0]  # a point that was not measured
        if not any(map(is_number, row)) and not named:
            skipped.append((grid.lines[k], f"no numbers: {'  '.join(row)[:60]}"))
            continue
        if len(row) > width or len(row) <= max(needed, default=0):
            raise InputError(
                f"{len(row)} cells, but there are {width} columns",
                where=grid.place(k),
                remedy="Names that hold the separator stand in quotation marks."
                if len(row) > width
                else "Fill the missing cells, or delete the line if it is no reading.",
            )
        row = (*row, *[""] * (width - len(row)))
        total += 1
        row = without_blanks(row, axes)
        lost = axes if any(row[c] for c in axes) else ()
        blank = [layout.headers[c] for c in needed if c not in lost and row[c].lower() in BLANK]
        if blank:
            skipped.append((grid.lines[k], f"nothing stands in {', '.join(blank)}"))
            continue
        rows.append(row)
        lines.append(grid.lines[k])
        rank.append(total - 1)
    if not rows:
        raise no_rows(source, [layout.headers[k] for k in needed], total)
    columns, spare, twice = _columns(
        layout, list(zip(*rows, strict=True)), dict(assumed_units or {})
    )
    above = [*grid.comments, *layout.above]
    by_above = ABOVE in layout.stated
    above = [(k, t) for k, t in above if not (_FRAME.search(t) or (by_above and file_units([t])))]
    remarks = [f"line {number}: {text}" for number, text in above[:LISTED] if text]
    if len(above) > LISTED:
        remarks.append(f"{len(above) - LISTED} more comments and lines above the table")
    frame = next(
        (m[1] for _, t in (*grid.comments, *layout.above) if (m := _FRAME.search(t))), None
    )
    return Sheet(
        path=source.path,
        title=title,
        why=why,
        columns=tuple(columns),
        lines=tuple(lines),
        unused=(*twice, *remarks, *grid.left),
        skipped=tuple(skipped),
        rank=tuple(rank),
        total=total,
        spare=tuple(spare),
        frame=frame,
        notes=(
            *((f"Read as {grid.how}.",) if grid.how else ()),
            *notes,
            *layout.notes,
            *filter(None, [say_unread(layout.headers, rows, axes)]),
        ),
        remarks=(*grid.comments, *layout.above),
    )


def sheet_by_order(
    source: Source,
    names: tuple[str, ...],
    title: str,
    why: str,
    prescribed: Mapping[str, str] | None = None,
) -> Sheet:
    """The readings under their headers, or under `names` where the file has none.

    Units that the format prescribes count where headers show that it is this format.

    Raises:
        InputError: As `sheet_of`, or there are no names either.
    """
    layout = layout_of(source)
    units = prescribed if layout is not None else None
    if layout is None and names:
        layout = layout_of(replace(source, columns=names))
    if layout is None:
        raise InputError(
            f"this is not {title}",
            where=str(source.path),
            remedy="Leave --format out, or name the columns with --columns.",
        )
    return sheet_of(source, layout, title, why or "as told", assumed_units=units)


def _columns(
    layout: Layout, cells: list[tuple[str, ...]], assumed: dict[str, str]
) -> tuple[list[Column], list[Column], list[str]]:
    """Columns with a meaning, those without, and meanings that stand there twice."""
    columns: list[Column] = []
    spare: list[Column] = []
    twice: list[str] = []
    for k, header in enumerate(layout.headers):
        known = layout.meanings[k]
        if known is None:
            if any(cells[k]):
                name = header.strip("-") or f"column {k + 1}"
                spare.append(_in_one_unit(name, "", layout, k, cells[k]))
            continue
        meaning, factor = known
        if any(c.meaning == meaning for c in columns):
            twice.append(f"column {header}: a second {meaning}")
            continue
        column = replace(_in_one_unit(header, meaning, layout, k, cells[k]), factor=factor)
        if column.unit is None and (kind := kind_of(meaning)) in assumed:
            column = replace(column, unit=assumed[kind], stated="the format prescribes it")
        columns.append(column)
    return columns, spare, twice


def _in_one_unit(
    header: str, meaning: str, layout: Layout, k: int, cells: tuple[str, ...]
) -> Column:
    """A column; what counts parts of a unit, as 1/100 mm, becomes numbers in a unit."""
    unit, stated = layout.units[k], layout.stated[k]
    if meaning == "time":
        cells, unit = in_seconds(cells, unit)
    counted = counted_unit(unit) if unit and not units.is_unit(unit) else None
    if counted is None:
        return Column(header, meaning, unit, stated, cells)
    cells = tuple(multiplied(cell, counted[1]) for cell in cells)
    return Column(header, meaning, counted[0], f"{stated}: {unit}", cells)
