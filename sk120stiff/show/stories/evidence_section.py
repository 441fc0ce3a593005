"""What was named, how large it is, and what a sceptic would ask for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.effects import comment_lines
from sk120stiff.errors import listed
from sk120stiff.explain import DOUBTFUL, Explanation, Finding
from sk120stiff.explain.answer.sizes import whole_size
from sk120stiff.explain.answer.words import told_next
from sk120stiff.explain.findings import sentence_in
from sk120stiff.explain.judge.posterior import NONE
from sk120stiff.model import Parameter
from sk120stiff.show.figures.scores import score_bars
from sk120stiff.show.report import Block, Items, Note, Picture, Section, Table
from sk120stiff.show.stories.sizes_sections import estimates
from sk120stiff.show.stories.verdicts import sentence_of
from sk120stiff.show.wording import (
    chance,
    counted,
    number,
    percent,
    said_as,
    with_error,
)

CANDIDATES = 7  # rivals that are drawn
NOTHING = "none of them"
MANY = 12  # parameters of one effect beyond which a table helps nobody


def evidence_section(answer: Explanation) -> Section:
    """Every finding with its size and its evidence; for ``outside``, what came nearest."""
    if answer.verdict == "outside":
        return Section("What came nearest, and why it is not named", _outside(answer))
    if not answer.findings:
        return Section("What was looked for", _nothing(answer))
    if len(answer.findings) == 1:
        finding = answer.findings[0]
        return Section("What was found, and the evidence", _finding(answer, finding))
    parts: list[Block] = [
        Section(finding.effect.id, _finding(answer, finding)) for finding in answer.findings
    ]
    return Section("What was found, and the evidence", parts)


def _finding(answer: Explanation, finding: Finding) -> list[Block]:
    said = sentence_in(answer.final.model, finding.effect)
    blocks: list[Block] = [f"**{said}** (`{finding.effect.id}`)"]
    whole = whole_size(answer, finding)
    blocks += [sizes_of(answer, finding), *([] if whole is None else [whole.sentence])]
    blocks += [Items(list(comment_lines(finding.effect)))]
    if finding.exact:
        blocks.append(
            Note(
                "No readings of this kind can tell it from "
                f"{_or(finding.exact)}: {_sentences(answer, finding.exact)} Take the name as "
                "one of this class.",
                "caution",
                "One of several words for it",
            )
        )
    rivals = finding.others
    if rivals:
        blocks.append(
            Note(
                f"These readings cannot tell it from {_or(rivals)}: "
                f"{_sentences(answer, rivals)}{_would(answer, finding)}",
                "caution",
                "Not settled",
            )
        )
    blocks += [_scores(finding), _evidence(finding)]
    return blocks


def _would(answer: Explanation, finding: Finding) -> str:
    if answer.next_poses is None:
        return ""
    if told_next(answer, finding) or not answer.next_pairs:
        return " The readings proposed below would."
    return " The section on what to measure next says what the proposed readings would tell."


def _scores(finding: Finding) -> Picture:
    """The candidates in the effect's place, the nearest and the model without any of them."""
    evidence, own = finding.evidence, finding.effect.id
    near_by = sorted(evidence.rivals.items(), key=lambda item: item[1])[:CANDIDATES]
    behind = {own: 0.0, **dict(near_by), NOTHING: evidence.score_gain}
    told = "; ".join(f"{name} {number(value, 3)}" for name, value in behind.items())
    return Picture(
        lambda: score_bars(behind, named=[own, *finding.alternatives]),
        alt=f"Bars of the extended BIC behind the best of {len(behind)} candidates: {told}.",
        caption="How far each candidate stands behind in extended BIC, all else refitted. Violet: "
        "the name, and what these readings cannot tell from it.",
    )


def sizes_of(answer: Explanation, finding: Finding) -> Table | str:
    """Parameters of a finding with error and interval; very many are told by their size alone."""
    own = [p for p in answer.final.model.parameters if p.effect == finding.effect]
    if len(own) > MANY:
        return many_values(own)
    return estimates(
        answer.final,
        own,
        lambda p: p.spec.name,
        "Its size. An interval of a stiffness is open upwards where the readings do not exclude "
        "that this direction is rigid.",
    )


def many_values(parameters: Sequence[Parameter]) -> str:
    """Parameters of one kind that are too many for a table, told by their size."""
    values = np.array([p.value for p in parameters])
    largest = parameters[int(np.argmax(np.abs(values)))]
    size = said_as(rms(values), None, largest.spec.unit)
    return (
        f"It has {len(values)} values; their rms is {size}, the "
        f"largest is {largest.spec.name} with "
        f"{said_as(largest.value, largest.std, largest.spec.unit)}. All stand in "
        "the model file."
    )


def _evidence(finding: Finding) -> Table:
    e = finding.evidence
    c = e.confirmation
    rows: list[tuple[object, object, object]] = [
        (
            "Misfit without it",
            f"χ² larger by {e.misfit_gain:.0f}",
            "in variances of the noise, or of the misfit where that is larger; all parameters "
            "refitted",
        ),
        (
            "Score without it",
            f"extended BIC worse by {e.score_gain:.1f}",
            "6 is strong, 10 decisive; the score pays for the size of the catalogue",
        ),
    ]
    if e.runner_up is not None and math.isfinite(e.runner_up_gap):
        lost = f"{e.runner_up} loses by {e.runner_up_gap:.1f}"
        rows.append(("Runner-up", lost, "in extended BIC; below 6 it would stand beside the name"))
    else:
        rows.append(("Runner-up", "none", "no other effect comes near with a plausible size"))
    gain = with_error(c.gain, c.gain_error)
    rows += [
        (
            "Held-out poses",
            f"better in {c.folds_improved} of {c.folds} folds",
            f"misfit per axis falls by {gain} noise variances (± what the rest makes by chance)",
        ),
        (
            "Poses drawn again",
            f"same name in {percent(c.frequency)}",
            "of the resamplings of all poses with replacement",
        ),
    ]
    return Table(["question", "answer", "meaning"], rows, "Evidence for the name.")


def _nothing(answer: Explanation) -> list[Block]:
    looked = len({item.name.rpartition(".")[0] for item in answer.smallest_detectable})
    left = answer.adequacy
    odds = answer.odds
    behind = {
        NOTHING if name == NONE else name: -2.0 * math.log(share / max(odds.values()))
        for name, share in odds.items()
        if share > 0.0
    }
    blocks: list[Block] = [
        f"All effects of the catalogue at all places where they can act ({looked}) were tried, "
        "alone and together, with the springs refitted beside them. None improves the model by "
        "more than chance, on the fitted poses and on poses left out.",
    ]
    if len(behind) > 1:
        told = "; ".join(f"{name} {number(value, 3)}" for name, value in behind.items())
        blocks.append(
            Picture(
                lambda: score_bars(behind, named=[NOTHING]),
                alt=f"Bars of the extended BIC behind the best, one effect more: {told}.",
                caption="One effect more, each tried alone: how far it stands behind in extended "
                "BIC. Violet: the model as it is.",
            )
        )
    if left.chance is not None and left.understated is None and left.chance < DOUBTFUL:
        blocks.append(
            Note(
                f"The test of what is left gives p = {chance(left.chance)}. That is not enough to "
                "claim that something is missing, and not little enough to be sure that nothing "
                "is: more poses would settle it.",
                "caution",
                "Not beyond doubt",
            )
        )
    return blocks


def _outside(answer: Explanation) -> list[Block]:
    left = answer.adequacy
    test = min(left.tests, key=left.tests.__getitem__, default="")
    blocks: list[Block] = [
        f"What the best models of the catalogue leave over is beyond noise, most clearly in the "
        f"test '{test}' ({left.excess:.1f} noise standard deviations in all, where what they "
        f"explain amounts to {left.explained:.1f}).",
    ]
    if answer.suspects:
        rows = [
            (each.id, sentence_of(answer, each.id), f"{1e6 * each.heldout_gain:.3g}")
            for each in answer.suspects
        ]
        heads = ["effect", "what it would mean", "held-out gap falls by [µm]"]
        blocks.append(Table(heads, rows, "Nearest, and not confirmed."))
    blocks.append(
        f"The section before tells where the gap lives. {counted(len(answer.suspects), 'name')} "
        "stood nearest; take them as hints at the place, not as causes."
        if answer.suspects
        else "No effect came near. The section before tells where the gap lives."
    )
    return blocks


def _or(names: tuple[str, ...]) -> str:
    return listed([f"`{name}`" for name in names], "or")


def _sentences(answer: Explanation, names: tuple[str, ...]) -> str:
    return " ".join(sentence_of(answer, name) for name in names)
