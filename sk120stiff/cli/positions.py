"""What `explain` answers where readings say where markers stand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.shares import budget_tables_of
from sk120stiff.cli.tables import table
from sk120stiff.cli.values import sure_values, value_lines
from sk120stiff.effects import LinearElastic
from sk120stiff.errors import listed, micro
from sk120stiff.explain import Explained
from sk120stiff.explain.answer.verdict import BEST_GUESS
from sk120stiff.explain.findings import likely, sentence_in
from sk120stiff.explain.positions.answer.next_step import headline, next_step_of_positions
from sk120stiff.identify.positions.words import findings, unseen
from sk120stiff.model import Model, base_model

FEW = 4  # parameters of one effect beyond which only those that are surely not zero are printed


def positions_answer(answer: Explained, document: Mapping[str, object], out: Path) -> Answer:
    """What was found, and how far readings that were kept out are off."""
    parts = _parts(answer, out)
    if answer.heldout is not None:
        parts.append(answer.heldout.sentence(answer.final.problem))
    return Answer(document, parts)


def yielding(model: Model) -> Model:
    """The model, or plain springs where nothing in it yields: a scene needs something that does."""
    soft = any(isinstance(p.effect, LinearElastic) and p.internal > 0.0 for p in model.parameters)
    return model if soft else base_model(model.robot)


def _parts(answer: Explained, out: Path) -> list[object]:
    shown: list[object] = [headline(answer), *answer.limits]
    hidden = unseen(answer.final)
    for item in answer.findings:
        shown.append(
            f"{sentence_in(answer.final.model, item.effect)} [{item.effect.id}] "
            f"({answer.chance_of(item)}, {answer.taken_off(item)})"
        )
        worth, faint = answer.rivals_of(item)
        shown += [f"  or {other} ({answer.rival(item, other)})" for other in worth]
        if faint:
            shown.append(f"  or, each with {likely(0.0)} here: {listed(faint, 'or')}")
        own = [p for p in answer.final.model.parameters if p.effect == item.effect]
        shown += value_lines(own, hidden) if len(own) <= FEW else sure_values(own, hidden)
        shown += [f"  {said}" for said in answer.only_together(item)]
    shown += (*answer.sums(), *answer.shares())
    whole = np.isfinite(answer.steps[-1].heldout_distance)
    rows = [
        (s.label, s.fit_rms * 1e6, s.heldout_rms * 1e6, s.heldout_distance * 1e6)[: 3 + whole]
        for s in answer.steps
    ]
    columns = ["model", "fitted", "held out", "mean distance"][: 3 + whole]
    unit = answer.final.problem.unit
    size = answer.final.problem.rms_unit.removeprefix(f"{unit} ")
    title = f"Gap [{unit}], {size}" + (" and mean distance held out" if whole else "")
    shown.append(table(title, columns, rows))
    shown += answer.not_counted()
    if answer.families:
        told = ", ".join(f"{name} {micro(share)}" for name, share in answer.families.items())
        shown.append(f"What each takes off beside the others [{unit}]: {told}.")
    at = "At the measured loads" if answer.displaced else "At the measured poses"
    shown += budget_tables_of(
        at, "µm rms per axis", answer.budget, answer.joints_budget, cause="cause"
    )
    shown += answer.weight()
    shown += findings(answer.final, answer.readings)
    shown += answer.dropped
    shown += answer.left_over()
    if answer.guess is not None:
        shown.append(f"The best guess stands in {out / BEST_GUESS}; it is not confirmed.")
    shown.append(f"What to do now: {next_step_of_positions(answer)}")
    shown.append(f"Results are in {out}.")
    return shown
