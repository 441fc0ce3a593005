"""A mass that hung on the tool in all rows of a file: told, or said by its name or a comment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import filter as filter_names
from pathlib import Path

from sk120stiff import units
from sk120stiff.errors import InputError, listed, meant
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.loads.masses_in_words import (
    all_masses,
    forces_of_name,
    masses_of_comment,
    masses_of_name,
    says_without,
)
from sk120stiff.measurements.importers.loads.pairs import LOADS
from sk120stiff.measurements.importers.told import Told

OPTION = "--payload"
FILE_NAME = "the name of the file"
COMMENT = "a line above the table"
SHOWN = 4  # masses or files that are told one by one
Place = tuple[str, str]  # where a mass stands, and the words there


def with_mass(sheet: Sheet, told: Told, beside: Sequence[str] = ()) -> Sheet:
    """The sheet with a column ``payload`` in kg, where no column holds a load and one mass is told,
    or said by the name of the file or by a line above the table.

    Args:
        sheet: The readings of one file.
        told: With `Told.payloads`, which goes before what the file says.
        beside: Names of the files of the campaign, without endings.

    Raises:
        InputError: More than one mass could be meant, or the load is given twice.
    """
    given = _told_of(sheet.path, told)
    if (columns := _of_loads(sheet)) and given is not None:
        raise InputError(
            f"the load is given twice: by {OPTION} and in {columns[0]}",
            where=str(sheet.path),
            remedy=f"Leave {OPTION} out, or take the column out of the file.",
        )
    if given is not None:
        return _with_column(sheet, given, OPTION)
    if columns or told.wrench is not None:
        return sheet
    by_name = masses_of_name(sheet.path.stem, beside)
    lines = [(n, text, masses_of_comment(text)) for n, text in sheet.remarks]
    lines = [line for line in lines if line[2].masses]
    said: dict[float, list[Place]] = {}
    for mass in by_name.masses:
        said.setdefault(mass, []).append((FILE_NAME, " or ".join(by_name.texts)))
    for number, text, words in lines:
        for mass in words.masses:
            said.setdefault(mass, []).append((COMMENT, f"line {number}: {text}"))
    if not said:
        return sheet
    agreed = [mass for mass in said if len({where for where, _ in said[mass]}) == 2]
    if len(said) > 1 and not (len(agreed) == 1 and len(lines) == 1):
        _refuse_several(sheet, said)
    (mass,) = agreed if len(said) > 1 else said
    used = {f"line {number}: {text}" for number, text, _ in lines}
    sheet = replace(sheet, unused=tuple(item for item in sheet.unused if item not in used))
    return _with_column(sheet, mass, said[mass][0][0])


def with_masses_of_all(sheets: Sequence[Sheet]) -> list[Sheet]:
    """The files of one campaign, of which each says its mass, or none does.

    A name that says that nothing hung there (*unloaded*) counts as 0 kg beside others with a mass.

    Raises:
        InputError: Some files say a mass, and others neither that nor a load.
    """
    hung = [sheet for sheet in sheets if _own(sheet) is not None]
    if not hung or len(hung) == len(sheets):
        return list(sheets)
    out = [
        _with_column(sheet, 0.0, FILE_NAME)
        if not _of_loads(sheet) and says_without(sheet.path.stem)
        else sheet
        for sheet in sheets
    ]
    lost = [sheet for sheet in out if not _of_loads(sheet)]
    if lost:
        first, like = hung[0].path.name, lost[0].path.name
        rest = listed([sheet.path.name for sheet in lost], most=SHOWN)
        if left := _left(lost):
            rest += f"; not taken is {left[0][0]!r} in {left[0][1]}, as {left[0][2]}"
        raise InputError(
            f"what hung on the tool is known of {len(out) - len(lost)} of {len(out)} files ("
            f"{_told_mass(hung[0])} in {first}), and not of {rest}",
            where=OPTION,
            remedy=f"Say it of them: {OPTION} '{like}=0 kg' if nothing hung there; or of all in "
            f"one: {OPTION} '0 kg', if that in the names is no payload.",
        )
    return out


def say_masses(sheets: Sequence[Sheet]) -> list[str]:
    """Which masses were taken from where, in a sentence."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for sheet in sheets:
        column = _own(sheet)
        if column is not None:
            kinds.setdefault((column.stated, _told_mass(sheet)), []).append(sheet.path.name)
    out = []
    for where in dict.fromkeys(stated for stated, _ in kinds):
        each = [
            f"{mass} ({names[0] if len(names) == 1 else f'{len(names)} files'})"
            for (stated, mass), names in sorted(kinds.items(), key=lambda item: _number(item[0][1]))
            if stated == where
        ]
        some = listed(each, most=SHOWN)
        out.append(
            f"What hung on the tool is taken from {where}, for all rows of a file: {some}. "
            f"If it was another mass, say {OPTION} 'FILE=5 kg'."
            if where != OPTION
            else f"What hung on the tool is as told: {some}."
        )
    return out


def doubts_of_names(sheets: Sequence[Sheet]) -> list[str]:
    """What names of files say of forces where nothing else says a load, and which masses of names
    and lines above tables were not taken, in sentences."""
    out = []
    if left := _left(sheets):
        words = [f"{words!r} in {where} ({why})" for words, where, why in left]
        out.append(
            f"Not taken for what hung on the tool: {listed(words, most=SHOWN)}. If it hung there, "
            f"say so: {OPTION} '5 kg', of one file of several {OPTION} 'FILE=5 kg'; {OPTION} "
            "'0 kg' says that nothing did."
        )
    named = {
        text: sheet.path.name
        for sheet in sheets
        if not _of_loads(sheet)
        for text in forces_of_name(sheet.path.stem)
    }
    if named:
        words = [f"{text} ({name})" for text, name in named.items()]
        out.append(
            f"Names of the files say {listed(words, most=SHOWN)}: forces whose direction they do "
            "not say, and nothing is taken of them. Write columns fx[N], fy[N], fz[N] into each "
            "file (axes of the base; a weight is a negative fz), or say which mass hung there: "
            f"{OPTION} 'FILE=5 kg'."
        )
    return out


def _left(sheets: Sequence[Sheet]) -> list[tuple[str, str, str]]:
    """Words, place and reason of masses that may be no load, where no column and nobody says one;
    the same words in many files once."""
    beside = [sheet.path.stem for sheet in sheets]
    found: dict[tuple[str, str], tuple[str, str, str]] = {}
    for sheet in sheets:
        own = _own(sheet)
        if own.stated == OPTION if own else _of_loads(sheet):
            continue
        name = sheet.path.name
        for words, why in masses_of_name(sheet.path.stem, beside).left:
            found.setdefault((words, why), (words, f"the name {name}", why))
        for number, text in sheet.remarks:
            for words, why in masses_of_comment(text).left:
                if not (own and all_masses(text) == {max(map(float, own.cells))}):  # the same
                    found.setdefault((words, why), (words, f"line {number} of {name}", why))
    return list(found.values())


def refuse_other_files(paths: Sequence[Path], told: Told) -> None:
    """Masses that were told must be of files that are there.

    Raises:
        InputError: A name of no file.
    """
    names = [name for path in paths for name in (path.name, path.stem)]
    for name in told.payloads:
        if name and name not in names and not filter_names(names, name):
            raise InputError(
                f"a mass is told of {name!r}, and no file is called that{meant(name, names)}",
                where=OPTION,
                remedy=f"The files are {listed([path.name for path in paths], most=SHOWN)}.",
            )


def _told_of(path: Path, told: Told) -> float | None:
    """The mass that was told of a file: by its name, else by a pattern as ``*_b.csv``, else of all.

    Raises:
        InputError: Two patterns tell two masses.
    """
    for name in (path.name, path.stem):
        if name in told.payloads:
            return told.payloads[name]
    of = {p: m for p, m in told.payloads.items() if p and filter_names([path.name, path.stem], p)}
    if len(set(of.values())) > 1:
        raise InputError(
            f"two masses are told of {path.name}: by {listed(list(of))}",
            where=OPTION,
            remedy="Let one pattern alone fit each file.",
        )
    return next(iter(of.values()), told.payloads.get(""))


def _own(sheet: Sheet) -> Column | None:
    """The column that `with_mass` made."""
    column = sheet.get("payload")
    return column if column is not None and column.stated in (OPTION, FILE_NAME, COMMENT) else None


def _of_loads(sheet: Sheet) -> list[str]:
    """Headers of columns that hold a load, or may: numbers in a unit of force."""
    may_be = [c for c in sheet.spare if c.unit and units.is_kind(c.unit, "force")]
    known = [c for c in sheet.columns if c.meaning in (*LOADS, "direction", "force direction")]
    return [c.header for c in (*known, *may_be)]


def _with_column(sheet: Sheet, mass: float, stated: str) -> Sheet:
    text = repr(round(mass, 9))  # 500 g are 0.5 kg to the digit
    column = Column("(mass)", "payload", "kg", stated, (text,) * len(sheet.lines))
    return sheet.exchanged((), column)


def _told_mass(sheet: Sheet) -> str:
    """The mass in words; rows read without load beside those under it have 0 kg."""
    column = _own(sheet)
    return f"{max(map(float, column.cells)):g} kg" if column is not None else ""


def _number(text: str) -> float:
    return float(text.removesuffix(" kg"))


def _refuse_several(sheet: Sheet, said: dict[float, list[Place]]) -> None:
    masses = listed([f"{mass:g} kg" for mass in said], "or")
    places = listed(
        list(dict.fromkeys(f"{words!r} in {where}" for of in said.values() for where, words in of))
    )
    raise InputError(
        f"what hung on the tool may be {masses}: {places}",
        where=str(sheet.path),
        remedy=f"Say which: {OPTION} '{sheet.path.name}={next(iter(said)):g} kg'; 0 kg where "
        "nothing hung there.",
    )
