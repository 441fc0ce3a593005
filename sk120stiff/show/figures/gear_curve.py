"""Twist of a gear against its torque: the found curve with its band, readings, the plain law."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Index, Mask
from sk120stiff.explain.judge.gear_curve import GearCurve
from sk120stiff.show import palette
from sk120stiff.show.figures.style import styled, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIMIT = 1.6  # of the curve's own range: readings beyond it are not drawn
SAME = 1e-3  # of the curve's range: ways that lie closer are drawn once


def gear_curve(curve: GearCurve) -> Figure:
    """Draw one gear: the whole twist, and what it is beyond its straight spring."""
    with styled():
        figure, axes = subplots(1, 2, height=3.5)
        titles = ("twist", "beyond the straight spring")
        springs = (0.0, curve.compliance)
        for panel, spring, title in zip(axes, springs, titles, strict=True):
            _draw(panel, curve, spring)
            out, whole = left_out(curve, spring), len(curve.measured)
            panel.set_title(f"{title} ({out} of {whole} readings lie outside)" if out else title,
                            fontsize=8.0 if out else None)  # fmt: skip
        axes[0].set_ylabel("twist [µrad]")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def left_out(curve: GearCurve, spring: float) -> int:
    """How many readings are not drawn, a spring of this compliance [rad/(N·m)] taken off."""
    return int((~_near(curve, spring)).sum())


def _near(curve: GearCurve, spring: float) -> Mask:
    """(M,) bool: which readings lie within the range that is drawn."""
    reach = LIMIT * np.abs(curve.twist - spring * curve.torque).max(initial=0.0)
    off = np.abs(curve.measured[:, 1] - spring * curve.measured[:, 0])
    return np.asarray(off < reach)


def ways(curve: GearCurve) -> list[Index]:
    """Indices of the curve, cut where its torque turns round; what was gone before is left out.

    A band is filled between two lines over a torque that grows or falls throughout: round the whole
    bench the polygon would go over itself, and what it goes over twice both ways is not filled.
    """
    torque = curve.torque
    turns = np.flatnonzero(np.diff(np.sign(np.diff(torque)))) + 1
    ends = [0, *turns, len(torque) - 1]
    parts = [np.arange(a, b + 1) for a, b in pairwise(ends)]
    kept: list[Index] = []
    for part in sorted(parts, key=lambda part: -np.ptp(torque[part])):
        if not any(_covers(curve, other, part) for other in kept):
            kept.append(part)
    return kept


def _covers(curve: GearCurve, one: Index, other: Index) -> bool:
    """Does the curve go the other way as it went the one?"""
    order = one[np.argsort(curve.torque[one])]
    at = curve.torque[other]
    if at.min() < curve.torque[one].min() or at.max() > curve.torque[one].max():
        return False
    twist = np.interp(at, curve.torque[order], curve.twist[order])
    near = SAME * np.abs(curve.twist).max(initial=0.0)
    return bool((np.abs(twist - curve.twist[other]) <= near).all())


def _draw(panel: Axes, curve: GearCurve, spring: float) -> None:
    torque, straight = curve.torque, spring * curve.torque
    found = 1e6 * (curve.twist - straight)
    if curve.band is not None:
        band = 1e6 * curve.band
        for k, way in enumerate(ways(curve)):
            panel.fill_between(
                torque[way], (found - band)[way], (found + band)[way],
                color=palette.PREDICTED, alpha=0.25, linewidth=0.0,
                label="_band" if k else "95 % band",
            )  # fmt: skip
    x = curve.measured[:, 0]
    y = 1e6 * (curve.measured[:, 1] - spring * x)
    near = _near(curve, spring)
    panel.plot(x[near], y[near], "o", color=palette.MEASURED, markersize=2.6, alpha=0.6,
               markeredgewidth=0, label="readings")  # fmt: skip
    panel.plot(torque, 1e6 * (curve.ideal - straight), "--", color=palette.INK, linewidth=1.1,
               label="plain law")  # fmt: skip
    panel.plot(torque, found, color=palette.PREDICTED, label="found")
    panel.axhline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    panel.axvline(0.0, color=palette.SOFT_INK, linewidth=0.7)
    panel.set_xlabel("torque of the joint [N·m]")
