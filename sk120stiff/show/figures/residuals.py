"""The gap against everything that might explain it, as small multiples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import hide_spare, styled, subplots

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Suspect:
    """A variable that the gap may depend on.

    Attributes:
        name: With its unit in brackets, e.g. ``torque of joint_2_l [N·m]``.
        values: (k,) value at every residual, in that unit.
        strength: How much of the gap it explains, 0 to 1; None leaves it to the square of the
            correlation.
    """

    name: str
    values: Array
    strength: float | None = None


def residual_suspects(
    residuals: Array, suspects: Sequence[Suspect], *, label: str = "gap [µm]", columns: int = 4
) -> Figure:
    """Residual against each suspect; the strongest one is marked.

    Args:
        residuals: (k,) gap [m].
        suspects: Variables with (k,) values each.
        label: Name of the ordinate, in µm.
    """
    gap = 1e6 * np.asarray(residuals, dtype=float)
    if not suspects:
        raise InputError("no suspect to draw")
    for suspect in suspects:
        if np.shape(suspect.values) != gap.shape:
            raise InputError(
                f"suspect {suspect.name!r} has {np.size(suspect.values)} values for "
                f"{gap.size} residuals"
            )
    strengths = [_strength(suspect, gap) for suspect in suspects]
    strongest = int(np.argmax(strengths))
    columns = min(columns, len(suspects))
    rows = -(-len(suspects) // columns)
    with styled():
        figure, axes = subplots(rows, columns, height=0.3 + 1.85 * rows, sharey=True)
        for k, (panel, suspect) in enumerate(zip(axes, suspects, strict=False)):
            colour = palette.GAP
            values = np.asarray(suspect.values, dtype=float)
            panel.axhline(0.0, color=palette.SOFT_INK, linewidth=0.7)
            panel.plot(values, gap, "o", color=colour, markersize=3.2, alpha=0.75,
                       markeredgewidth=0)  # fmt: skip
            if np.ptp(values) > 0:
                line = np.polyfit(values, gap, 1)
                ends = np.array([values.min(), values.max()])
                panel.plot(ends, np.polyval(line, ends), color=colour, linewidth=1.2)
            panel.set_xlabel(suspect.name, fontsize=7.5)
            mark = "strongest, " if k == strongest else ""
            panel.set_title(
                f"{mark}{100 * strengths[k]:.0f} % explained", fontsize=8,
                fontweight="bold" if k == strongest else "normal",
                color=palette.INK if k == strongest else palette.SOFT_INK,
            )  # fmt: skip
            panel.locator_params(nbins=4)
            if k == strongest:
                for side in ("left", "bottom", "top", "right"):
                    panel.spines[side].set(color=palette.INK, linewidth=1.5, visible=True)
            if k % columns == 0:
                panel.set_ylabel(label)
        hide_spare(axes, len(suspects))
    return figure


def _strength(suspect: Suspect, gap: Array) -> float:
    if suspect.strength is not None:
        return suspect.strength
    values = np.asarray(suspect.values, dtype=float)
    if np.ptp(values) == 0.0 or np.ptp(gap) == 0.0:
        return 0.0
    return float(np.corrcoef(values, gap)[0, 1] ** 2)
