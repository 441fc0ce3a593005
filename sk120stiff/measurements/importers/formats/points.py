"""Tables with headers, PolyWorks' and others', and plain lists of points without."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.compound_groups import groups_of, shown
from sk120stiff.measurements.importers.columns.not_taken import refuse_contacts_and_images
from sk120stiff.measurements.importers.columns.unread_axes import gauge_pair
from sk120stiff.measurements.importers.columns.words import kind_of, unit_of_header
from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout.headerless import cut, of_other_columns, shaped
from sk120stiff.measurements.importers.layout.layout import SEARCHED, Layout, layout_of, sheet_of
from sk120stiff.measurements.table.columns import DISPLACEMENTS, FORCES, MOMENTS, POSITIONS

_BEGUN = re.compile(r"\s*(?:d ?)?([xyz])\s*[\[(]", re.IGNORECASE)
_HOLDS = (  # what a table is of, by the meanings of its columns
    ("x, y, z", POSITIONS), ("dx, dy, dz", DISPLACEMENTS),
    ("a gauge and its direction", ("gauge",)), ("dx", ("dx",)), ("dy", ("dy",)), ("dz", ("dz",)),
)  # fmt: skip


@dataclass(frozen=True)
class Points:
    """``name x y z``, with joints or without, under headers or in that order."""

    name: str = "points"
    title: str = "a list of points"

    def sniff(self, source: Source) -> Guess:
        """Headers that name what is needed, or as many numbers in a row as that has."""
        layout = layout_of(source)
        if layout is not None:
            return Guess(0.4, "its columns are named")
        if _joints_alone(source) is not None:
            return Guess(0.05, "its columns are joints")
        if source.role == "points" and _places(source):
            return Guess(0.05, "its headers name positions")
        count, named, _ = shaped(source)
        if _names(source, count) is None or of_other_columns(source):
            return NO
        return Guess(0.4, f"{'a name and ' if named else ''}{count} numbers in a row")

    def read(self, source: Source) -> Sheet:
        """The readings under their headers, or by the count of numbers in a row.

        Raises:
            InputError: Positions and joints without headers, which may come in either order.
        """
        layout = layout_of(source)
        if layout is None and source.role == "points" and (places := _places(source)):
            raise _several_places(source, places)
        if layout is None and (alone := _joints_alone(source)) is not None:
            _refuse_other_kinds(source, alone)
            _refuse_some_coordinates(source, alone)
            raise _no_positions(source, alone)
        if layout is None:
            count, named, _ = shaped(source)
            names = _names(source, count) or ()
            if len(names) > 6 and source.role == "points":
                joints = ",".join(names[3:])
                raise InputError(
                    f"{count} numbers in a row and no headers: position and joints may come in "
                    "either order",
                    where=str(source.path),
                    remedy=f"Say so: --columns '{'name,' * named}x,y,z,{joints}' or --columns "
                    f"'{'name,' * named}{joints},x,y,z'.",
                )
            told = replace(source, columns=(*(("name",) if named else ()), *names))
            layout = layout_of(told)
            if layout is None:
                raise InputError("the headers cannot be told", where=str(source.path))
            why = f"no headers; {count} numbers in a row are {', '.join(names)}"
            return sheet_of(source, layout, self.title, why)
        holds = next((what for what, words in _HOLDS if layout.has(*words)), "x, y, z")
        why = "columns as told" if source.columns else f"its headers name {holds}"
        if source.role != "points":
            why = "columns as told" if source.columns else f"its headers name the {source.role}"
        return sheet_of(source, layout, "a table of readings", why)


def _refuse_other_kinds(source: Source, joints: Layout) -> None:
    """Refuse contacts and images beside joints.

    Raises:
        InputError: They are there.
    """
    row = next((cut(r, len(joints.headers)) for r in source.grid.rows[joints.first :]), ())
    cells = (*row, *[""] * (len(joints.headers) - len(row)))
    unknown = [k for k, m in enumerate(joints.meanings) if m is None and joints.headers[k]]
    refuse_contacts_and_images(
        [joints.headers[k] for k in unknown], [cells[k] for k in unknown], str(source.path)
    )


def _joints_alone(source: Source) -> Layout | None:
    """The table of joints in a file of points that names no positions."""
    return layout_of(replace(source, role="joints")) if source.role == "points" else None


def _places(source: Source) -> list[str]:
    """Composed headers of positions of which none could be chosen, as messages name them."""
    for row in source.grid.rows[:SEARCHED]:
        groups = [g for g in groups_of(row, source.actuated) if g.family == "place"]
        if groups:
            return shown(groups, row)
    return []


def _several_places(source: Source, places: list[str]) -> InputError:
    topics = "/" in places[0]
    if source.topic is not None:
        return InputError(
            f"no positions stand in columns of the topic {source.topic!r}",
            where=str(source.path),
            remedy=f"There are {listed(places)}.",
        )
    return InputError(
        f"{listed(places, 'or')} may be the positions that were measured"
        if len(places) > 1
        else f"{places[0]} are commanded, nominal or the robot's own, and no position that was "
        "measured stands beside them",
        where=str(source.path),
        remedy=("Say which: --topic with what stands before position/x. " if topics else "")
        + "Name all columns with --columns (x,y,z for those that were measured, of several markers "
        "x1,y1,z1,x2,y2,z2, a dash for one that is not needed), or take the others out.",
    )


def _no_positions(source: Source, joints: Layout) -> InputError:
    """Joints, and other columns or none that may hold positions, displacements or distances."""
    pairs = zip(joints.headers, joints.meanings, strict=True)
    left = [h for h, m in pairs if h and (m is None or kind_of(m[0]) == "length")]
    pair = gauge_pair([unit_of_header(h)[0] if h else "" for h in joints.headers])
    if pair:
        return _no_direction(source, joints, pair)
    if not left:
        return InputError(
            "this file holds joint values, and no positions",
            where=str(source.path),
            remedy="Give the file with the points as FILE, and this one as --joints-file.",
        )
    return InputError(
        "this file holds joint values, and no positions or displacements that are understood; "
        f"columns of unknown meaning are {', '.join(left)}",
        where=str(source.path),
        remedy="If they are there, name all columns with --columns: x,y,z for positions, dx,dy,dz "
        "for displacements, 'x unloaded,y unloaded,z unloaded,x loaded,y loaded,z loaded' for "
        "positions without and with load, d,ux,uy,uz for what a gauge reads along a direction (or "
        "d and 'reading direction', which holds +X, -Z and so on), a dash for what is not needed. "
        "Distances to fixed points need no import: docs/FILES.md shows their file (l[mm],ax[m],"
        "ay[m],az[m]). If positions are in another file, give that as FILE, and this one as "
        "--joints-file.",
    )


def _no_direction(source: Source, joints: Layout, pair: dict[str, int]) -> InputError:
    """A gauge was read without and with load, and nothing says along what."""
    told = list(joints.headers)
    for state, k in pair.items():
        unit = joints.units[k]
        told[k] = f"z {state}" + (f" [{unit_of_header(told[k])[1] or unit}]" if unit else "")
    return InputError(
        f"{listed([joints.headers[k] for k in pair.values()])} are what a gauge read without and "
        "with load, and nothing says along which axis",
        where=str(source.path),
        remedy="Name the axis of the base along which its reading rises: --columns "
        f"'{','.join(name or '-' for name in told)}' (x or y for another); if it falls along it, "
        "or reads along another direction, add the columns ux, uy, uz of where it rises.",
    )


def _refuse_some_coordinates(source: Source, joints: Layout) -> None:
    """Headers that name one or two coordinates, or that begin as one does.

    Raises:
        InputError: There are such.
    """
    there = {m[0] for m in joints.meanings if m}
    if not there & set(POSITIONS):
        begun = [h for h in joints.headers if (m := _BEGUN.match(h)) and m[1].lower() not in there]
        if len(begun) < len(POSITIONS):
            return
        raise InputError(
            f"the units of {', '.join(begun)} are not known",
            where=str(source.path),
            remedy="Known lengths are m, mm, um and in: x[mm]; of dial gauges 1/100 mm, "
            "10^-2 mm and mil, too; or leave the unit out and give --length.",
        )
    missing = [axis for axis in POSITIONS if axis not in there]
    raise InputError(
        f"of x, y, z the columns {', '.join(missing)} are not there"
        if len(missing) > 1
        else f"of x, y, z the column {missing[0]} is not there",
        where=str(source.path),
        remedy=f"There are {', '.join(joints.headers)}. Name the columns with --columns.",
    )


def _names(source: Source, count: int) -> tuple[str, ...] | None:
    """Names of as many columns of numbers."""
    joints = tuple(f"q{k + 1}" for k in range(len(source.actuated)))
    known: dict[int, tuple[str, ...]]
    if source.role == "joints":
        known = {len(joints): joints}
    elif source.role == "loads":
        known = {3: FORCES, 6: (*FORCES, *MOMENTS), 1: ("payload",)}
    else:
        known = {3: POSITIONS, 3 + len(joints): (*POSITIONS, *joints)}
    return known.get(count)
