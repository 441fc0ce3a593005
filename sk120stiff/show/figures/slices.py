"""Stiffness over two joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import FROM_SI, new_figure, soft_to_stiff, styled
from sk120stiff.show.wording import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure


STEPS = 14  # colours of a scale
DARKER = 0.55  # than the end of the scale: what lies beyond it


def written(value: float, _: object = None) -> str:
    """A value at a line or a bar: 2523, not 2.52e+03."""
    return number(value, 3)


def stiffness_slice(
    x: Array,
    y: Array,
    values: Array,
    *,
    x_label: str,
    y_label: str,
    value_label: str = "least stiffness [N/µm]",
    scale: float = 1e-6,
    marks: Mapping[str, tuple[float, float]] | None = None,
    units: tuple[str, str] = ("deg", "deg"),
    title: str | None = None,
    low_is_soft: bool = True,
) -> Figure:
    """A quantity over two joint values or two positions, as filled contours.

    Where the largest 2 % go far beyond the others the scale ends before them: they have a colour of
    their own, and the bar says how far they go.

    Args:
        x, y: (nx,), (ny,) joint values [rad] or positions [m].
        values: (ny, nx) quantity in SI, e.g. the least principal stiffness [N/m]; NaN stays white.
        scale: Factor from SI to the unit that `value_label` names.
        marks: Label → (x, y) [rad or m] of poses to mark.
        low_is_soft: Are small values those of a soft arm, as of a stiffness? Else the large ones.
        units: Units of the two axes as they are drawn: keys of `figures.style.FROM_SI`.
    """
    x, y = FROM_SI[units[0]] * np.asarray(x), FROM_SI[units[1]] * np.asarray(y)
    shown = scale * np.asarray(values, dtype=float)
    if shown.shape != (len(y), len(x)):
        raise InputError(f"values have shape {shown.shape}, not ({len(y)}, {len(x)})")
    # A few poses near a singularity would else take the whole colour range.
    finite = shown[np.isfinite(shown)]
    top = float(np.quantile(finite, 0.98)) if finite.size else 1.0
    low = float(finite.min()) if finite.size else 0.0
    most = float(finite.max()) if finite.size else top
    beyond = most - top > (top - low) / STEPS  # else the scale may as well go all the way
    top = top if beyond else most
    top = top if top > low else low + 1.0
    with styled():
        from matplotlib.patheffects import withStroke
        from matplotlib.ticker import FuncFormatter

        figure = new_figure(3.9, width=5.4)
        panel = figure.subplots()
        scheme = soft_to_stiff() if low_is_soft else soft_to_stiff().reversed()
        cmap = scheme.with_extremes(over=tuple(DARKER * np.array(scheme(1.0)[:3])))
        levels = np.linspace(low, top, STEPS + 1)
        drawn = panel.contourf(
            x, y, shown, levels=levels, cmap=cmap, extend="max" if beyond else "neither"
        )
        lines = panel.contour(
            x, y, shown, levels=levels[2:-1:3], colors="white", linewidths=0.6,
        )  # fmt: skip
        panel.clabel(lines, fontsize=7, fmt=written)
        panel.grid(visible=False)
        for label, mark in (marks or {}).items():
            place = (FROM_SI[units[0]] * mark[0], FROM_SI[units[1]] * mark[1])
            right = place[0] > 0.5 * (x[0] + x[-1])  # the label stays inside the picture
            high = place[1] > 0.5 * (y[0] + y[-1])
            panel.plot(*place, "o", color=palette.INK, markeredgecolor=palette.PAPER,
                       markersize=7, clip_on=False, zorder=5)  # fmt: skip
            panel.annotate(
                label, place, (-7 if right else 7, -6 if high else 6), textcoords="offset points",
                ha="right" if right else "left", va="top" if high else "bottom", fontsize=8.5,
                color="white", fontweight="bold",
                path_effects=[withStroke(linewidth=2.0, foreground=palette.INK)],
            )  # fmt: skip
        panel.set_xlabel(f"{x_label} [{units[0]}]")
        panel.set_ylabel(f"{y_label} [{units[1]}]")
        told = f"{value_label}; top 2 %: to {written(most)}" if beyond else value_label
        bar = figure.colorbar(drawn, ax=panel, label=told, format=FuncFormatter(written))
        bar.outline.set_visible(False)
        if title:
            panel.set_title(title)
    return figure
