"""The maps of `surface_parts` as surfaces in perspective, the way the paper prints Figs. 7 to 9."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show.figures.parts import COMPONENTS, DIVERGING
from sk120stiff.show.figures.style import styled, subplots

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_VIEW = {"elev": 28.0, "azim": -58.0}  # degrees


def relief_parts(
    x: Array, y: Array, parts: Array, *, element: str, x_label: str, y_label: str
) -> Figure:
    """Three surfaces side by side: the derivative that each force component multiplies.

    Parameters are those of `sk120stiff.show.figures.surface_parts`; height and colour share one
    scale.
    """
    values = np.asarray(parts, dtype=float)
    if values.shape != (3, len(y), len(x)):
        raise InputError(f"parts have shape {values.shape}, not (3, {len(y)}, {len(x)})")
    bound = float(np.max(np.abs(values))) or 1.0
    across, along = np.meshgrid(np.degrees(x), np.degrees(y))
    with styled():
        figure, axes = subplots(1, 3, height=2.9, width=9.6, subplot_kw={"projection": "3d"})
        for k, each in enumerate(axes):
            panel: Any = each
            drawn = panel.plot_surface(
                across, along, values[k], cmap=DIVERGING, vmin=-bound, vmax=bound,
                rcount=40, ccount=40, linewidth=0.15, edgecolor="#52606D", rasterized=True,
            )  # fmt: skip
            panel.set_zlim(-bound, bound)
            panel.view_init(**_VIEW)
            panel.set_box_aspect((1.0, 1.0, 0.8), zoom=0.92)
            panel.locator_params(nbins=5)
            panel.tick_params(labelsize=7, pad=0)
            panel.set_title(f"part {k + 1}: ∂{element}/∂{COMPONENTS[k]}")
            panel.set_xlabel(f"{x_label} [deg]", labelpad=2)
            panel.set_ylabel(f"{y_label} [deg]", labelpad=2)
        figure.colorbar(drawn, ax=axes, label="N·m/rad per N", shrink=0.7, pad=0.02)
    return figure
