"""A loaded path: how far off the tool stands along it, and where in space."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import new_figure, soft_to_stiff, styled, subplots

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = {"before": palette.BEFORE, "after": palette.GAP}
LONGEST_ARROW = 0.16  # of the picture's extent
MOST_ARROWS = 40
MOST_POINTS = 1500  # drawn; more only make the page heavy
_VIEWS = ((0, 1), (0, 2), (1, 2))


def error_along(
    length: Array,
    predicted: Mapping[str, Array],
    std: Array | None,
    measured: Mapping[str, Array],
) -> Figure:
    """Distance from the target over the way along the path.

    Args:
        length: (N,) way from the first point [m].
        predicted, measured: Run (``before``, ``after``) → (N,) distance [m]; NaN: none.
        std: (N,) standard uncertainty of a prediction [m], drawn about the corrected run.
    """
    if not len(length):
        raise InputError("no point to draw")
    shown = thinned(next(iter(predicted.values())))
    with styled():
        figure = new_figure(3.0)
        panel = figure.subplots()
        x = 1e3 * length[shown]
        for run, values in predicted.items():
            panel.plot(x, 1e6 * values[shown], color=COLOURS[run], label=f"{run}, predicted",
                       marker="o" if len(x) < 3 else "", zorder=2)  # fmt: skip
        if std is not None and np.isfinite(std).any():
            panel.fill_between(
                x, 0.0, 1e6 * (predicted["after"] + std)[shown], color=palette.GAP, alpha=0.2,
                linewidth=0.0, label="after, ± one standard distance", zorder=1,
            )  # fmt: skip
        for run, values in measured.items():
            panel.plot(x, 1e6 * values[shown], "o", color=COLOURS[run], zorder=3, markersize=4,
                       markerfacecolor=palette.PAPER, label=f"{run}, measured")  # fmt: skip
        panel.set_xlabel("way along the path [mm]")
        panel.set_ylabel("off its place [µm]")
        panel.set_ylim(bottom=0.0)
        panel.margins(x=0.01)
        figure.legend(loc="outside upper left", ncols=3)
    return figure


def thinned(size: Array) -> Index:
    """Which of N points to draw: evenly spread, with the largest among them."""
    if len(size) <= MOST_POINTS:
        return np.arange(len(size))
    spread = np.linspace(0, len(size) - 1, MOST_POINTS).astype(np.intp)
    largest = np.flatnonzero(size == np.nanmax(size))[:1] if np.isfinite(size).any() else spread[:0]
    return np.unique(np.concatenate([spread, largest]))


def path_map(position: Array, away: Array, worst: int) -> Figure:
    """The path in two views, coloured by the error, with arrows along it.

    Args:
        position: (N, 3) where the tool should stand, axes of the path [m].
        away: (N, 3) how far off it stands [m].
        worst: The point to mark.
    """
    mark = position[worst]
    scale = exaggeration(position, away)
    shown = thinned(np.linalg.norm(away, axis=1))
    position, away = position[shown], away[shown]
    extent = np.ptp(position, axis=0)
    first = max(
        _VIEWS, key=lambda view: extent[view[0]] * extent[view[1]] + extent[list(view)].sum()
    )
    rest = [view for view in _VIEWS if view != first]
    second = max(rest, key=lambda view: np.abs(away[:, list(view)]).sum())
    size = 1e6 * np.linalg.norm(away, axis=1)
    every = slice(None, None, -(-len(position) // MOST_ARROWS))
    with styled():
        figure, panels = subplots(1, 2, height=3.6)
        for panel, (a, b) in zip(panels, (first, second), strict=True):
            panel.plot(1e3 * position[:, a], 1e3 * position[:, b], color=palette.NOISE,
                       linewidth=0.8, zorder=1)  # fmt: skip
            ends = position + scale * away
            lines = np.stack([position, ends], axis=1)[every]
            for line in lines:
                panel.plot(1e3 * line[:, a], 1e3 * line[:, b], color=palette.GAP, linewidth=0.8,
                           alpha=0.7, zorder=2)  # fmt: skip
            drawn = panel.scatter(1e3 * position[:, a], 1e3 * position[:, b], c=size, s=16,
                                  cmap=soft_to_stiff().reversed(), zorder=3)  # fmt: skip
            panel.plot(*(1e3 * mark[[a, b]]), "o", markersize=11, zorder=4,
                       markerfacecolor="none", markeredgecolor=palette.INK)  # fmt: skip
            panel.set_xlabel(f"{'xyz'[a]} [mm]")
            panel.set_ylabel(f"{'xyz'[b]} [mm]")
            panel.set_aspect("equal", adjustable="datalim")
            panel.margins(0.12)
            panel.locator_params(nbins=5)
        figure.colorbar(drawn, ax=panels, label="off its place, uncorrected [µm]", shrink=0.85)
    return figure


def exaggeration(position: Array, away: Array) -> float:
    """Factor by which `path_map` lengthens the errors: a round number."""
    span = float(np.ptp(position, axis=0).max()) or 0.1
    largest = float(np.nanmax(np.linalg.norm(away, axis=1), initial=0.0))
    if largest == 0.0:
        return 1.0
    factor = LONGEST_ARROW * span / largest
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(k for k in (1.0, 2.0, 5.0) if k * power <= factor * (1 + 1e-12)))
