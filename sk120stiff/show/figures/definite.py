"""Where in joint space a stiffness is positive definite, and where it is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import FROM_SI, hide_spare, styled, subplots
from sk120stiff.stiffness import CLASSES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# In the order of CLASSES. Lightness differs too, so that the map survives a grey printer.
_COLOURS = (palette.GREEN, "#8FD6BF", palette.VERMILION, "#F2B58A", "#DDE3E9")


def definiteness_map(
    x: Array,
    y: Array,
    classes: Index,
    *,
    x_label: str,
    y_label: str,
    titles: list[str] | None = None,
    units: tuple[str, str] = ("deg", "deg"),
) -> Figure:
    """Classes over two joints, one panel per case.

    Args:
        x, y: (nx,), (ny,) joint values [rad] or positions [m].
        classes: (ny, nx) or (cases, ny, nx) indices into `sk120stiff.stiffness.CLASSES`; any other
            number is a pose without a class and stays white.
        titles: One per case.
        units: Units of the two axes as they are drawn: keys of `figures.style.FROM_SI`.
    """
    x, y = FROM_SI[units[0]] * np.asarray(x), FROM_SI[units[1]] * np.asarray(y)
    found = np.asarray(classes)
    cases = found[None] if found.ndim == 2 else found
    if cases.ndim != 3 or cases.shape[1:] != (len(y), len(x)):
        raise InputError(f"classes have shape {found.shape}, not (cases, {len(y)}, {len(x)})")
    columns = min(4, len(cases))
    rows = -(-len(cases) // columns)
    tall = 1.9 if columns > 2 else 2.7
    with styled():
        from matplotlib.colors import BoundaryNorm, ListedColormap
        from matplotlib.patches import Patch

        figure, axes = subplots(
            rows, columns, height=0.8 + tall * rows if columns > 1 else 3.4,
            width=7.2 if columns > 1 else 4.6, sharex=True, sharey=True,
        )  # fmt: skip
        norm = BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES))
        for k, case in enumerate(cases):
            axes[k].pcolormesh(
                x, y, np.ma.masked_outside(case, 0, len(CLASSES) - 1),
                cmap=ListedColormap(_COLOURS), norm=norm,
                shading="nearest", rasterized=True,
            )  # fmt: skip
            axes[k].grid(visible=False)
            if titles:
                axes[k].set_title(titles[k])
            if k >= len(cases) - columns:
                axes[k].set_xlabel(f"{x_label} [{units[0]}]")
                axes[k].tick_params(labelbottom=True)
            if k % columns == 0:
                axes[k].set_ylabel(f"{y_label} [{units[1]}]")
        hide_spare(axes, len(cases))
        present = [k for k in range(len(CLASSES)) if (cases == k).any()]
        figure.legend(
            handles=[
                Patch(facecolor=_COLOURS[k], edgecolor=palette.SOFT_INK, linewidth=0.5,
                      label=CLASSES[k].value)
                for k in present
            ],
            loc="outside lower center", ncols=min(3, len(present)),
        )  # fmt: skip
    return figure
