"""Figures that only a story needs: the gap on the arm, and the gap against its suspects."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain import Localisation
from sk120stiff.explain.localise.localisation import Suspicion
from sk120stiff.show import palette
from sk120stiff.show.figures.style import hide_spare, styled, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LONGEST_ARROW = 0.22  # share of the picture's width
COLUMNS = 3  # of panels
MOST_POINTS = 500  # in one panel; more would only make the page heavy


@dataclass(frozen=True, eq=False)
class ArmView:
    """One pose as a line through the arm, with the gap at its end.

    Attributes:
        outline: (k, 3) points from base to tool, base axes [m].
        gaps: Name → (3,) gap [m].
        label: The pose.
    """

    outline: Array
    gaps: Mapping[str, Array]
    label: str = ""


def gap_vectors(views: Sequence[ArmView]) -> Figure:
    """Gap vectors on the arm, from above and from the side, all to one scale.

    The side view turns every pose about the vertical into one plane.
    """
    names = list(dict.fromkeys(name for view in views for name in view.gaps))
    colours = dict(zip(names, palette.steps(len(names)), strict=True))
    scale = exaggeration(views)
    with styled():
        from matplotlib.lines import Line2D

        figure, axes = subplots(1, 2, height=4.0)
        for panel, side in zip(axes, (False, True), strict=True):
            for view in views:
                _draw_arm(panel, view, names, colours, scale, side=side)
            panel.set_aspect("equal", adjustable="datalim")
            panel.margins(0.06)
        axes[0].set_title("from above")
        axes[0].set_xlabel("x [m]")
        axes[0].set_ylabel("y [m]")
        axes[1].set_title("from the side")
        axes[1].set_xlabel("distance from the first axis [m]")
        axes[1].set_ylabel("z [m]")
        handles = [Line2D([], [], color=palette.YIELDS, linewidth=2, label="arm")]
        handles += [Line2D([], [], color=colours[name], linewidth=2, label=name) for name in names]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def exaggeration(views: Sequence[ArmView]) -> float:
    """Factor by which `gap_vectors` lengthens the gaps."""
    points = np.concatenate([view.outline for view in views])
    span = float(np.ptp(points, axis=0).max()) or 1.0
    largest = max(float(np.linalg.norm(gap)) for view in views for gap in view.gaps.values())
    return LONGEST_ARROW * span / largest if largest else 1.0


def _draw_arm(
    panel: Axes,
    view: ArmView,
    names: Sequence[str],
    colours: Mapping[str, str],
    scale: float,
    *,
    side: bool,
) -> None:
    tip = view.outline[-1]
    flat = _side if side else _above
    shown = np.array([flat(point, tip) for point in view.outline])
    panel.plot(shown[:, 0], shown[:, 1], "-", color=palette.YIELDS, linewidth=1.4, alpha=0.45,
               solid_capstyle="round", zorder=1)  # fmt: skip
    panel.plot(*shown[-1], ".", color=palette.INK, markersize=3, zorder=2)
    for name in names:
        if name in view.gaps:
            end = flat(tip + scale * view.gaps[name], tip)
            step = end - shown[-1]
            panel.quiver(
                *shown[-1], *step, angles="xy", scale_units="xy", scale=1.0, width=0.005,
                color=colours[name], headwidth=3.4, headlength=4.2, headaxislength=3.8, zorder=3,
            )  # fmt: skip
            panel.plot(*end, alpha=0.0)  # arrows do not count for the limits


def _above(point: Array, _: Array) -> Array:
    return point[:2]


def _side(point: Array, tip: Array) -> Array:
    out = tip[:2] / (float(np.linalg.norm(tip[:2])) or 1.0)
    return np.array([float(point[:2] @ out), float(point[2])])


def suspect_panels(found: Localisation) -> Figure:
    """The gap against the strongest suspects and the best of every family, where any is seen.

    Each panel shows the gap along the direction of its suspect, freed of what the joint springs had
    covered up. The strongest one is marked.
    """
    shown = [s for s in found.suspects if s.partial.size]
    rows = -(-len(shown) // COLUMNS)
    with styled():
        figure, axes = subplots(rows, min(COLUMNS, len(shown)), height=0.3 + 2.15 * rows)
        for k, (panel, suspicion) in enumerate(zip(axes, shown, strict=False)):
            _draw_suspicion(panel, suspicion, marked=k == 0 and suspicion.seen)
            if k % COLUMNS == 0:
                panel.set_ylabel("gap [µm]")
        hide_spare(axes, len(shown))
    return figure


def _draw_suspicion(panel: Axes, suspicion: Suspicion, *, marked: bool) -> None:
    colour = palette.GAP if suspicion.seen else palette.NOISE
    panel.axhline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    every = slice(None, None, -(-suspicion.partial.size // MOST_POINTS))
    x, y = suspicion.abscissa[every], 1e6 * suspicion.partial[every]
    panel.plot(x, y, "o", color=colour, markersize=2.8, alpha=0.7, markeredgewidth=0)
    panel.set_xlabel(suspicion.label, fontsize=7.5)
    panel.locator_params(nbins=4)
    title = "\n".join(textwrap.wrap(suspicion.name.split(", on which")[0], 31)[:2])
    verdict = f"{100 * suspicion.explained:.0f} % taken away" if suspicion.seen else "chance"
    panel.set_title(f"{title}\n{'strongest: ' if marked else ''}{verdict}", fontsize=7.5,
                    fontweight="bold" if marked else "normal")  # fmt: skip
    if marked:
        for side in ("left", "bottom", "top", "right"):
            panel.spines[side].set(color=palette.INK, linewidth=1.5, visible=True)
