"""What columns of words say of rows: the branch, the repetition, the direction of a force."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff import units
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.masses import MASSES
from sk120stiff.measurements.importers.columns.unread_axes import GAUGE, IN_A_LETTER
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.told import Told, numbers
from sk120stiff.measurements.table.columns import FORCES
from sk120stiff.robot import STANDARD_GRAVITY

_BRANCHES = {
    "load": "load|loading|up|upward|upwards|rising|increasing|auf|aufwärts|hoch|belastet|belastung|"
    "belasten|belastend|steigend|zunehmend|charge|carico|carga",
    "unload": "unload|unloading|down|downward|downwards|falling|decreasing|ab|abwärts|runter|"
    "entlastet|entlastung|entlasten|entlastend|fallend|abnehmend|décharge|scarico|descarga",
}
_BRANCH_OF = {word: branch for branch, words in _BRANCHES.items() for word in words.split("|")}
_EMPTY = ("", "-", "--", "none", "n/a", "0")  # no direction: in rows without load
_ALONG = re.compile(
    r"f?\s*(?P<before>[+-]?)\s*f?(?P<axis>[xyz])\s*(?P<after>[+-]?)(?:[ -]?(?:axis|achse))?",
    re.IGNORECASE,
)
_VECTORS = ("e{}", "e {}", "n{}", "n {}", "dir {}", "direction {}", "richtung {}", "force dir {}")
PULLS = " A mass pulls with its weight along that direction."
_UNIT_LENGTH = 0.02  # by which the length of a unit vector may be off, as it is rounded
_SIZES = re.compile(
    r"\|(?:f|force|kraft)\||"
    r"(?:applied |test |prüf|mess|zug|druck)?(?:f|force|kraft|last|load|gewicht|masse|mass|weight)",
    re.IGNORECASE,
)


def understood_words(sheet: Sheet, told: Told) -> Sheet:
    """The sheet with branches and repetitions in words of ours, and forces from their direction.

    Raises:
        InputError: A direction that does not go with the load beside it.
    """
    sheet = _with_branches(sheet)
    sheet = _with_repeats(sheet)
    sheet = _with_reading_along(sheet)
    direction = sheet.get("force direction") or sheet.get("direction")
    if direction is None:
        return _with_force_along(sheet, told)
    if all(_along(cell) or _empty(cell) for cell in direction.cells):
        return _with_forces(sheet, direction, told)
    why = (
        "its words are neither axes (-Z, +X) nor those of loading and unloading (load and unload, "
        "up and down, auf and ab, Belastung and Entlastung)"
    )
    return _left_out(sheet, direction, why)


def _with_reading_along(sheet: Sheet) -> Sheet:
    """The direction that a gauge reads along, as a vector where it is told by a letter.

    Raises:
        InputError: A word that names no axis, beside a reading of a gauge.
    """
    column = sheet.get(IN_A_LETTER)
    if column is None:
        return sheet
    if not sheet.those(GAUGE, f"loaded {GAUGE}"):
        return _left_out(sheet, column, "no gauge stands beside it")
    along = [_along(cell) for cell in column.cells]
    if None in along:
        row = along.index(None)
        raise InputError(
            f"{column.cells[row]!r} is no axis that a gauge reads along",
            where=sheet.place(column, row),
            remedy="Write +X, -Z and so on, axes of the base in which its reading rises; of other "
            "directions give the unit vector in columns ux, uy, uz.",
        )
    known = [each for each in along if each is not None]
    made = [
        Column(
            column.header, f"u{axis}", None, column.stated,
            tuple(("-1" if sign == "-" else "1") if own == axis else "0" for own, sign in known),
            1.0, column.file,
        )
        for axis in "xyz"
    ]  # fmt: skip
    shown = ", ".join(dict.fromkeys(column.cells))
    return sheet.exchanged([column], *made).noting(
        f"The reading of the gauge is taken to rise along {column.header} ({shown}), axes of the "
        "base."
    )


def _with_branches(sheet: Sheet) -> Sheet:
    column = sheet.get("branch") or sheet.get("direction")
    if column is None:
        return sheet
    words = [cell.strip().lower() for cell in column.cells]
    known = {word for word in words if not _empty(word)}
    if not known or not known <= _BRANCH_OF.keys():
        return sheet
    cells = tuple("" if _empty(word) else _BRANCH_OF[word] for word in words)
    new = sheet.swapped(column, meaning="branch", cells=cells)
    foreign = [word for word in dict.fromkeys(column.cells) if word.lower() in known]
    if set(foreign) <= {"load", "unload"}:
        return new
    pairs = [f"{word} is {_BRANCH_OF[word.lower()]}" for word in foreign]
    return new.noting(f"The column {column.header} tells the branch: {', '.join(pairs)}.")


def _with_repeats(sheet: Sheet) -> Sheet:
    """Repetitions as whole numbers, as the files of measurements have them."""
    column = sheet.get("repeat")
    if column is None or not all(column.cells):
        return sheet
    if all(is_number(cell) and float(cell).is_integer() for cell in column.cells):
        return sheet.swapped(column, cells=tuple(str(int(float(cell))) for cell in column.cells))
    count = {label: k for k, label in enumerate(dict.fromkeys(column.cells), 1)}
    new = sheet.swapped(column, cells=tuple(str(count[cell]) for cell in column.cells))
    shown = listed([f"{label} is {k}" for label, k in list(count.items())[:3]])
    return new.noting(f"The column {column.header} counts repetitions: {shown}.")


def _with_forces(sheet: Sheet, direction: Column, told: Told) -> Sheet:
    """The components of a force that is stated by its size and its direction.

    Raises:
        InputError: As `understood_words`.
    """
    components = sheet.those(*FORCES)
    if components:
        _refuse_another_axis(sheet, direction, components)
        return _left_out(sheet, direction, "the components of the force stand beside it")
    size = _size(sheet, direction, told)
    if size is None:
        return _left_out(sheet, direction, "a direction, and no column says how large the load is")
    values, texts, unit, stated = _as_force(sheet, size, told)
    cells: dict[str, list[str]] = {name: [] for name in FORCES}
    for row, (word, value, text) in enumerate(zip(direction.cells, values, texts, strict=True)):
        along = _along(word)
        if along is None and value != 0.0:
            raise InputError(
                f"a load of {text}, and no direction",
                where=sheet.place(direction, row),
                remedy="Write its direction: -Z, +X and so on; or 0 if there was none.",
            )
        axis, sign = along or ("x", "")
        if sign and value < 0.0:
            raise InputError(
                f"a load of {text} along {word}: a sign stands at both",
                where=sheet.place(direction, row),
                remedy="Write the size without a sign, or the direction without one: Z.",
            )
        for name in FORCES:
            own = text if name[1] == axis else "0"
            cells[name].append(f"-{own.removeprefix('+')}" if sign == "-" and own != "0" else own)
    header = f"{size.header}, {direction.header}"
    made = [
        Column(header, name, unit, stated, tuple(cells[name]), 1.0, size.file) for name in FORCES
    ]
    shown = [word for word in dict.fromkeys(direction.cells) if not _empty(word)]
    mass = PULLS if unit == "SI" else ""
    return sheet.exchanged([size, direction], *made).noting(
        f"fx, fy, fz are made of {size.header}, the size of the force on the robot, and "
        f"{direction.header}, its direction ({', '.join(shown)}).{mass}"
    )


def _with_force_along(sheet: Sheet, told: Told) -> Sheet:
    """The components of a force that is stated by its size and a unit vector, ex ey ez.

    Raises:
        InputError: A vector that is no unit vector in a row with load.
    """
    plain = [  # a direction has no unit: ex [mm] is an error of position
        "" if unit_of_header(c.header)[1] else re.sub(r"[\s_.]+", " ", c.header).lower()
        for c in sheet.spare
    ]
    for form in _VECTORS:
        names = [form.format(axis) for axis in "xyz"]
        of_matrix = form[0] == "n" and bool({"ox", "o x"} & set(plain))
        if all(plain.count(name) == 1 for name in names) and not of_matrix:
            along = [sheet.spare[plain.index(name)] for name in names]
            break
    else:
        return sheet
    size = _size(sheet, along[0], told)
    if size is None or sheet.those(*FORCES):
        return sheet
    values, _, unit, stated = _as_force(sheet, size, told)
    is_mass = unit == "SI"  # by the file's own words it pulls elsewhere over a pulley alone
    if is_mass and form[0] == "n":
        return sheet
    e = np.column_stack([numbers(sheet, column) for column in along])
    off = (np.abs(np.linalg.norm(e, axis=1) - 1.0) > _UNIT_LENGTH) & (np.array(values) != 0.0)
    if off.any():
        row = int(np.argmax(off))
        raise InputError(
            f"({', '.join(c.cells[row] for c in along)}) is no unit vector, beside a load",
            where=sheet.place(along[0], row),
            remedy="Write the direction of the force with length 1, or call these columns fx, fy, "
            "fz if they are its components.",
        )
    header = f"{size.header}, {', '.join(c.header for c in along)}"
    made = [
        Column(header, name, unit, stated, tuple(repr(float(v)) for v in column), 1.0, size.file)
        for name, column in zip(FORCES, (np.array(values)[:, None] * e).T, strict=True)
    ]
    return sheet.exchanged([size, *along], *made).noting(
        f"fx, fy, fz are {size.header}, the size of the force on the robot, times its direction "
        f"{', '.join(c.header for c in along)}.{PULLS if is_mass else ''}"
    )


def _refuse_another_axis(sheet: Sheet, direction: Column, components: Sequence[Column]) -> None:
    """One component alone, called as an axis that the direction does not name, is no component."""
    if len(components) != 1:
        return
    (only,) = components
    for row, cell in enumerate(direction.cells):
        along = _along(cell)
        if along and along[0] != only.meaning[1]:
            raise InputError(
                f"{cell} is no direction of {only.header}, a force along {only.meaning[1]}",
                where=sheet.place(direction, row),
                remedy=f"If {only.header} is the size of the force, call it force; if it is the "
                f"component, take the column {direction.header} out.",
            )


def _size(sheet: Sheet, direction: Column, told: Told) -> Column | None:
    """The column of how large the load is; one that counts --wrench is none.

    Raises:
        InputError: There are several.
    """
    kinds = ("payload", "load") if told.wrench is None else ("payload",)
    loads = [c for c in sheet.columns if c.meaning in kinds]
    more = [c for c in sheet.spare if _SIZES.fullmatch(unit_of_header(c.header)[0].strip())]
    more += [
        c
        for c in sheet.spare
        if c not in more and c.unit and (c.unit in MASSES or units.is_kind(c.unit, "force"))
    ]
    found = [*loads, *more]
    if len(found) > 1:
        raise InputError(
            f"{listed([c.header for c in found])} may each be the size of the force",
            where=sheet.place(direction),
            remedy=f"Keep the one that acts along {direction.header}.",
        )
    return found[0] if found else None


def _as_force(
    sheet: Sheet, size: Column, told: Told
) -> tuple[Sequence[float], tuple[str, ...], str | None, str]:
    """Values and texts of the size, its unit and where that is stated; a mass by its weight."""
    if size.unit not in MASSES and not (size.unit is None and told.load == "kg"):
        return numbers(sheet, size).tolist(), size.cells, size.unit, size.stated
    own = replace(size, factor=size.factor if size.meaning else MASSES[size.unit or "kg"])
    newtons = (numbers(sheet, own) * STANDARD_GRAVITY).tolist()
    stated = f"{size.stated or '--load'}: {size.unit or 'kg'}"
    return newtons, tuple(repr(value) if value else "0" for value in newtons), "SI", stated


def _along(cell: str) -> tuple[str, str] | None:
    """The axis that a cell names, and its sign or none."""
    match = _ALONG.fullmatch(cell.strip())
    if match is None or (match["before"] and match["after"]):
        return None
    return match["axis"].lower(), match["before"] or match["after"]


def _empty(cell: str) -> bool:
    return cell.strip().lower() in _EMPTY


def _left_out(sheet: Sheet, column: Column, why: str) -> Sheet:
    unused = (*sheet.unused, f"column {column.header}: {why}")
    return replace(sheet.exchanged([column]), unused=unused)
