"""Stiffness over two joints."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.style import new_figure, styled

Array = NDArray[np.float64]


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
    title: str | None = None,
) -> Figure:
    """A quantity over two joint values, as filled contours.

    Parameters
    ----------
    x, y
        (nx,), (ny,) joint values [rad].
    values
        (ny, nx) quantity in SI, e.g. the least principal stiffness [N/m]; NaN stays white.
    scale
        Factor from SI to the unit that `value_label` names.
    marks
        Label → (x, y) [rad] of poses to mark.
    """
    shown = scale * np.asarray(values, dtype=float)
    if shown.shape != (len(y), len(x)):
        raise InputError(f"values have shape {shown.shape}, not ({len(y)}, {len(x)})")
    # A few poses near a singularity would else take the whole colour range.
    finite = shown[np.isfinite(shown)]
    top = float(np.quantile(finite, 0.98)) if finite.size else 1.0
    low = float(finite.min()) if finite.size else 0.0
    top = top if top > low else low + 1.0
    with styled():
        figure = new_figure(3.9, width=5.4)
        panel = figure.subplots()
        levels = np.linspace(low, top, 15)
        drawn = panel.contourf(
            np.degrees(x), np.degrees(y), np.clip(shown, None, top), levels=levels, cmap="cividis"
        )
        lines = panel.contour(
            np.degrees(x), np.degrees(y), np.clip(shown, None, top), levels=levels[2:-1:3],
            colors="white", linewidths=0.6,
        )  # fmt: skip
        panel.clabel(lines, fontsize=7, fmt="%.3g")
        panel.grid(visible=False)
        for label, (at_x, at_y) in (marks or {}).items():
            panel.plot(np.degrees(at_x), np.degrees(at_y), "o", color=palette.VERMILION,
                       markeredgecolor="white", markersize=7)  # fmt: skip
            panel.annotate(
                label, (np.degrees(at_x), np.degrees(at_y)), (6, 5), textcoords="offset points",
                fontsize=8.5, color="white", fontweight="bold",
            )  # fmt: skip
        panel.set_xlabel(f"{x_label} [deg]")
        panel.set_ylabel(f"{y_label} [deg]")
        bar = figure.colorbar(drawn, ax=panel, label=value_label, format="%.3g")
        bar.outline.set_visible(False)
        if title:
            panel.set_title(title)
    return figure
