"""Several files of one campaign: their rows one after the other, each with a label of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from pathlib import Path

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.campaign.by_label import SHARED, label_of
from sk120stiff.measurements.importers.campaign.pose_of_file import of_names
from sk120stiff.measurements.importers.contract import FILE, Column, Sheet, Unpaired
from sk120stiff.measurements.importers.loads.pairs import LOADS

LABELS = ("pose", "name")  # which mean another thing in another file
SHOWN = 4  # files that are told by name
_ANEW = ("order", "time")  # which begin anew in every file, or not


def joined(sheets: Sequence[Sheet], what: str = "files") -> Sheet:
    """The rows of all of them, with a column of where the tracker stood that names the files.

    Lines count on through the files, as if they had been appended to one another. They are called
    `what`.

    Raises:
        InputError: They do not hold the same columns in the same units.
    """
    first, labels = sheets[0], _labels([sheet.path for sheet in sheets])
    for sheet in sheets[1:]:
        _refuse_unlike(first, sheet)
    columns, said = [], []
    for column in first.columns:
        cells = [own.cells for own in _same(column, sheets)]
        if column.meaning in LABELS and not of_names(column):
            cells = _apart(cells, labels)
        elif column.meaning in _ANEW and not _goes_on(cells):
            said.append(f"The column {column.header} begins anew in every file and is left out.")
            continue
        columns.append(replace(column, cells=_row(cells)))
    if first.get("station") is None:
        named = [(label,) * len(sheet.lines) for label, sheet in zip(labels, sheets, strict=True)]
        columns.append(Column(FILE, "station", None, "the names of the files", _row(named)))
    starts = [0, *accumulate(max(sheet.lines, default=0) for sheet in sheets)]
    ranks = [0, *accumulate(sheet.total for sheet in sheets)]
    begins = [f"{s.path.name} at {n + 1}" for s, n in zip(sheets[1:], starts[1:], strict=False)]
    more = [sheet.path.name for sheet in sheets[1:]]
    beside = listed(more) if len(more) <= SHOWN else f"{len(more)} more {what}"
    return replace(
        first,
        title=f"{first.title}, with {beside}",
        columns=tuple(columns),
        spare=tuple(
            replace(c, cells=_row([own.cells for own in others]))
            for c in first.spare
            if len(others := _of_header(c.header, sheets)) == len(sheets)
        ),
        lines=_counted([sheet.lines for sheet in sheets], starts),
        rank=_counted([sheet.rank for sheet in sheets], ranks),
        total=sum(sheet.total for sheet in sheets),
        skipped=tuple(
            (line + start, why)
            for sheet, start in zip(sheets, starts, strict=False)
            for line, why in sheet.skipped
        ),
        unpaired=_unpaired(sheets, starts),
        doubts=tuple(dict.fromkeys([*(d for s in sheets for d in s.doubts), *_the_same(sheets)])),
        unused=tuple(dict.fromkeys(item for sheet in sheets for item in sheet.unused)),
        notes=(
            *_said_once(sheets),
            f"{len(sheets)} {what} are one campaign. Lines count on: "
            + listed(begins[:SHOWN] + ["so on"] * (len(begins) > SHOWN))
            + ".",
            *said,
        ),
    )


def _said_once(sheets: Sequence[Sheet]) -> list[str]:
    """What was decided of each, and of how many more the same."""
    said: dict[str, list[str]] = {}
    for sheet in sheets:
        for note in sheet.notes:
            own = f" of {sheet.path.name} "
            said.setdefault(note.replace(own, "\0", 1), []).append(note)
    return [
        f"{each[0]} So of {len(each) - 1} more." if "\0" in key and len(each) > 1 else each[0]
        for key, each in said.items()
    ]


def _the_same(sheets: Sequence[Sheet]) -> list[str]:
    """Whether files that say no load hold the same names, as passes without and with one do."""
    names = [set(c.cells) if (c := label_of(sheet)) else set() for sheet in sheets]
    shared = set.intersection(*names)
    loads = any(sheet.those(*LOADS) for sheet in sheets)
    if loads or len(shared) < SHARED * min(map(len, names)) or not shared:
        return []
    return [
        "The files hold the same names, and none says a load. If one was read without and the "
        "other with a load, give the file without as --before FILE, and the other alone; or say "
        "what hung on the tool: --payload 'a.csv=0 kg' --payload 'b.csv=5 kg'."
    ]


def _unpaired(sheets: Sequence[Sheet], starts: Sequence[int]) -> tuple[Unpaired, ...]:
    """Points of each file that lack a row beside them, and rows beside that no file has a point of.

    Rows of the file beside belong to points of one file or another.
    """
    own = [
        each._replace(line=each.line + start)
        for sheet, start in zip(sheets, starts, strict=False)
        for each in sheet.unpaired
        if not each.beside
    ]
    beside = [{each for each in s.unpaired if each.beside} for s in sheets]
    first = (each for each in sheets[0].unpaired if each.beside)
    return (*own, *(each for each in first if all(each in of for of in beside)))


def _labels(paths: Sequence[Path]) -> list[str]:
    """Names of the files without their ending; with their folders where those alone differ."""
    stems = [path.stem for path in paths]
    if len(set(stems)) == len(stems):
        return stems
    whole = [f"{path.parent.name}/{path.stem}" for path in paths]
    if len(set(whole)) < len(whole):
        raise InputError(
            "a file is given twice, or two have one name",
            where=listed([str(path) for path in paths]),
            remedy="Give each once, and name them apart.",
        )
    return whole


def _refuse_unlike(first: Sheet, other: Sheet) -> None:
    mine, theirs = (
        {column.meaning: column for column in sheet.columns} for sheet in (first, other)
    )
    lacking = [c.header for meaning, c in mine.items() if meaning not in theirs]
    beyond = [c.header for meaning, c in theirs.items() if meaning not in mine]
    if lacking or beyond:
        told = [f"the first alone has {listed(lacking)}"] if lacking else []
        told += [f"the second alone has {listed(beyond)}"] if beyond else []
        raise InputError(
            f"the files do not hold the same columns: {', '.join(told)}",
            where=f"{first.path} and {other.path}",
            remedy="Import them one by one, or give them the same columns.",
        )
    for meaning, column in mine.items():
        own = theirs[meaning]
        if (own.unit, own.factor) != (column.unit, column.factor):
            raise InputError(
                f"the column {own.header} is in {own.unit or 'no unit'}, in the first file in "
                f"{column.unit or 'none'}",
                where=f"{first.path} and {other.path}",
                remedy="Export both in one unit.",
            )


def _same(column: Column, sheets: Sequence[Sheet]) -> list[Column]:
    """The column of that meaning in every sheet."""
    return [own for sheet in sheets if (own := sheet.get(column.meaning)) is not None]


def _of_header(header: str, sheets: Sequence[Sheet]) -> list[Column]:
    return [c for sheet in sheets for c in sheet.spare if c.header == header][: len(sheets)]


def _apart(cells: Sequence[tuple[str, ...]], labels: Sequence[str]) -> list[tuple[str, ...]]:
    """Labels, with the file's name before them where two files use the same."""
    if len(set().union(*cells)) == sum(len(set(own)) for own in cells):
        return list(cells)
    return [
        tuple(f"{label}/{cell}" if cell else cell for cell in own)
        for label, own in zip(labels, cells, strict=True)
    ]


def _goes_on(cells: Sequence[tuple[str, ...]]) -> bool:
    """Do numbers of a clock not go back where another file begins? Words: does none come again?"""
    try:
        numbers = [[float(cell) for cell in own if cell] for own in cells]
    except ValueError:
        seen = [set(own) - {""} for own in cells]
        return len(set().union(*seen)) == sum(map(len, seen))
    spans = sorted((min(own), max(own)) for own in numbers if own)
    return all(before < after for (_, before), (after, _) in pairwise(spans))


def _row(cells: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(cell for own in cells for cell in own)


def _counted(numbers: Sequence[tuple[int, ...]], starts: Sequence[int]) -> tuple[int, ...]:
    return tuple(n + start for own, start in zip(numbers, starts, strict=False) for n in own)
