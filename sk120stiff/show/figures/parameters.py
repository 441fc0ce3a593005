"""Identified values with their doubt, as a table drawn beside a forest plot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.style import new_figure, styled
from sk120stiff.show.wording import with_error


@dataclass(frozen=True)
class Estimate:
    """One parameter; `std` is its standard error, `reference` a value to compare with."""

    name: str
    value: float
    std: float | None
    unit: str
    reference: float | None = None
    note: str = ""


def parameter_forest(
    estimates: Sequence[Estimate], *, reference_name: str = "reference", title: str | None = None
) -> Figure:
    """Every parameter relative to its reference (or to itself), with ±2 standard errors.

    A relative axis lets springs of different size share one picture; the values stand beside it.
    """
    if not estimates:
        raise InputError("no parameter to draw")
    scale = np.array([_scale(e) for e in estimates])
    centre = np.array([e.value for e in estimates]) / scale
    spread = np.array([np.nan if e.std is None else 2.0 * e.std for e in estimates]) / abs(scale)
    with styled():
        figure = new_figure(1.05 + 0.36 * len(estimates))
        panel = figure.subplots()
        rows = np.arange(len(estimates))
        panel.axvline(1.0, color=palette.SOFT_INK, linewidth=1.0, linestyle=":")
        panel.errorbar(
            centre, rows, xerr=np.nan_to_num(spread), fmt="o", color=palette.BLUE, capsize=3,
            markersize=6, elinewidth=1.6,
        )  # fmt: skip
        compared = [k for k, e in enumerate(estimates) if e.reference is not None]
        if compared:
            panel.plot(np.ones(len(compared)), compared, "|", color=palette.ORANGE, markersize=17,
                       markeredgewidth=2.6, zorder=1)  # fmt: skip
        panel.set_yticks(rows, [e.name for e in estimates])
        panel.set_ylim(len(estimates) - 0.4, -0.6)
        for k, e in enumerate(estimates):
            panel.annotate(_written(e), (1.02, k), xycoords=("axes fraction", "data"),
                           va="center", fontsize=8.5)  # fmt: skip
        reach = float(np.nanmax([*abs(centre - 1.0), *(abs(centre - 1.0) + np.nan_to_num(spread))]))
        panel.set_xlim(1.0 - 1.15 * (reach or 0.1), 1.0 + 1.15 * (reach or 0.1))
        panel.set_xlabel(
            f"value / {reference_name}, ±2 standard errors"
            if compared
            else "value / estimate, ±2 standard errors"
        )
        panel.grid(visible=False, axis="y")
        panel.tick_params(axis="y", length=0)
        if title:
            panel.set_title(title)
    return figure


def _scale(e: Estimate) -> float:
    size = e.reference if e.reference else e.value
    return size if size else (e.std or 1.0)


def _written(e: Estimate) -> str:
    note = f"  {e.note}" if e.note else ""
    return f"{with_error(e.value, e.std, e.unit)}{note}"
