"""The report of `explain`: a manager reads its first lines, a metrologist checks the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

from sk120stiff.errors import listed
from sk120stiff.explain import DOUBTFUL, Explanation
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.words import noise_words
from sk120stiff.explain.findings import likely, sentence_in
from sk120stiff.measurements import Measurements
from sk120stiff.show.report import (
    Block,
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Report,
    Section,
    fragment,
    section_or_note,
)
from sk120stiff.show.stories.evidence_section import evidence_section, sizes_of
from sk120stiff.show.stories.gap_section import gap_section, steps_table
from sk120stiff.show.stories.limits_section import blind_section, left_section, next_section
from sk120stiff.show.stories.probability_section import probability_section
from sk120stiff.show.stories.sizes_sections import budget_section, gear_section, parameters_section
from sk120stiff.show.stories.verdicts import FEW, lead_of, title_of
from sk120stiff.show.stories.where_section import where_section
from sk120stiff.show.wording import chance, counted, percent, um

CROSS = "on poses left out in turn (cross-validation by pose)"


def explain_report(
    answer: Explanation,
    readings: Measurements,
    *,
    data: str = "",
    heldout: str = CROSS,
    scene: str = "",
    scene_link: str = "",
    next_poses: str = "",
    reproducibility: Mapping[str, str] | None = None,
) -> Report:
    """Tell an explanation as a report.

    Args:
        answer: The explanation.
        readings: The measurements that were explained.
        data: What they are called.
        heldout: What the held-out gap was taken on, in words.
        scene: Text of the page of the 3-D scene, shown inside the report; empty for none.
        scene_link, next_poses: Relative addresses of files that lie beside the report; empty where
            there are none.
        reproducibility: Name → text, shown last.
    """
    told: dict[str, Callable[[], Section | None]] = {
        "The answer": lambda: _answer(answer),
        "The gap, step by step": lambda: gap_section(
            answer, heldout=heldout, scene=scene, scene_link=scene_link
        ),
        "Where it lives": lambda: where_section(answer),
        "The evidence": lambda: evidence_section(answer),
        "How probable it is": lambda: probability_section(answer),
        "The curve of the gear": lambda: gear_section(answer),
        "Parameters": lambda: parameters_section(answer),
        "What moves the point": lambda: budget_section(answer),
        "What is left, and the noise": lambda: left_section(answer, readings),
        "What these readings cannot show": lambda: blind_section(answer),
        "What to measure next": lambda: next_section(answer, next_poses),
    }
    sections = [section_or_note(title, build) for title, build in told.items()]
    used = readings.masked()
    robot = answer.base.model.robot.name
    counts = f"{counted(used.n_readings, 'reading')} at {counted(len(used.poses), 'pose')}"
    return Report(
        title=title_of(answer),
        subtitle=f"{robot}, {counts}" + (f", `{data}`" if data else ""),
        lead=lead_of(answer),
        sections=[section for section in sections if section is not None],
        reproducibility=reproducibility or {},
    )


def summary_html(answer: Explanation) -> str:
    """The answer, the sizes of what was named, the gap and where it lives, as a notebook shows it.

    A fragment of HTML without scripts and pictures; every text in it is escaped.
    """
    told = _answer(answer).blocks
    sizes = [sizes_of(answer, finding) for finding in answer.findings]
    first = 0 if answer.findings else 1  # the answer begins with it then
    where = Items([*answer.notes, *answer.unnamed, *answer.where[first:]])
    blocks = [lead_of(answer), *told, *sizes, steps_table(answer), where]
    return fragment(Section(title_of(answer), blocks))


def _answer(answer: Explanation) -> Section:
    blocks: list[Block] = [key_figures(answer)]
    if answer.findings:
        blocks.append(Items([_line(answer, k) for k in range(len(answer.findings))], ordered=True))
    elif answer.where:
        blocks.append(answer.where[0])
    blocks.append(Note(next_step(answer), "note", "What to do now"))
    blocks += [Note(reason, "note", "About the noise") for reason in noise_words(answer)]
    return Section("The answer", blocks)


def _line(answer: Explanation, k: int) -> str:
    finding = answer.findings[k]
    pairs = pairwise(answer.steps)
    before, step = next(pair for pair in pairs if finding.effect.id in pair[1].joined)
    beside = [f"`{name}`" for name in step.joined if name != finding.effect.id]
    c = finding.evidence.confirmation
    rivals = [f"`{name}`" for name in finding.alternatives]
    if len(rivals) > FEW + 1:
        rivals = [*rivals[:FEW], counted(len(rivals) - FEW, "other")]
    alternatives = f", or {listed(rivals, 'or')}" if rivals else ""
    return (
        f"{sentence_in(answer.final.model, finding.effect)} (`{finding.effect.id}`{alternatives}) "
        f"{likely(finding.probability)}{' together' if rivals else ''}. Held-out gap "
        f"{um(before.heldout_rms)} → {um(step.heldout_rms)} µm"
        f"{f' together with {listed(beside)}' if beside else ''}; better in {c.folds_improved} of "
        f"{c.folds} folds; same name in {percent(c.frequency)} of resamplings."
    )


def key_figures(answer: Explanation) -> KeyFigures:
    """The numbers that matter: gap, noise, names, what is left."""
    first, last = answer.steps[0], answer.steps[-1]
    floor = answer.noise_floor
    changed = bool(answer.findings)
    gap = KeyFigure(
        "gap, held out",
        um(last.heldout_rms),
        "µm",
        f"was {um(first.heldout_rms)} µm" if changed else "rms per axis, poses left out of the fit",
    )
    noise = KeyFigure(
        "noise alone",
        "?" if floor is None else um(floor),
        "" if floor is None else "µm",
        "unknown" if floor is None else f"by {answer.yardstick.name}",
    )
    closed = KeyFigure(
        "closed",
        percent(1.0 - last.heldout_rms / first.heldout_rms) if changed else "–",
        "",
        "of the held-out gap",
    )
    left = KeyFigure("left beyond noise", *_left(answer))
    figures = [gap, noise, closed, left] if changed else [gap, noise, left]
    return KeyFigures(figures)


def _left(answer: Explanation) -> tuple[str, str, str]:
    """What is left beyond noise: word or size, unit, and the probability that noise makes it."""
    left = answer.adequacy
    if left.chance is None:
        if answer.remainder.significant:
            return um(answer.remainder.rms), "µm", "rms per axis; the noise is unknown"
        return "?", "", "the noise is unknown"
    if left.understated is not None:
        return f"{left.understated:.2f}", "σ", "as stated, which looks too small"
    said = chance(left.chance)
    said = f"p {said}" if said.startswith("<") else f"p = {said}"
    if left.lacking and answer.remainder.significant:
        return f"{um(answer.remainder.rms)}", "µm", f"rms per axis; noise alone: {said}"
    doubtful = "not sure" if left.chance < DOUBTFUL else "no"
    return "yes" if left.lacking else doubtful, "", said
