"""How far every candidate stands behind the best: one bar each."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import named_rows, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRONG = 6.0  # difference from which on evidence is called strong (Kass & Raftery 1995)
EVEN = 10.0  # up to here the axis is even, beyond it logarithmic


def score_bars(behind: Mapping[str, float], *, named: Collection[str] = ()) -> Figure:
    """Bars of ΔBIC, the best first; those `named` in their own colour.

    Args:
        behind: Candidate → by how much its score is worse than the best.
    """
    if not behind:
        raise InputError("no candidate to draw")
    ranked = sorted(behind.items(), key=lambda item: item[1])
    values = np.array([value for _, value in ranked])
    with styled():
        figure, panel, rows = named_rows([name for name, _ in ranked], 0.3)
        colours = [palette.NAMED if name in named else palette.NOISE for name, _ in ranked]
        panel.barh(rows, values, color=colours, height=0.6)
        for row, (name, value) in enumerate(ranked):
            panel.annotate(
                "best" if value <= 0.0 else f"+{value:.1f}" if value < 100 else f"+{value:.0f}",
                (max(value, 0.0), row), (5, 0), textcoords="offset points", va="center",
                fontsize=8.5, color=palette.NAMED if name in named else palette.INK,
            )  # fmt: skip
        panel.axvline(STRONG, color=palette.INK, linestyle="--", linewidth=1.0,
                      label=f"strong evidence against: {STRONG:.0f}")  # fmt: skip
        panel.set_xscale("symlog", linthresh=EVEN)
        panel.set_xlim(0.0, 2.2 * max(values.max(), EVEN))
        panel.xaxis.set_major_formatter("{x:g}")
        panel.set_xlabel("ΔBIC: how much worse with this candidate in its place")
        figure.legend(loc="outside lower center")
    return figure
