"""The report of `explain` where positions were read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.explain.absolute.run import Explained
from sk120stiff.identify.absolute.words import findings, unseen
from sk120stiff.measurements import Measurements
from sk120stiff.show.figures.style import new_figure, styled
from sk120stiff.show.report import (
    Items,
    KeyFigure,
    KeyFigures,
    Picture,
    Report,
    Section,
    Table,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

VERDICTS = {
    "none": "The registered arm agrees with the positions: nothing is missing that they show.",
    "named": "What was missing has names.",
    "ambiguous": "What is missing has names, some of which these positions cannot tell apart.",
    "outside": "More is left than the stated noise makes, and no effect of the catalogue explains "
    "it at poses left out.",
}


def positions_report(
    answer: Explained, readings: Measurements, *, data: str, reproducibility: Mapping[str, str]
) -> Report:
    """Gap step by step, named causes with their values, what cannot be told, what is left."""
    first, end = answer.steps[0], answer.steps[-1]
    unit, away = answer.final.problem.unit, end.heldout_distance
    figures = KeyFigures(
        [
            KeyFigure("registered", f"{1e6 * first.heldout_rms:.3g}", unit, "rms per axis"),
            KeyFigure("explained", f"{1e6 * end.heldout_rms:.3g}", unit, "at poses left out"),
            *(
                [KeyFigure("mean distance", f"{1e6 * away:.3g}", "µm", "left out")]
                if np.isfinite(away)
                else []
            ),
        ]
    )
    steps = Table(
        ("model", "fitted", "held out", "mean distance"),
        [
            (s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6, s.heldout_distance * 1e6)
            for s in answer.steps
        ],
        "The gap as one cause after the other joins, rms per axis and mean distance.",
        units=("", unit, unit, "µm"),
    )
    families = Table(
        ("family", "takes off"),
        [(name, share * 1e6) for name, share in answer.families.items()],
        "What each family of causes takes off the held-out gap beside the others.",
        units=("", unit),
    )
    named = [
        f"**{item.effect.id}** {item.effect.sentence()} P = {item.probability:.3f}; takes off "
        f"{100 * item.gain.share:.1f} % of the held-out gap beside the others."
        + (f" Not told from: {', '.join(item.alternatives)}." if item.alternatives else "")
        for item in answer.named
    ]
    return Report(
        f"Positions explained: {data}",
        [
            Section(
                "Verdict",
                [
                    figures,
                    Picture(lambda: _bars(answer), "Held-out gap after each cause"),
                    steps,
                    *([families] if answer.families else []),
                ],
            ),
            Section("Named", [Items(named or ["Nothing."])]),
            Section("Values", [_values(answer)]),
            Section(
                "What else was found",
                [
                    Items(
                        [
                            *answer.weight(),
                            *findings(answer.final, readings),
                            *answer.dropped,
                            *answer.left_over(),
                        ]
                    )
                ],
            ),
        ],
        lead=VERDICTS[answer.verdict],
        reproducibility=reproducibility,
    )


def _values(answer: Explained) -> Table:
    reasons = unseen(answer.final)
    rows: list[tuple[object, ...]] = []
    for p in answer.final.fit.parameters:
        if p.name in reasons:
            rows.append((p.name, None, None, p.spec.unit, reasons[p.name]))
        else:
            far = (
                "" if abs(p.internal) <= answer.final.problem.reach(p) else "more than is plausible"
            )
            rows.append((p.name, p.value, p.std, p.spec.unit, p.note or far))
    return Table(("parameter", "value", "±", "unit", "note"), rows, "Fitted exactly, together.")


def _bars(answer: Explained) -> Figure:
    with styled():
        figure = new_figure(0.32 * len(answer.steps) + 0.8)
        axes = figure.add_subplot()
        place = np.arange(len(answer.steps))
        axes.barh(place, [1e6 * step.heldout_rms for step in answer.steps], color="#4477aa")
        axes.set_yticks(place, [step.label for step in answer.steps], fontsize=7)
        axes.invert_yaxis()
        axes.set_xlabel(f"rms per axis at poses left out [{answer.final.problem.unit}]")
    return figure
