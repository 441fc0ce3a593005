"""One look for every figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.errors import require
from sk120stiff.show import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.figure import Figure

#: Factor from SI to a unit that axes are drawn in.
FROM_SI: Final = {"deg": 180.0 / pi, "rad": 1.0, "mm": 1e3, "m": 1.0}

WIDTH: Final = 7.2  # inches: the text width of a report page

HOUSE: Final[Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": palette.SOFT_INK,
    "axes.facecolor": palette.PAPER,
    "axes.grid": True,
    "axes.labelcolor": palette.INK,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.unicode_minus": True,
    "figure.constrained_layout.use": True,
    "figure.dpi": 110,
    "figure.facecolor": palette.PAPER,
    "figure.titlesize": 11.0,
    "figure.titleweight": "bold",
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same picture on every machine
    "font.size": 9.0,
    "grid.color": palette.RULE,
    "grid.linewidth": 0.6,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.7,
    "lines.markersize": 5.0,
    "savefig.facecolor": palette.PAPER,
    "svg.fonttype": "path",  # no text is clipped by a font that the reader lacks
    "svg.hashsalt": "sk120stiff",
    "text.color": palette.INK,
    "xtick.color": palette.SOFT_INK,
    "xtick.labelcolor": palette.INK,
    "xtick.labelsize": 8.5,
    "ytick.color": palette.SOFT_INK,
    "ytick.labelcolor": palette.INK,
    "ytick.labelsize": 8.5,
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw in the house style, without touching the settings of the caller.

    Raises:
        MissingPart: matplotlib is not installed.
    """
    require("matplotlib", needed_for="a picture")
    from matplotlib import rc_context

    with rc_context(HOUSE):
        yield


def new_figure(height: float, *, width: float = WIDTH) -> Figure:
    """An empty figure of the given size in inches, free of any window system."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height))


def subplots(
    rows: int, columns: int, *, height: float, width: float = WIDTH, **options: Any
) -> tuple[Figure, list[Axes]]:
    """A figure and its axes, row by row."""
    figure = new_figure(height, width=width)
    grid = figure.subplots(rows, columns, squeeze=False, **options)
    return figure, list(grid.flat)


def named_rows(names: Sequence[str], height: float) -> tuple[Figure, Axes, Index]:
    """A figure with a row of the given height [inches] for each name, the first on top."""
    figure = new_figure(1.05 + height * len(names))
    panel, rows = figure.subplots(), np.arange(len(names))
    panel.set_yticks(rows, list(names))
    panel.set_ylim(len(names) - 0.4, -0.6)
    panel.grid(visible=False, axis="y")
    panel.tick_params(axis="y", length=0)
    return figure, panel, rows


def soft_to_stiff() -> LinearSegmentedColormap:
    """Colours of a map, from soft to stiff."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("soft to stiff", palette.SOFT_TO_STIFF)


def hide_spare(axes: list[Axes], used: int) -> None:
    """Blank the axes of a grid that no data fills."""
    for spare in axes[used:]:
        spare.set_axis_off()
