"""What the force components contribute to the diagonal of K_C: the paper's Figs. 7 to 9."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import styled, subplots

if TYPE_CHECKING:
    from matplotlib.figure import Figure


COMPONENTS = ("Fx", "Fy", "Fz")
DIVERGING = "PuOr"  # its two hues are told apart with every kind of colour vision


def surface_parts(
    x: Array, y: Array, parts: Array, *, element: str, x_label: str, y_label: str
) -> Figure:
    """Three maps side by side: the derivative that each force component multiplies.

    Args:
        x, y: (nx,), (ny,) joint values of the grid [rad].
        parts: (3, ny, nx) contribution of a unit force along x, y and z to the element [N·m/rad per
            N].
        element: Name of the element, e.g. ``C11``.
        x_label, y_label: Names of the two joints.
    """
    values, bound = _checked(x, y, parts)
    with styled():
        from matplotlib.patheffects import withStroke

        figure, axes = subplots(1, 3, height=2.75, sharey=True)
        drawn = [
            panel.pcolormesh(
                np.degrees(x), np.degrees(y), values[k], cmap=DIVERGING, vmin=-bound, vmax=bound,
                shading="nearest", rasterized=True,
            )
            for k, panel in enumerate(axes)
        ]  # fmt: skip
        for k, panel in enumerate(axes):
            if np.ptp(values[k]) > 1e-9 * bound:
                lines = panel.contour(
                    np.degrees(x), np.degrees(y), values[k], levels=5, colors=palette.INK,
                    linewidths=0.5,
                )  # fmt: skip
                for text in panel.clabel(lines, fontsize=6.5, fmt="%.2g"):
                    text.set_path_effects([withStroke(linewidth=1.6, foreground=palette.PAPER)])
            panel.grid(visible=False)
            panel.set_title(f"part {k + 1}: ∂{element}/∂{COMPONENTS[k]}")
            panel.set_xlabel(f"{x_label} [deg]")
        axes[0].set_ylabel(f"{y_label} [deg]")
        figure.colorbar(drawn[0], ax=axes, label="N·m/rad per N", shrink=0.9, pad=0.02)
    return figure


_VIEW = {"elev": 28.0, "azim": -58.0}  # degrees


def relief_parts(
    x: Array, y: Array, parts: Array, *, element: str, x_label: str, y_label: str
) -> Figure:
    """Three surfaces side by side: the derivative that each force component multiplies.

    The way the paper prints Figs. 7 to 9. Parameters are those of `surface_parts`; height and
    colour share one scale.
    """
    values, bound = _checked(x, y, parts)
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


def _checked(x: Array, y: Array, parts: Array) -> tuple[Array, float]:
    """The parts (3, ny, nx), and the largest of them."""
    values = np.asarray(parts, dtype=float)
    if values.shape != (3, len(y), len(x)):
        raise InputError(f"parts have shape {values.shape}, not (3, {len(y)}, {len(x)})")
    return values, float(np.max(np.abs(values))) or 1.0
