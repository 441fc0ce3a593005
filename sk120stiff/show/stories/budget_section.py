"""The error budget: what moves the point at the measured loads, joint by joint."""

from __future__ import annotations

import numpy as np

from sk120stiff.explain import Explanation
from sk120stiff.show.figures.budget import budget_bars
from sk120stiff.show.report import Picture, Section, Table
from sk120stiff.show.wording import um

SHOWN = 14  # shares that are drawn
SMALL = 1e-3  # of the largest share: too small to draw


def budget_section(answer: Explanation) -> Section | None:
    """Bars and a table of the shares; None where nothing moves."""
    largest = max((share.rms for share in answer.budget), default=0.0)
    shares = [share for share in answer.budget if share.rms > SMALL * largest]
    if not shares:
        return None
    drawn = shares[:SHOWN]
    told = ", ".join(f"{share.name} {um(share.rms)} µm" for share in drawn)
    return Section(
        "What moves the point",
        [
            "Sizes at the measured loads. The parts add as vectors: they need not add up, and "
            "where two effects are alike, what one has the other may.",
            Picture(
                lambda: budget_bars(
                    [share.name for share in drawn],
                    np.array([1e6 * share.rms for share in drawn]),
                    np.array([1e6 * (share.std or 0.0) for share in drawn]),
                    named=[finding.effect.id for finding in answer.findings],
                ),
                alt=f"Bars of {len(drawn)} shares: {told}.",
                caption="What each effect moves the point by. Violet: what was named.",
            ),
            Table(
                ["what yields", "moves", "±"],
                [(s.name, 1e6 * s.rms, "" if s.std is None else 1e6 * s.std) for s in shares],
                "Rms per axis at the measured loads, with its standard error.",
                units=["", "µm", "µm"],
                digits=3,
            ),
        ],
    )
