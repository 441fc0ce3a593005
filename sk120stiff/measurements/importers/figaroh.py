"""Calibration files as FIGAROH takes them: ``x1,y1,z1``, orientations, joints."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout import Layout, layout_of, sheet_of
from sk120stiff.measurements.importers.words import meaning_of, unit_of_header

_MARKER = re.compile(r"(?:phi)?([xyz])([1-9]\d*)")


@dataclass(frozen=True)
class Figaroh:
    """Several markers side by side; one is chosen."""

    name: str = "figaroh"
    title: str = "FIGAROH's calibration file"

    def sniff(self, source: Source) -> Guess:
        """Columns x1, y1 ... in the header."""
        names = _headers(source) if source.role == "points" else []
        if not {"x", "y", "z"} & set(names) and any(_MARKER.fullmatch(name) for name in names):
            return Guess(0.9, "columns x1, y1, z1")
        return NO

    def read(self, source: Source) -> Sheet:
        """The readings of one marker.

        Raises:
            InputError: The marker is not there, incomplete, or one of several and nobody chose.
        """
        headers = _headers(source)
        number = _chosen(
            source, sorted({int(m[2]) for h in headers if (m := _MARKER.fullmatch(h))})
        )
        for axis in "xyz":
            if f"{axis}{number}" not in headers:
                raise InputError(
                    f"the column '{axis}{number}' is missing",
                    where=source.grid.place(0),
                    remedy=f"A marker has three columns: x{number}, y{number}, z{number}.",
                )

        def meaning(name: str, actuated: tuple[str, ...]) -> tuple[str, float] | None:
            marker = _MARKER.fullmatch(name)
            if marker is None:
                return meaning_of(name, actuated)
            own = int(marker[2]) == number and not name.startswith("phi")
            return (marker[1], 1.0) if own else None

        layout: Layout | None = layout_of(source, meaning)
        if layout is None:
            raise InputError("no marker is in this file", where=str(source.path))
        said = (f"Marker {number} is read.",) if source.marker else ()
        sheet = sheet_of(source, layout, self.title, "columns x1, y1, z1", notes=said)
        return replace(sheet, marker=source.marker)


def _headers(source: Source) -> list[str]:
    """Names of the columns without units: as told, else the first row."""
    cells = source.columns or next(iter(source.grid.rows), ())
    return [unit_of_header(cell)[0] for cell in cells]


def _chosen(source: Source, markers: list[int]) -> int:
    listed = ", ".join(map(str, markers))
    if source.marker is None and len(markers) > 1:
        raise InputError(
            f"this file has the markers {listed}",
            where=source.grid.place(0),
            remedy=f"Choose one: --marker {markers[0]}. Its point is where the load acts.",
        )
    wanted = source.marker or str((markers or [1])[0])
    chosen = int(wanted) if wanted.isdecimal() else 0
    if chosen not in markers:
        raise InputError(
            f"this file has no marker {wanted}",
            where=source.grid.place(0),
            remedy=f"There is {listed}." if listed else "Its columns are x1, y1, z1.",
        )
    return chosen
