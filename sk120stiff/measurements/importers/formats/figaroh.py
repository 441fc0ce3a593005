"""Several markers side by side: ``x1,y1,z1,x2`` as FIGAROH writes, ``SMR2 X``, ``M1_x``."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.words import meaning_of, unit_of_header
from sk120stiff.measurements.importers.contract import NO, Column, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout.layout import Layout, layout_of, sheet_of
from sk120stiff.measurements.table.columns import POSITIONS

_MARKER = re.compile(
    r"(?P<what>phi|d)?(?P<axis>[xyz])[ _.-]?(?P<number>[1-9]\d*)"
    r"|(?:markers?|reflectors?|smr|nest|point|target|[mnpt])?[ _.-]?(?P<number_before>[1-9]\d*)"
    r"[ _.-]?(?P<what_before>d)?(?P<axis_behind>[xyz])",
    re.IGNORECASE,
)
_ZERO = re.compile(r"[xyz][ _.-]?0", re.IGNORECASE)


@dataclass(frozen=True)
class Figaroh:
    """Several markers side by side: one that is chosen, or each a reading of its own."""

    name: str = "figaroh"
    title: str = "a table of markers by their number, as FIGAROH's"

    def sniff(self, source: Source) -> Guess:
        """Columns x1, y1 ... in the header."""
        names = _headers(source) if source.role == "points" else []
        if not set(POSITIONS) & set(names) and any(_axis_of(name) for name in names):
            return Guess(0.9, _why(source))
        return NO

    def read(self, source: Source) -> Sheet:
        """The readings of one marker, or of all of them, each in a row of its own.

        Raises:
            InputError: The marker is not there or incomplete.
        """
        _refuse_number_zero(source)
        found = [marker for name in _headers(source) if (marker := _axis_of(name))]
        numbers = sorted({number for number, _ in found})
        chosen = numbers if source.marker is None else [_chosen(source, numbers)]
        turns = {turn for name in _headers(source) if (turn := _turn_of(name))}
        turned = {(number, axis) for number in chosen for axis in POSITIONS} <= turns
        sheets = {number: self._of(source, number, set(found), turned=turned) for number in chosen}
        if source.marker is not None or len(sheets) == 1:
            return replace(next(iter(sheets.values())), marker=source.marker)
        return _stacked(sheets)

    def _of(
        self, source: Source, number: int, found: set[tuple[int, str]], *, turned: bool
    ) -> Sheet:
        """The readings of one marker; `turned`: with its orientation, phix1 and so on."""
        kind = "d" if (number, "dx") in found else ""
        for axis in POSITIONS:
            if (number, kind + axis) not in found:
                raise InputError(
                    f"the column '{kind}{axis}{number}' is missing",
                    where=source.grid.place(0),
                    remedy="A marker has three columns: "
                    f"{', '.join(f'{kind}{axis}{number}' for axis in POSITIONS)}.",
                )

        def meaning(name: str, actuated: tuple[str, ...]) -> tuple[str, float] | None:
            if name not in actuated and _MARKER.fullmatch(name):
                turn = _turn_of(name) if turned else None
                if turn and turn[0] == number:
                    return f"orientation {turn[1]}", 1.0
                marker = _axis_of(name)
                return (marker[1], 1.0) if marker and marker[0] == number else None
            return meaning_of(name, actuated)

        layout: Layout | None = layout_of(source, meaning)
        if layout is None:
            raise InputError("no marker is in this file", where=str(source.path))
        said = (f"Marker {number} is read.",) if source.marker else ()
        return sheet_of(source, layout, self.title, _why(source), notes=said)


def _refuse_number_zero(source: Source) -> None:
    """Refuse ``x0`` beside ``x1``, which may be a marker more, or a reading without load.

    Raises:
        InputError: It stands there.
    """
    zero = [name for name in _headers(source) if _ZERO.fullmatch(name)]
    if zero:
        raise InputError(
            f"{', '.join(zero)} may be of one marker more, or a reading without load",
            where=source.grid.place(0),
            remedy="Rename the columns, or name all of them with --columns: x_unloaded ... and "
            "x_loaded ... where the load came between; x1 ..., x2 ... for several markers.",
        )


def _stacked(sheets: dict[int, Sheet]) -> Sheet:
    """One sheet of several of one table: a row for each marker, beside it a column of its number.

    A row in which one marker was lost keeps the others.
    """
    first = next(iter(sheets.values()))
    rows = sorted(
        (rank, number, row)
        for number, sheet in sheets.items()
        for row, rank in enumerate(sheet.rank)
    )

    def cells(columns: list[tuple[str, ...]]) -> tuple[str, ...]:
        of = dict(zip(sheets, columns, strict=True))
        return tuple(of[number][row] for _, number, row in rows)

    columns, spare = (
        tuple(
            replace(
                each[0],
                header=", ".join(dict.fromkeys(column.header for column in each)),
                cells=cells([column.cells for column in each]),
            )
            for each in zip(*kind, strict=True)
        )
        for kind in (
            [sheet.columns for sheet in sheets.values()],
            [[c for c in sheet.spare if not _of_a_marker(c)] for sheet in sheets.values()],
        )
    )
    label = Column("marker", "marker", None, "", tuple(str(number) for _, number, _ in rows))
    skipped = [
        (line, f"marker {number}: {reason}")
        for number, sheet in sheets.items()
        for line, reason in sheet.skipped
    ]
    return replace(
        first,
        columns=(*columns, label),
        spare=spare,
        lines=tuple(sheets[number].lines[row] for _, number, row in rows),
        rank=tuple(rank for rank, _, _ in rows),
        skipped=tuple(sorted(skipped)),
        notes=(
            *first.notes,
            f"Each row is a reading of {len(sheets)} markers, and becomes as many rows.",
        ),
    )


def _why(source: Source) -> str:
    found = next(name for name in _headers(source) if _axis_of(name))
    return f"columns such as {found}, of markers by their number"


def _of_a_marker(column: Column) -> bool:
    return _axis_of(unit_of_header(column.header)[0]) is not None


def _axis_of(name: str) -> tuple[int, str] | None:
    """Number of the marker and what the column holds of it: ``x``, or ``dx`` of a displacement."""
    found = _MARKER.fullmatch(name)
    if found is None or found["what"] == "phi":
        return None
    number = found["number"] or found["number_before"]
    axis = found["axis"] or found["axis_behind"]
    return int(number), f"{found['what'] or found['what_before'] or ''}{axis}".lower()


def _turn_of(name: str) -> tuple[int, str] | None:
    """Number of the marker and axis of an angle, ``phix1``."""
    found = _MARKER.fullmatch(name)
    if found is None or found["what"] is None or found["what"].lower() != "phi":
        return None
    return int(found["number"]), found["axis"].lower()


def _headers(source: Source) -> list[str]:
    """Names of the columns without units: as told, else the first row."""
    cells = source.columns or next(iter(source.grid.rows), ())
    return [unit_of_header(cell)[0] for cell in cells]


def _chosen(source: Source, markers: list[int]) -> int:
    wanted = source.marker or ""
    chosen = int(wanted) if wanted.isdecimal() else 0
    if chosen not in markers:
        raise InputError(
            f"this file has no marker {wanted}",
            where=source.grid.place(0),
            remedy=f"There is {', '.join(map(str, markers))}."
            if markers
            else "Its columns are x1, y1, z1.",
        )
    return chosen
