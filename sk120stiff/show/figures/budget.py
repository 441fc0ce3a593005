"""What each effect moves the point by, as bars with their standard errors."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import named_rows, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MEASURED = "µm rms per axis at the measured loads, ± one standard error"


def budget_bars(
    names: Sequence[str],
    sizes: Array,
    errors: Array,
    *,
    label: str = MEASURED,
    named: Collection[str] = (),
) -> Figure:
    """One bar for each share: sizes (k,) and standard errors (k,) [µm]; those `named` stand out."""
    if not len(names):
        raise InputError("no share to draw")
    with styled():
        figure, panel, rows = named_rows(names, 0.32)
        colours = [palette.NAMED if name in named else palette.YIELDS for name in names]
        panel.barh(
            rows,
            sizes,
            xerr=errors if np.any(errors) else None,
            color=colours,
            ecolor=palette.INK,
            capsize=3,
        )
        panel.set_xlabel(label)
    return figure
