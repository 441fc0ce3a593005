"""The posture that was chosen, among those that might have been."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FLAT = 0.1  # smallest height of a panel, relative to its middle


def posture_choice(
    per_point: Array,
    *,
    compliance: bool,
    landscape: tuple[Array, Array] | None = None,
    chosen: tuple[float, float] | None = None,
    tilt: bool = False,
    blind: Array | None = None,
) -> Figure:
    """What the tool's orientation does to the worst point, and the chosen posture along the path.

    Args:
        per_point: (N,) compliance [m/N] or deflection [m] along the path.
        compliance: Are the values compliances? They are then drawn as stiffness.
        landscape: (k,) angles of the tool [rad] and (k,) worst values along the path; None where it
            is fixed.
        chosen: Angle and worst value of the chosen posture.
        tilt: Are the angles those of the tool's axis from straight down? Else turns about that
            axis.
        blind: (m,) worst values of postures met at random, whose median is drawn.
    """
    if (landscape is None) != (chosen is None):
        raise InputError("a landscape and the posture chosen in it are given together")
    label = "stiffness [N/µm]" if compliance else "deflection [µm]"
    which = "least" if compliance else "largest"

    def shown(values: Array | float) -> Array:
        given = np.asarray(values, dtype=float)
        return 1e-6 / given if compliance else 1e6 * given

    with styled():
        figure = new_figure(3.3, width=7.2 if landscape else 4.6)
        panels = list(figure.subplots(1, 2 if landscape else 1, squeeze=False).flat)
        if landscape is not None and chosen is not None:
            panel = panels[0]
            others = "postures sampled" if tilt else "postures on a grid"
            panel.plot(np.degrees(landscape[0]), shown(landscape[1]), ".", color=palette.NOISE,
                       markersize=3.5, label=others)  # fmt: skip
            panel.plot(np.degrees(chosen[0]), shown(chosen[1]), "o", color=palette.VERMILION,
                       markeredgecolor="white", markersize=8, label="chosen", zorder=5)  # fmt: skip
            panel.set_xlim(-6.0 if tilt else -186.0, 186.0)
            panel.set_xticks(range(0 if tilt else -180, 181, 45 if tilt else 90))
            panel.set_xlabel(
                "tool axis from straight down [deg]"
                if tilt
                else "turn of the tool about its axis [deg]"
            )
            panel.set_ylabel(f"{which} {label}")
            panel.set_title("Worst point of the path")
            _widen(panel)
        panel = panels[-1]
        points = np.arange(1, len(per_point) + 1)
        panel.plot(points, shown(per_point), "o-", color=palette.VERMILION, markersize=4,
                   label=None if landscape else "chosen")  # fmt: skip
        if blind is not None and len(blind):
            panel.axhline(
                float(shown(float(np.median(blind)))), color=palette.SOFT_INK, linestyle="--",
                linewidth=1.0, label=f"worst point of a blind choice (median of {len(blind)})",
            )  # fmt: skip
        panel.xaxis.get_major_locator().set_params(integer=True)
        panel.set_xlabel("point of the path [number]")
        panel.set_ylabel(label)
        panel.set_title("Along the path, chosen posture" if landscape else "Along the path")
        _widen(panel)
        figure.legend(loc="outside lower center", ncols=3)
    return figure


def _widen(panel: Axes) -> None:
    """Values that are all alike are drawn as a level line, not as noise of the last digit."""
    low, high = panel.get_ylim()
    middle = 0.5 * (low + high)
    if high - low < FLAT * abs(middle):
        panel.set_ylim(middle * (1.0 - 0.5 * FLAT), middle * (1.0 + 0.5 * FLAT))
