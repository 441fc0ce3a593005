"""Displacements of which not every axis was read: lost cells, one gauge, one along a direction."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import listed
from sk120stiff.measurements.directions import along_axes, in_columns, nearest_axes
from sk120stiff.measurements.importers.columns.gauge_units import GAUGE_WORDS
from sk120stiff.measurements.importers.columns.load_states import WITH, WITHOUT, state_of
from sk120stiff.measurements.importers.contract import Column, Meanings, Sheet
from sk120stiff.measurements.importers.told import (
    Told,
    negated,
    numbers,
    quantity,
    texts,
    unit_of,
)
from sk120stiff.measurements.table.columns import DIRECTIONS, DISPLACEMENTS

GAUGE = "gauge"  # meaning of what a dial gauge reads along `DIRECTIONS`
IN_A_LETTER = "reading direction"  # meaning of a column that has +X, -Z and so on instead
TINY = 1e-300  # of a direction that is none
BLANK = {
    "", "nan", "n/a", "na", "n.a.", "n.a", "-", "--", "---", "none", "null", "#n/a",
}  # fmt: skip
_READ = "(?:reading|value|anzeige|ablesung|wert|lecture|lettura|lectura|leitura)"
_GAUGES = re.compile(rf"(?:{_READ} (?:of )?)?(?:{GAUGE_WORDS})(?: ?{_READ})?(?: 1)?")


def with_gauges(names: Sequence[str], meanings: Sequence[tuple[str, float] | None]) -> Meanings:
    """``d`` beside ``ux uy uz``, or beside a column of letters of axes, is what a gauge reads along
    that direction; else those three are uncertainties."""
    plain = [" ".join(name.replace("_", " ").lower().split()) for name in names]
    read = [k for k, name in enumerate(plain) if _GAUGES.fullmatch(name) and meanings[k] is None]
    others = {known[0] for known in meanings if known}
    letters = IN_A_LETTER in others
    if letters and (pair := gauge_pair(names)):
        of = {k: (f"{state} {GAUGE}", 1.0) for state, k in pair.items()}
        return [of.get(k, known) for k, known in enumerate(meanings)]
    if letters and len(read) == 1 and not others & {"x", *DISPLACEMENTS}:
        return [(GAUGE, 1.0) if k in read else known for k, known in enumerate(meanings)]
    if set(DIRECTIONS) <= set(plain) and (pair := gauge_pair(names)):
        told = {name: (name, 1.0) for name in DIRECTIONS} | {
            plain[k]: (f"{state} {GAUGE}", 1.0) for state, k in pair.items()
        }
        return [told.get(name, known) for name, known in zip(plain, meanings, strict=True)]
    if len(read) != 1 or not set(DIRECTIONS) <= set(plain) or others & {"x", *DISPLACEMENTS}:
        return list(meanings)
    turned = {k: (name, 1.0) for k, name in enumerate(plain) if name in DIRECTIONS}
    turned[read[0]] = (GAUGE, 1.0)
    return [turned.get(k, known) for k, known in enumerate(meanings)]


def gauge_pair(names: Sequence[str]) -> dict[str, int]:
    """``unloaded`` and ``loaded`` → the column of what one gauge read so; empty without both."""
    out: dict[str, int] = {}
    for k, name in enumerate(names):
        said = state_of(" ".join(re.sub(r"[\s_.\-]+", " ", name).lower().split()))
        if said and _GAUGES.fullmatch(said[1]):
            if said[0] in out:
                return {}
            out[said[0]] = k
    return out if len(out) == len((WITHOUT, WITH)) else {}


def axes_among(meanings: Sequence[tuple[str, float] | None]) -> list[int]:
    """Columns of displacements of which some may be blank; none where positions were read."""
    words = {known[0] for known in meanings if known}
    if words & {"x", "measured x", "nominal x", "loaded x"}:
        return []
    return [k for k, known in enumerate(meanings) if known and known[0] in DISPLACEMENTS]


def without_blanks(row: tuple[str, ...], axes: Sequence[int]) -> tuple[str, ...]:
    """The row with empty cells where an axis was not read."""
    return tuple("" if k in axes and cell.lower() in BLANK else cell for k, cell in enumerate(row))


def say_unread(headers: Sequence[str], rows: Sequence[Sequence[str]], axes: Sequence[int]) -> str:
    """How many rows lack an axis, in a sentence; empty where none does."""
    lacking = sum(any(not row[k] for k in axes) for row in rows)
    if not lacking:
        return ""
    lost = {headers[k]: sum(not row[k] for row in rows) for k in axes}
    where = listed([f"{name} in {count}" for name, count in lost.items() if count])
    return (
        f"In {lacking} {'row' if lacking == 1 else 'rows'} an axis was not read ({where}): its "
        "cell stays blank, and the others count."
    )


def displacements(
    sheet: Sheet, told: Told
) -> tuple[Array, tuple[tuple[str, tuple[str, ...]], ...], list[Column], list[str]] | None:
    """(N, 3) [m], NaN where not read; as they are written, the columns they are from, and what is
    to be said. None where no column holds any.

    Raises:
        InputError: A unit that nobody said, or a cell that is no number.
    """
    if sheet.has(GAUGE, *DIRECTIONS):
        return _of_gauges(sheet, told)
    columns = {name: column for name in DISPLACEMENTS if (column := sheet.get(name))}
    if not columns:
        return None
    units = {name: unit_of(sheet, c, "length", told) for name, c in columns.items()}
    first = next(iter(units.values()))
    values = np.full((len(sheet.lines), 3), np.nan)
    written = []
    for k, name in enumerate(DISPLACEMENTS):
        column = columns.get(name)
        unit = units.get(name, first)
        if column is not None:
            values[:, k] = quantity(sheet, column, "length", unit, unread=True)
        cells = texts(column) if column is not None else ("",) * len(sheet.lines)
        written.append((f"{name}[{unit}]", cells))
    missing = [name for name in DISPLACEMENTS if name not in columns]
    said = [f"Of {listed(missing)} there is no column: not read."] if missing else []
    gauges = [f"{c.header} along {name[1]}" for name, c in columns.items() if _of_gauge(c.header)]
    if gauges:
        said.append(
            f"{listed(gauges)}: of a gauge, whose reading is taken to rise along that axis of the "
            "base; where it falls, turn the sign of the column."
        )
    return values, tuple(written), list(columns.values()), said


def _of_gauge(header: str) -> bool:
    """Does a header name a gauge, and not a difference alone, as dx does?"""
    words = header.lower().split()
    return words[:1] != ["d"] and re.match(rf"{GAUGE_WORDS}\b", header.lower()) is not None


def _of_gauges(
    sheet: Sheet, told: Told
) -> tuple[Array, tuple[tuple[str, tuple[str, ...]], ...], list[Column], list[str]]:
    """What was read along directions; as displacements where these are axes of the base."""
    gauge, *along = sheet.those(GAUGE, *DIRECTIONS)
    unit = unit_of(sheet, gauge, "length", told)
    read = quantity(sheet, gauge, "length", unit)
    directions = np.column_stack([numbers(sheet, column) for column in along])
    said = (
        f"{gauge.header} is what a gauge read along the direction "
        f"{', '.join(dict.fromkeys(c.header for c in along))}, in axes of the base"
    )
    taken, cells = [gauge, *along], texts(gauge)
    unit_vectors = directions / np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), TINY)
    marker = sheet.get("marker")
    one = marker is None or len(set(marker.cells)) == 1
    if one and along_axes(unit_vectors).all():
        axis, sign = nearest_axes(unit_vectors)
        signed = [negated(cell) if s < 0.0 else cell for cell, s in zip(cells, sign, strict=True)]
        axes = tuple(
            (
                f"{name}[{unit}]",
                tuple(c if a == k else "" for c, a in zip(signed, axis, strict=True)),
            )
            for k, name in enumerate(DISPLACEMENTS)
        )
        said += ": each number stands under dx, dy or dz, the other two were not read."
        return in_columns(unit_vectors, read), axes, taken, [said]
    written = (
        (f"d[{unit}]", cells),
        *((name, texts(column)) for name, column in zip(DIRECTIONS, along, strict=True)),
    )
    return np.full((len(sheet.lines), 3), np.nan), written, taken, [f"{said}."]
