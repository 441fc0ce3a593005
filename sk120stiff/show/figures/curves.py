"""Force against deflection, measured and modelled: the kind of the paper's Figs. 4 to 6."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import hide_spare, styled, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

COLUMNS = 3  # of panels
Dash = Literal["-", "--", ":", "-."]
_DASHES: tuple[Dash, ...] = ("--", ":", "-.")  # of earlier models
_MARKERS = ("o", "s", "^")


@dataclass(frozen=True, eq=False)
class LoadCurve:
    """One pose loaded step by step.

    Attributes:
        title: What the panel is headed with, e.g. ``pose 1``.
        force: (k,) size of the load at each reading [N].
        measured: (k, 3) measured displacement, base axes [m]; None where there is none.
        sigma: (k, 3) standard uncertainty of the readings [m], or None.
        models: Model name → (k, 3) predicted displacement [m].
    """

    title: str
    force: Array
    measured: Array | None = None
    sigma: Array | None = None
    models: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, values in self.models.items():
            if np.shape(values) != (len(self.force), 3):
                raise InputError(
                    f"model {name!r} has predictions of shape {np.shape(values)}, "
                    f"not ({len(self.force)}, 3)",
                    where=self.title,
                )
        if self.measured is not None and np.shape(self.measured) != (len(self.force), 3):
            raise InputError(
                f"measured displacements have shape {np.shape(self.measured)}, "
                f"not ({len(self.force)}, 3)",
                where=self.title,
            )


def force_deflection(curves: Sequence[LoadCurve]) -> Figure:
    """Displacement of the point over the size of the load, one panel per pose.

    Marker shapes are the base axes, which the lines are named by too; colours and line styles are
    readings and models, the last model that at hand.
    """
    if not curves:
        raise InputError("no pose to draw")
    columns = min(COLUMNS, len(curves))
    rows = -(-len(curves) // columns)
    with styled():
        figure, axes = subplots(rows, columns, height=0.65 + 2.45 * rows, sharex=False)
        names = list(dict.fromkeys(name for curve in curves for name in curve.models))
        for panel, curve in zip(axes, curves, strict=False):
            _draw(panel, curve, names)
        for k, panel in enumerate(axes[: len(curves)]):
            panel.set_xlabel("load [N]")
            if k % columns == 0:
                panel.set_ylabel("displacement [µm]")
        hide_spare(axes, len(curves))
        measured = any(curve.measured is not None for curve in curves)
        figure.legend(
            handles=_key(names, measured), loc="outside lower center", ncols=3 + len(names) + 1
        )
    return figure


def _draw(panel: Axes, curve: LoadCurve, names: Sequence[str]) -> None:
    panel.set_title(curve.title)
    panel.axhline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    looks = _looks(names)
    for axis in range(3):
        if curve.measured is not None:
            panel.errorbar(
                curve.force,
                1e6 * np.asarray(curve.measured)[:, axis],
                yerr=None if curve.sigma is None else 1e6 * np.asarray(curve.sigma)[:, axis],
                fmt=_MARKERS[axis],
                color=palette.MEASURED,
                markerfacecolor=palette.PAPER,
                markeredgewidth=1.3,
                elinewidth=0.9,
                capsize=2,
                zorder=3,
            )
        loads = np.asarray(curve.force)
        for name, values in curve.models.items():
            style, colour = looks[name]
            panel.plot(loads, 1e6 * np.asarray(values)[:, axis], style, color=colour)
        ends = [values[:, axis] for values in (*list(curve.models.values())[::-1], curve.measured)
                if values is not None]  # fmt: skip
        if len(loads) and ends:
            end = (float(loads[-1]), 1e6 * float(ends[0][-1]))
            panel.annotate(f"d{'xyz'[axis]}", end, (5, 0), textcoords="offset points", va="center",
                           fontsize=8.5)  # fmt: skip
    panel.margins(x=0.1, y=0.08)


def _looks(names: Sequence[str]) -> dict[str, tuple[Dash, str]]:
    """Line style and colour of every model: the last is the one at hand."""
    looks: list[tuple[Dash, str]] = [
        (_DASHES[k % len(_DASHES)], palette.BEFORE) for k in range(len(names) - 1)
    ]
    return dict(zip(names, [*looks, ("-", palette.PREDICTED)], strict=False))


def _key(names: Sequence[str], measured: bool) -> list[Line2D]:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=palette.MEASURED, marker=_MARKERS[k], linestyle="",
               markerfacecolor=palette.PAPER, label=f"d{'xyz'[k]} measured")
        for k in range(3 if measured else 0)
    ]  # fmt: skip
    return handles + [
        Line2D([], [], color=colour, linestyle=style, label=name)
        for name, (style, colour) in _looks(names).items()
    ]
