"""Compliance or stiffness in a plane: ellipses at the places where they were computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import new_figure, styled
from sk120stiff.stiffness import symmetric_part

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class PlaneEllipse:
    """A compliance at a place.

    Attributes:
        centre: (3,) position, base axes [m].
        compliance: (3, 3) [m/N].
        label: Written beside the ellipse; may be empty.
        outline: (k, 3) points of the arm to draw through the plane, or None [m].
    """

    centre: Array
    compliance: Array
    label: str = ""
    outline: Array | None = None


def plane_ellipses(
    ellipses: Sequence[PlaneEllipse], *, plane: str = "xz", name: str = "compliance"
) -> Figure:
    """Displacement of the point for a force of fixed size in every direction of a plane.

    Each curve is {C f : f a unit vector of the plane}, cut to the plane; all share one scale, which
    the legend states.

    Args:
        plane: ``xy``, ``xz`` or ``yz`` of the base frame.
        name: What the compliance is called.
    """
    if plane not in ("xy", "xz", "yz") or not ellipses:
        raise InputError("give at least one ellipse, and a plane among xy, xz, yz")
    u, v = "xyz".index(plane[0]), "xyz".index(plane[1])
    pick = np.ix_([u, v], [u, v])
    centres = np.array([e.centre for e in ellipses])[:, [u, v]]
    span = _span(ellipses, centres, u, v)
    largest = max(
        float(np.max(np.abs(np.linalg.eigvalsh(symmetric_part(e.compliance)[pick]))))
        for e in ellipses
    )
    per_metre = 0.16 * span / largest  # metres drawn per m/N
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    with styled():
        from matplotlib.lines import Line2D

        figure = new_figure(5.0, width=6.0)
        panel = figure.subplots()
        for e, centre in zip(ellipses, centres, strict=True):
            if e.outline is not None:
                panel.plot(e.outline[:, u], e.outline[:, v], "-o", color=palette.NOISE,
                           linewidth=2.4, markersize=4, solid_capstyle="round")  # fmt: skip
            curve = centre[:, None] + per_metre * (symmetric_part(e.compliance)[pick] @ circle)
            panel.fill(*curve, color=palette.ENHANCED, alpha=0.35, linewidth=0)
            panel.plot(*curve, color=palette.ENHANCED, linewidth=1.6)
            panel.plot(*centre, ".", color=palette.INK, markersize=5)
            if e.label:
                panel.annotate(e.label, centre, (7, 7), textcoords="offset points", fontsize=8.5)
        panel.set_aspect("equal", adjustable="datalim")
        panel.margins(0.08)
        panel.set_xlabel(f"{plane[0]} [m]")
        panel.set_ylabel(f"{plane[1]} [m]")
        scale = f"{name} (0.1 m = {0.1 / per_metre * 1e6:.3g} µm/N)"
        panel.legend(handles=[Line2D([], [], color=palette.ENHANCED, label=scale)], loc="best")
    return figure


def _span(ellipses: Sequence[PlaneEllipse], centres: Array, u: int, v: int) -> float:
    seen = [centres] + [e.outline[:, [u, v]] for e in ellipses if e.outline is not None]
    span = float(np.max(np.ptp(np.concatenate(seen), axis=0)))
    return span if span > 0.0 else 1.0
