"""Identified values with their uncertainty, as a table drawn beside a forest plot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import named_rows, styled
from sk120stiff.show.wording import said_as

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VAGUE = 1.0  # two standard errors over the value beyond which a value is hardly known


@dataclass(frozen=True)
class Estimate:
    """One parameter; `std` is its standard error, `reference` a value to compare with.

    An infinite `std`, or a value that is not finite, belongs to what the readings do not show: it
    is named without a marker.
    """

    name: str
    value: float
    std: float | None
    unit: str
    reference: float | None = None

    @property
    def shown(self) -> bool:
        """Do the readings say anything of it?"""
        return math.isfinite(self.value) and (self.std is None or math.isfinite(self.std))


def parameter_forest(estimates: Sequence[Estimate], *, reference_name: str = "reference") -> Figure:
    """Every parameter relative to its reference (or to itself), with ±2 standard errors.

    A relative axis lets springs of different size share one picture; the values stand beside it.
    Values that are hardly known leave the picture on both sides instead of squeezing the others.
    """
    if not estimates:
        raise InputError("no parameter to draw")
    seen = np.array([e.shown for e in estimates])
    scale = np.array([_scale(e) if e.shown else 1.0 for e in estimates])
    centre = np.array([e.value if e.shown else np.nan for e in estimates]) / scale
    spread = np.array([2.0 * (e.std or 0.0) if e.shown else 0.0 for e in estimates]) / abs(scale)
    with styled():
        figure, panel, rows = named_rows([e.name for e in estimates], 0.36)
        panel.axvline(1.0, color=palette.SOFT_INK, linewidth=1.0, linestyle=":")
        panel.errorbar(
            centre[seen], rows[seen], xerr=spread[seen], fmt="o", color=palette.PREDICTED,
            capsize=3, markersize=6, elinewidth=1.6,
        )  # fmt: skip
        compared = [k for k, e in enumerate(estimates) if e.reference is not None and e.shown]
        if compared:
            panel.plot(np.ones(len(compared)), compared, "|", color=palette.BEFORE, markersize=17,
                       markeredgewidth=2.6, zorder=1)  # fmt: skip
        for k, e in enumerate(estimates):
            panel.annotate(_written(e), (1.02, k), xycoords=("axes fraction", "data"),
                           va="center", fontsize=8.5)  # fmt: skip
        reach = 1.15 * (_reach(centre[seen], spread[seen]) or 0.1)
        low = 1.0 - reach
        if (centre[seen] >= 0.0).all():  # a ratio that nothing makes negative begins at none
            low = max(low, 0.0)
        panel.set_xlim(low, 1.0 + reach)
        panel.set_xlabel(
            f"value / {reference_name}, ±2 standard errors"
            if compared
            else "value / estimate, ±2 standard errors"
        )
    return figure


def _reach(centre: Array, spread: Array) -> float:
    """Half width of the picture: all of what is known to better than itself, else all there is."""
    known = spread <= VAGUE
    if known.any():
        centre, spread = centre[known], spread[known]
    return float(np.max(np.abs(centre - 1.0) + np.minimum(spread, VAGUE), initial=0.0))


def _scale(e: Estimate) -> float:
    size = e.reference if e.reference and math.isfinite(e.reference) else e.value
    return size if size else (e.std or 1.0)


def _written(e: Estimate) -> str:
    if not e.shown:
        return "rigid" if math.isinf(e.value) else "cannot be seen"
    return said_as(e.value, e.std, e.unit)
