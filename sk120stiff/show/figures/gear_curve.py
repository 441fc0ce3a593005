"""Twist of a gear against its torque: the found curve with its band, readings, the plain law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.explain.judge.gear_curve import GearCurve
from sk120stiff.show import palette
from sk120stiff.show.figures.style import styled, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIMIT = 1.6  # of the curve's own range: readings beyond it are not drawn


def gear_curve(curve: GearCurve) -> Figure:
    """Draw one gear: the whole twist, and what it is beyond its straight spring."""
    with styled():
        figure, axes = subplots(1, 2, height=3.5)
        for panel, spring in zip(axes, (0.0, curve.compliance), strict=True):
            _draw(panel, curve, spring)
        axes[0].set_title("twist")
        axes[1].set_title("beyond the straight spring")
        axes[0].set_ylabel("twist [µrad]")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _draw(panel: Axes, curve: GearCurve, spring: float) -> None:
    torque, straight = curve.torque, spring * curve.torque
    found = 1e6 * (curve.twist - straight)
    if curve.band is not None:
        band = 1e6 * curve.band
        panel.fill(
            np.concatenate([torque, torque[::-1]]), np.concatenate([found + band,
                                                                    (found - band)[::-1]]),
            color=palette.PREDICTED, alpha=0.25, linewidth=0.0, label="95 % band",
        )  # fmt: skip
    x = curve.measured[:, 0]
    y = 1e6 * (curve.measured[:, 1] - spring * x)
    near = np.abs(y) < LIMIT * np.abs(found).max(initial=0.0)
    panel.plot(x[near], y[near], "o", color=palette.MEASURED, markersize=2.6, alpha=0.6,
               markeredgewidth=0, label="readings")  # fmt: skip
    panel.plot(torque, 1e6 * (curve.ideal - straight), "--", color=palette.INK, linewidth=1.1,
               label="plain law")  # fmt: skip
    panel.plot(torque, found, color=palette.PREDICTED, label="found")
    panel.axhline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    panel.axvline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    panel.set_xlabel("torque of the joint [N·m]")
