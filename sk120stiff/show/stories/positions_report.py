"""The report of `explain` where positions were read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.explain.findings import likely, sentence_in
from sk120stiff.explain.positions.answer.explained import Explained, Named
from sk120stiff.explain.positions.answer.next_step import headline, next_step_of_positions
from sk120stiff.identify.positions.words import findings, unseen
from sk120stiff.show.figures import gap_waterfall
from sk120stiff.show.figures.budget import budget_bars
from sk120stiff.show.report import (
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    Report,
    Section,
    Table,
)
from sk120stiff.show.stories.positions_pictures import arm_at_poses, pictures_of_poses
from sk120stiff.show.stories.sizes_sections import budget_section
from sk120stiff.show.wording import said_in, um, with_error


def positions_report(
    answer: Explained,
    *,
    data: str,
    reproducibility: Mapping[str, str],
    scene: str = "",
    scene_link: str = "",
) -> Report:
    """Gap step by step, named causes with their values, what cannot be told, what is left.

    Args:
        answer: What was found.
        data: Name of the measurements' file.
        reproducibility: What the page was made of.
        scene, scene_link: Text of the scene's page, and its address beside the report.
    """
    first, end = answer.steps[0], answer.steps[-1]
    unit, away = answer.final.problem.unit, end.heldout_distance
    size, before = _size(answer), first.label if answer.displaced else "registered"
    figures = KeyFigures(
        [
            KeyFigure(before, um(first.heldout_rms), unit, size),
            KeyFigure("explained", um(end.heldout_rms), unit, "at poses left out"),
            *(
                [KeyFigure("mean distance", um(away), "µm", "left out")]
                if np.isfinite(away)
                else []
            ),
        ]
    )
    shown = 3 + bool(np.isfinite(away))
    steps = Table(
        ("model", "fitted", "held out", "mean distance")[:shown],
        [
            (s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6, s.heldout_distance * 1e6)[:shown]
            for s in answer.steps
        ],
        f"The gap as one cause after the other joins, {size}"
        + (" and mean distance." if shown > 3 else "."),
        units=("", unit, unit, "µm")[:shown],
    )
    families = Table(
        ("family", "takes off"),
        [(name, share * 1e6) for name, share in answer.families.items()],
        "What each family of causes takes off the held-out gap beside the others.",
        units=("", unit),
    )
    named = [
        f"{sentence_in(answer.final.model, item.effect)} (`{item.effect.id}`) "
        f"{answer.chance_of(item)}; {answer.taken_off(item, ' of the held-out gap')}."
        + "".join(f" {said}" for said in answer.only_together(item))
        + _not_told(answer, item)
        + (f" By no pose told from: {_likely(answer, item.untold)}." if item.untold else "")
        + (f" Always the same in such readings: {_likely(answer, item.same)}." if item.same else "")
        for item in answer.findings
    ]
    held = [] if answer.heldout is None else [answer.heldout.sentence(answer.final.problem)]
    where = "loads" if answer.displaced else "poses"
    moves = budget_section(answer, f"at the measured {where}")
    return Report(
        f"{'Displacements' if answer.displaced else 'Positions'} explained: {data}",
        [
            Section(
                "The answer",
                [
                    figures,
                    Items(named or ["No cause is named."], ordered=bool(named)),
                    *map(Note, (*answer.sums(), *answer.shares())),
                    Note(next_step_of_positions(answer), "note", "What to do now"),
                ],
            ),
            Section(
                "The gap, step by step",
                [
                    _steps(answer),
                    steps,
                    *map(Note, [*held, *answer.not_counted()]),
                    *pictures_of_poses(answer),
                    *arm_at_poses(answer, scene, scene_link),
                ],
            ),
            *([_budget(answer, families)] if len(answer.families) > 1 else []),
            *([moves] if moves is not None else []),
            Section("Values", [_values(answer)]),
            Section(
                "What else was found",
                [
                    Items(
                        [
                            *answer.weight(),
                            *findings(answer.final, answer.readings),
                            *answer.dropped,
                            *answer.limits,
                            *answer.left_over(),
                        ]
                    )
                ],
            ),
        ],
        lead=headline(answer),
        reproducibility=reproducibility,
    )


def _not_told(answer: Explained, item: Named) -> str:
    """What other poses could tell from a name; what is hardly likely is counted."""
    worth, faint = answer.rivals_of(item)
    told = _each_likely(answer, [name for name in worth if name in item.others])
    told += [f"{len(faint)} others, each with {likely(0.0)}"] if faint else []
    return f" Not told from: {listed(told)}." if told else ""


def _each_likely(answer: Explained, names: Sequence[str]) -> list[str]:
    return [f"{name} ({likely(answer.probabilities.get(name, 0.0))})" for name in names]


def _likely(answer: Explained, names: Sequence[str]) -> str:
    """Names with how probable each of them is."""
    return ", ".join(_each_likely(answer, names))


def _size(answer: Explained) -> str:
    """rms, per axis where every reading has axes."""
    problem = answer.final.problem
    return problem.rms_unit.removeprefix(f"{problem.unit} ")


def _values(answer: Explained) -> Table:
    reasons = unseen(answer.final)
    rows: list[tuple[object, ...]] = []
    for p in answer.final.parameters:
        factor, unit = said_in(p.spec.unit, p.value)
        if p.name in reasons:
            rows.append((p.name, None, unit, reasons[p.name]))
        else:
            far = (
                "" if abs(p.internal) <= answer.final.problem.reach(p) else "more than is plausible"
            )
            std = None if p.std is None else factor * p.std
            rows.append((p.name, with_error(factor * p.value, std), unit, p.note or far))
    header = ("parameter", "value ± standard error", "unit", "note")
    return Table(header, rows, "Fitted exactly, together.")


def _steps(answer: Explained) -> Picture:
    """The gap falling from cause to cause, as in every report."""
    first, end, unit = answer.steps[0], answer.steps[-1], answer.final.problem.unit
    stated = answer.final.problem.stated_sigma
    return Picture(
        lambda: gap_waterfall(answer.steps, noise_floor=stated, unit=unit),
        alt=f"Bars of the gap of {len(answer.steps)} models; held out from {um(first.heldout_rms)} "
        f"to {um(end.heldout_rms)} {answer.final.problem.rms_unit}.",
        caption="Bars: readings that were fitted. Diamonds: poses left out."
        + ("" if stated is None else " Dashed: the stated noise."),
    )


def _budget(answer: Explained, table: Table) -> Section:
    """What every family brings, as a picture and a table."""
    unit = answer.final.problem.unit
    sizes = {name: 1e6 * share for name, share in answer.families.items()}
    return Section(
        "What takes the gap off",
        [
            Picture(
                lambda: budget_bars(
                    list(sizes), np.array(list(sizes.values())), np.zeros(len(sizes)),
                    label=f"{answer.final.problem.rms_unit} at poses left out", named=list(sizes),
                ),
                alt="Bars: " + "; ".join(f"{n} {size:.3g} {unit}" for n, size in sizes.items()),
            ),
            table,
        ],
    )  # fmt: skip
