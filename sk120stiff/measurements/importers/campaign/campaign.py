"""What is read as one campaign: the files that were given, or the sheets of one workbook."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sk120stiff.errors import listed
from sk120stiff.measurements.importers.campaign.several_files import SHOWN, joined
from sk120stiff.measurements.importers.contract import Sheet, Source
from sk120stiff.measurements.importers.formats.workbook import parts_of
from sk120stiff.measurements.importers.numbered_names import (
    NameLabel,
    in_order,
    labels_of_files,
    labels_of_sheets,
)


@dataclass(frozen=True)
class Campaign:
    """Files or sheets in their order.

    Args:
        sources: Each of them; of sheets, `Source.sheet` says which and `Source.parts` names all.
        names: What each is called: its path, of a sheet that of the workbook with its name behind.
        labels: The pose that each name tells, or None.
        said: What was decided, in sentences.
    """

    sources: tuple[Source, ...]
    names: tuple[Path, ...]
    labels: tuple[NameLabel, ...] | None
    said: tuple[str, ...] = ()

    def name(self, source: Source) -> Path:
        """What one of them is called."""
        return self.names[self.sources.index(source)]

    def label(self, source: Source) -> NameLabel | None:
        """The pose that its name tells."""
        return self.labels[self.sources.index(source)] if self.labels else None

    def whole(self, sheets: Sequence[Sheet]) -> Sheet:
        """All their readings, in the order of `sources`."""
        if len(sheets) == 1:
            return sheets[0].noting(*self.said)
        if self.sources[0].parts:
            whole = replace(joined(sheets, "sheets"), path=self.sources[0].path)
        else:
            whole = joined(sheets)
        return whole.noting(*self.said)


def campaign_of(given: Source, paths: Sequence[Path], *, alone: bool = False) -> Campaign:
    """The files in the order of the numbers in their names, or of one workbook without a sheet that
    was told the sheets that belong together, unless one `alone` is sought.

    Raises:
        InputError: A file cannot be read.
    """
    parts = parts_of(given) if len(paths) == 1 and not alone else []
    if parts:
        sources = [replace(given, sheet=part, parts=tuple(parts)) for part in parts]
        said = (
            f"The sheets {_shown(parts)} of {given.path.name} are taken together; one alone: "
            f"--sheet '{parts[0]}'."
        )
        names = [given.path / _as_file(part) for part in parts]
        return Campaign(tuple(sources), tuple(names), tuple(labels_of_sheets(parts)), (said,))
    ordered = in_order(paths)
    sources = [replace(given, path=path) for path in ordered]
    labels = labels_of_files(ordered) if len(ordered) > 1 else None
    told = tuple(labels) if labels else None
    if ordered == list(paths):
        return Campaign(tuple(sources), tuple(ordered), told)
    shown = _shown([path.name for path in ordered])
    moved = f"The files are taken in the order of the numbers in their names: {shown}."
    return Campaign(tuple(sources), tuple(ordered), told, (moved,))


def _shown(names: Sequence[str]) -> str:
    return listed(list(names), most=SHOWN)


def _as_file(title: str) -> str:
    """A point would begin the ending of a file's name."""
    return title.replace(".", ",")
