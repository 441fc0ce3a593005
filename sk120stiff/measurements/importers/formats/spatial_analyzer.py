"""Points as SpatialAnalyzer exports them: ``Collection Group Target x y z``, ``//`` comments."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sk120stiff.measurements.importers.clock import is_clock
from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.layout.layout import layout_of, sheet_by_order

_SAYS = re.compile(r"spatial ?analyzer|\bSA \d{4}|working frame", re.IGNORECASE)
_LABELS = {3: ("Collection", "Group", "Target"), 2: ("Group", "Target"), 1: ("Target",)}


@dataclass(frozen=True)
class SpatialAnalyzer:
    """Names in one to three columns, three coordinates; uncertainties and times if exported."""

    name: str = "sa"
    title: str = "SpatialAnalyzer's ASCII export"

    def sniff(self, source: Source) -> Guess:
        """The program's name in a comment, its three headers, or three names before numbers."""
        grid = source.grid
        if source.role != "points" or source.columns:
            return NO
        layout = layout_of(source)
        if layout is not None and layout.has("collection", "group", "name"):
            return Guess(0.9, "the columns Collection, Group and Target")
        if any(_SAYS.search(text) for _, text in grid.comments):
            return Guess(0.9, "a comment names the program") if self._columns(source) else NO
        if layout is None and (self._columns(source) or ("",))[0] == "Collection":
            return Guess(0.8, "Collection, Group and Target before three numbers")
        return NO

    def read(self, source: Source) -> Sheet:
        """The points; unnamed numbers behind them are uncertainties where a comment says so."""
        return sheet_by_order(
            source, self._columns(source) or (), self.title, self.sniff(source).why
        )

    def _columns(self, source: Source) -> tuple[str, ...] | None:
        """Names of the columns of a file without headers."""
        row = next((r for r in source.grid.rows if sum(map(is_number, r)) >= 3), ())
        clocks: tuple[str, ...] = ()
        while row and is_clock(row[-1]) and not is_number(row[-1]):
            clocks, row = ("time" if ":" in row[-1] else "date", *clocks), row[:-1]
        numbers = 0
        while numbers < len(row) and is_number(row[-1 - numbers]):
            numbers += 1
        labels = _LABELS.get(len(row) - numbers)
        if labels is None and numbers > 3 and len(row) - numbers == 0:
            labels, numbers = ("Target",), numbers - 1  # targets are often numbers
        if labels is None:
            return None
        said = " ".join(text for _, text in source.grid.comments).lower()
        more = ("ux", "uy", "uz") if "uncert" in said and numbers >= 6 else ()
        names = (*labels, "x", "y", "z", *more)
        return (*names, *["-"] * (len(labels) + numbers - len(names)), *clocks)
