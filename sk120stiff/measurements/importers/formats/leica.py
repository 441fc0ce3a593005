"""Points as programs for Leica trackers export them: U95 beside coordinates, temperatures."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.layout.layout import layout_of, sheet_by_order

_SAYS = re.compile(
    r"leica|hexagon|emscon|axyz|\bat ?(?:40[123]|9[36]0|500)\b|u ?\(?95", re.IGNORECASE
)


@dataclass(frozen=True)
class Leica:
    """Coordinates with expanded uncertainties (95 %), which are twice the standard ones."""

    name: str = "leica"
    title: str = "a Leica tracker's table"

    def sniff(self, source: Source) -> Guess:
        """The maker or an instrument is named above the table, or a header says U95."""
        layout = layout_of(source)
        if source.role != "points" or layout is None or not layout.has("x", "y", "z"):
            return NO
        texts = [text for _, text in (*source.grid.comments, *layout.above)]
        found = next((m[0] for t in (*texts, *layout.headers) if (m := _SAYS.search(t))), None)
        return Guess(0.8, f"it says {found!r}") if found else NO

    def read(self, source: Source) -> Sheet:
        """The points, U95 halved."""
        return sheet_by_order(source, (), self.title, self.sniff(source).why)
