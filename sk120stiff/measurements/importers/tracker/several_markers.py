"""Several markers in one file: which is read, where each sits, and displacements of several."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.contract import Sheet
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.told import Told

RIGID = 0.1  # of their distance, by which that of two markers on one tool may scatter
APART = 0.01  # m; no arm comes back to a pose so far off
FEWEST = 3  # readings of both of two markers that tell whether they are one
MOST = 0.5  # share of the readings repeated that lie apart, from which on that is no slip


def of_marker(sheet: Sheet, name: str | None) -> Sheet:
    """The rows of one marker; all of them where nobody chose, or the format has chosen already.

    Raises:
        InputError: There is no such marker.
    """
    if name is None or sheet.marker == name:
        return sheet
    column = sheet.get("marker")
    if column is None:
        raise InputError(
            f"no column names markers, and so none is {name}",
            where=str(sheet.path),
            remedy="Leave out --marker, or name the column: --columns '...,marker,...'.",
        )
    rows = [k for k, cell in enumerate(column.cells) if cell == name]
    if not rows:
        raise InputError(
            f"this file has no marker {name}",
            where=sheet.place(column),
            remedy=f"There are {listed(_names(column.cells))}.",
        )
    alone = sheet.exchanged([column]).noting(f"Marker {name} is read.")
    return replace(alone, marker=name).rows(rows)


def with_places(draft: Draft, told: Told) -> Draft:
    """The rows with the places of their markers, where these were told by their names.

    Raises:
        InputError: A marker without a place, or a place of no marker.
    """
    if not told.points:
        return draft
    names = _names(draft.marker_of)
    lost = [name for name in names if name not in told.points]
    strange = [name for name in told.points if name not in names]
    if lost or strange:
        what = f"no place is told of {listed(lost)}" if lost else f"no marker is {listed(strange)}"
        raise InputError(
            what,
            where="--point",
            remedy=f"The markers of this file are {listed(names)}: " + _like(names)
            if names
            else "No column of this file names markers: give one place, --point '0,0,150 mm'.",
        )
    other = tuple((header, cells) for header, cells in draft.other if header != "marker")
    return replace(draft, markers=(draft.marker_of, dict(told.points)), other=other)


def _like(names: list[str]) -> str:
    return " ".join(f"--point '{name}=0,0,150 mm'" for name in names)


def refuse_several_points(draft: Draft) -> None:
    """Refuse differences by loads that are not all of one point, or of several without a place.

    Raises:
        InputError: A column names several markers whose places nobody told, or readings of one pose
            and load lie apart.
    """
    sheet = draft.sheet
    column = sheet.get("marker")
    names = list(dict.fromkeys(draft.marker_of))
    if draft.displaced and draft.markers[1]:
        return
    remedy = f"Or import one of them alone: --marker {names[0] or 'NAME'}."
    if column is not None and len(names) > 1:
        raise InputError(
            f"this file has displacements of the markers {listed(names)}, and where each sits on "
            "the tool is not told: how far they go does not tell it",
            where=sheet.place(column),
            remedy=f"Tell it: {_like(names)}. {remedy}",
        )
    if draft.displaced:
        return
    remedy = "Import each marker into a file of its own, which names its place: --marker NAME."
    first: dict[tuple[str, bytes], int] = {}
    pairs: list[tuple[float, int, int]] = []  # how far apart, and the two rows
    for row in map(int, np.flatnonzero(draft.use)):
        begin = first.setdefault((draft.pose[row], (draft.loads.wrench[row] + 0.0).tobytes()), row)
        if begin != row:
            apart = float(np.linalg.norm(draft.measured[row] - draft.measured[begin]))
            pairs.append((apart, begin, row))
    far = [pair for pair in pairs if pair[0] > APART]
    if far and len(far) > MOST * len(pairs):
        apart, begin, row = far[0]
        cause = "they are of different points of the arm"
        if sheet.by_order:
            beside = listed([path.name for path in sheet.by_order])
            cause = (
                f"the rows of {beside}, which were put beside them by order, are those of other "
                "points, or they are of different points of the arm"
            )
            remedy = (
                "If one file lacks a row that the other has, all rows behind it are apart: give "
                "both files a column of names, or one of times. If not: name the column that says "
                f"which 'marker'. {remedy}"
            )
        else:
            remedy = f"Name the column that says which 'marker'. {remedy}"
        raise InputError(
            f"at pose {draft.pose[row]} two positions under the same load lie {1e3 * apart:.3g} mm "
            f"apart, lines {sheet.lines[begin]} and {sheet.lines[row]}, and so at most poses: "
            f"{cause}",
            where=str(sheet.path),
            remedy=remedy,
        )


def refuse_one_marker_twice(draft: Draft) -> None:
    """Refuse two markers that are in one place everywhere: one marker, read without and with load.

    Raises:
        InputError: There are such.
    """
    names = _names(draft.marker_of)
    if draft.displaced or len(names) < 2:
        return
    seen: dict[str, dict[tuple[str, bytes], int]] = {name: {} for name in names}
    for row in map(int, np.flatnonzero(draft.use)):
        if draft.marker_of[row]:
            at = draft.pose[row], (draft.loads.wrench[row] + 0.0).tobytes()
            seen[draft.marker_of[row]].setdefault(at, row)
    for one, two in combinations(names, 2):
        both = [(seen[one][at], seen[two][at]) for at in seen[one] if at in seen[two]]
        apart = [float(np.linalg.norm(draft.measured[a] - draft.measured[b])) for a, b in both]
        rigid = bool(apart) and np.std(apart) < RIGID * np.mean(apart)  # two on one tool stay apart
        if len(apart) >= FEWEST and np.median(apart) < APART and not rigid:
            raise InputError(
                f"the markers {one} and {two} are {1e3 * float(np.median(apart)):.2g} mm apart in "
                "the median, at the same poses under the same load: they are one marker that was "
                "read twice",
                where=str(draft.sheet.path),
                remedy="If that was without the load and with it, say so by the columns "
                "x_unloaded, y_unloaded, z_unloaded, x_loaded, y_loaded, z_loaded (in the header, "
                "or with --columns); if the readings are repeats, write a row for each, without a "
                "column marker.",
            )


def _names(cells: tuple[str, ...]) -> list[str]:
    return list(dict.fromkeys(cell for cell in cells if cell))
