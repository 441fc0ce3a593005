"""Where in joint space a stiffness is positive definite, and where it is not."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.style import hide_spare, styled, subplots
from sk120stiff.stiffness import CLASSES

# In the order of CLASSES. Lightness differs too, so that the map survives a grey printer.
_COLOURS = (palette.GREEN, "#8FD6BF", palette.VERMILION, "#F2B58A", "#DDE3E9")


def definiteness_map(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    classes: NDArray[np.intp],
    *,
    x_label: str,
    y_label: str,
    titles: list[str] | None = None,
) -> Figure:
    """Classes over two joints, one panel per case.

    Parameters
    ----------
    x, y
        (nx,), (ny,) joint values [rad].
    classes
        (ny, nx) or (cases, ny, nx) indices into `sk120stiff.stiffness.CLASSES`.
    titles
        One per case.
    """
    found = np.asarray(classes)
    cases = found[None] if found.ndim == 2 else found
    if cases.ndim != 3 or cases.shape[1:] != (len(y), len(x)):
        raise InputError(f"classes have shape {found.shape}, not (cases, {len(y)}, {len(x)})")
    columns = min(4, len(cases))
    rows = -(-len(cases) // columns)
    with styled():
        figure, axes = subplots(
            rows, columns, height=0.8 + 1.9 * rows if columns > 1 else 3.4,
            width=7.2 if columns > 1 else 4.6, sharex=True, sharey=True,
        )  # fmt: skip
        norm = BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES))
        for k, case in enumerate(cases):
            axes[k].pcolormesh(
                np.degrees(x), np.degrees(y), case, cmap=ListedColormap(_COLOURS), norm=norm,
                shading="nearest", rasterized=True,
            )  # fmt: skip
            axes[k].grid(visible=False)
            if titles:
                axes[k].set_title(titles[k])
            if k >= len(cases) - columns:
                axes[k].set_xlabel(f"{x_label} [deg]")
                axes[k].tick_params(labelbottom=True)
            if k % columns == 0:
                axes[k].set_ylabel(f"{y_label} [deg]")
        hide_spare(axes, len(cases))
        present = sorted(set(cases.ravel().tolist()))
        figure.legend(
            handles=[
                Patch(facecolor=_COLOURS[k], edgecolor=palette.SOFT_INK, linewidth=0.5,
                      label=CLASSES[k].value)
                for k in present
            ],
            loc="outside lower center", ncols=min(3, len(present)),
        )  # fmt: skip
    return figure
