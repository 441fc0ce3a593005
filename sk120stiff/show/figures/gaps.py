"""The gap between measurement and model: per pose, and as the model grows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.errors import InputError
from sk120stiff.show import palette
from sk120stiff.show.figures.style import new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from sk120stiff.explain.findings import Step


def gap_per_pose(
    poses: Sequence[str],
    gaps: Mapping[str, ArrayLike],
    *,
    noise_floor: float | None = None,
) -> Figure:
    """Root-mean-square gap of each pose, one bar per model.

    Args:
        poses: Labels of the poses.
        gaps: Model name → (poses,) gap [m], in the order before, after, ...
        noise_floor: What the noise alone would leave [m].
    """
    count = len(poses)
    series = {name: 1e6 * np.asarray(values, dtype=float) for name, values in gaps.items()}
    for name, values in series.items():
        if values.shape != (count,):
            raise InputError(f"model {name!r} has {values.size} gaps for {count} poses")
    with styled():
        figure = new_figure(2.9, width=max(4.2, min(7.2, 1.8 + 0.34 * count * (1 + len(series)))))
        panel = figure.subplots()
        width = 0.8 / max(1, len(series))
        place = np.arange(count)
        for k, ((name, values), shade) in enumerate(
            zip(series.items(), palette.steps(len(series)), strict=True)
        ):
            bars = panel.bar(
                place + (k - 0.5 * (len(series) - 1)) * width, values, 0.92 * width,
                color=shade, label=name, zorder=2,
            )  # fmt: skip
            if count * len(series) <= 14:
                panel.bar_label(bars, fmt=_short, fontsize=7.5, padding=2)
        _floor(panel, noise_floor)
        panel.set_xticks(place, poses, rotation=0 if count <= 12 else 90)
        panel.set_xlabel("pose")
        panel.set_ylabel("rms gap [µm]")
        panel.grid(visible=False, axis="x")
        panel.margins(y=0.14)
        figure.legend(loc="outside lower center", ncols=4)
    return figure


def gap_waterfall(
    steps: Sequence[Step],
    *,
    noise_floor: float | None = None,
    unit: str = "µm",
) -> Figure:
    """How the gap falls as effects are added; points are poses that the fit never saw."""
    if not steps:
        raise InputError("no model to draw")
    fit = 1e6 * np.array([step.fit_rms for step in steps])
    held = 1e6 * np.array([step.heldout_rms for step in steps])
    with styled():
        figure = new_figure(1.15 + 0.42 * len(steps))
        panel = figure.subplots()
        rows = np.arange(len(steps))
        farthest = 1.28 * float(np.nanmax([*fit, *held]))
        for k in range(len(steps)):
            start = fit[k - 1] if k else fit[0]
            if k and start > fit[k]:
                panel.barh(k, start - fit[k], left=fit[k], height=0.56, color=palette.RULE,
                           zorder=2)  # fmt: skip
            last = k == len(steps) - 1
            panel.barh(k, fit[k], height=0.56, zorder=2,
                       color=palette.GAP if last else palette.BEFORE)  # fmt: skip
            saved = f"  (−{_short(start - fit[k])})" if k and start > fit[k] else ""
            inside = fit[k] > 0.3 * farthest
            edge = fit[k] if inside else np.nanmax([fit[k], start, held[k]])
            panel.annotate(
                f"{_short(fit[k])} {unit}{saved}", (edge, k), (-7 if inside else 8, 0),
                textcoords="offset points", ha="right" if inside else "left", va="center",
                fontsize=8.5, color=palette.PAPER if inside and last else palette.INK, zorder=5,
            )  # fmt: skip
        if np.isfinite(held).any():
            panel.plot(held, rows, "D", color=palette.PAPER, markeredgecolor=palette.INK,
                       markersize=7, label="held-out poses", zorder=4)  # fmt: skip
        _floor(panel, noise_floor, vertical=True, unit=unit)
        panel.set_yticks(rows, [step.label for step in steps])
        panel.invert_yaxis()
        panel.set_xlim(0.0, farthest)
        panel.set_xlabel(f"rms gap [{unit}]")
        panel.grid(visible=False, axis="y")
        panel.tick_params(axis="y", length=0)
        if panel.get_legend_handles_labels()[0]:
            figure.legend(loc="outside lower center", ncols=3)
    return figure


def _floor(
    panel: Axes, noise_floor: float | None, *, vertical: bool = False, unit: str = "µm"
) -> None:
    if noise_floor is None:
        return
    draw = panel.axvline if vertical else panel.axhline
    draw(
        1e6 * noise_floor, color=palette.INK, linestyle="--", linewidth=1.3, zorder=3,
        label=f"noise floor {_short(1e6 * noise_floor)} {unit}",
    )  # fmt: skip


def _short(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
