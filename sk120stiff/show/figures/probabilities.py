"""Probabilities as bars from zero to one, those that exclude one another side by side."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import named_rows, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def probability_bars(
    rows: Sequence[tuple[str, float]], said: Sequence[str], *, named: Collection[int] = ()
) -> Figure:
    """One bar for each (name, probability), with what is `said` of it; rows `named` in violet."""
    if not rows:
        raise InputError("no probability to draw")
    with styled():
        figure, panel, places = named_rows([name for name, _ in rows], 0.28)
        colours = [palette.NAMED if k in named else palette.NOISE for k in range(len(rows))]
        panel.barh(places, [share for _, share in rows], color=colours, height=0.6)
        for place, (_, share), text in zip(places, rows, said, strict=True):
            panel.annotate(text, (share, place), (5, 0), textcoords="offset points", va="center",
                           fontsize=8.5, color=palette.INK)  # fmt: skip
        panel.set_xlim(0.0, 1.15)  # room for what is said of the longest bar
        panel.set_xticks([0.0, 0.25, 0.5, 0.75, 0.95], ["0", "0.25", "0.5", "0.75", "0.95"])
        panel.set_xlabel("probability")
    return figure
