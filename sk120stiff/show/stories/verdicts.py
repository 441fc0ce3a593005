"""The answer in a sentence or two that someone who signs for a machine understands."""

from __future__ import annotations

import math

from sk120stiff.errors import listed
from sk120stiff.explain import DOUBTFUL, Explanation
from sk120stiff.explain.answer.probabilities import EVEN, nothing, unsettled
from sk120stiff.explain.answer.words import accounted, mostly_accounted
from sk120stiff.explain.findings import likely, sentence_in
from sk120stiff.explain.localise.changes import changed_at
from sk120stiff.show.wording import chance, counted, um

FEW_POSES = 8  # below this other poses confirm little
LITTLE = 0.33  # of the noise: a remainder that changes no reading by as much as its error
FEW = 2  # rivals that are told in the first lines; the evidence lists all


def title_of(answer: Explanation) -> str:
    """Heading of the report."""
    return {
        "none": _title_of_none(answer),
        "named": "Why model and measurement disagree",
        "ambiguous": "Why model and measurement disagree: more than one name fits",
        "outside": "Model and measurement disagree, and no cause is confirmed",
    }[answer.verdict]


def _title_of_none(answer: Explanation) -> str:
    left = answer.adequacy
    if left.understated is not None:
        return "Nothing structured is missing, but σ looks too small"
    unsure = nothing(answer) < EVEN
    if answer.noise_floor is None or unsure or (left.chance or 1.0) < DOUBTFUL:
        return "No effect can be named"
    return "Model and measurement agree"


def lead_of(answer: Explanation) -> str:
    """The answer, and by how much the gap shrank."""
    return {"none": _none, "named": _named, "ambiguous": _ambiguous, "outside": _outside}[
        answer.verdict
    ](answer)


def _none(answer: Explanation) -> str:
    step, left = answer.steps[0], answer.adequacy
    misses = f"The model misses the readings by {um(step.fit_rms)} µm rms per axis"
    if answer.noise_floor is None:
        return (
            f"No effect can be named. {misses}; the noise is unknown, so whether something is "
            "missing stays open."
        )
    makes = f"the noise alone makes {um(answer.noise_floor)} µm"
    if left.understated is not None:
        return (
            f"Nothing structured is missing that these readings could show. {misses}; {makes} as "
            f"it was stated, and that looks {left.understated:.2f} times too small."
        )
    if left.chance is not None and left.chance < DOUBTFUL:
        return (
            f"No effect can be named. {misses}, a little more than the noise: {makes} (p = "
            f"{chance(left.chance)}). That is not enough to claim that something is missing."
        )
    if nothing(answer) < EVEN:
        return (
            f"No effect can be named, and that nothing is missing is not sure: "
            f"{unsettled(answer)}. {misses}; {makes}."
        )
    return f"Nothing is missing that these readings could show. {misses}; {makes}."


def _named(answer: Explanation) -> str:
    said = " ".join(sentence_in(answer.final.model, finding.effect) for finding in answer.findings)
    return f"{said} {shrinks(answer)}"


def _ambiguous(answer: Explanation) -> str:
    settled = [sentence_in(answer.final.model, f.effect) for f in answer.findings if f.settled]
    open_ = [f for f in answer.findings if not f.settled]
    said = " ".join(settled)
    for finding in open_:
        names = {name: sentence_of(answer, name) for name in finding.others}
        names[finding.effect.id] = sentence_in(answer.final.model, finding.effect)
        # the likeliest first, and the one that stands in the model before its equals
        own = (finding.effect.id, *finding.others)
        order = sorted(own, key=lambda name: -finding.evidence.odds.get(name, 0.0))
        first, *rivals = (names[name] for name in order)
        said += f" {first}"
        if not rivals:
            said += f" That is not sure ({likely(finding.probability, 'probability')})."
            continue
        said += f" Or: {' Or: '.join(rivals[:FEW])}"
        if len(rivals) > FEW:
            said += f" Or one of {counted(len(rivals) - FEW, 'other')}."
    several = any(finding.others for finding in open_)
    tail = " These readings cannot tell which." if several else " More readings would tell."
    if answer.next_poses is not None:
        told = all(pair.settled for pair in answer.next_pairs)
        would = "would" if told else "would tell part of it"
        tail += f" {counted(len(answer.next_poses[0]), 'further reading')} {would}."
    return f"{said.strip()}{tail} {shrinks(answer)}"


def _outside(answer: Explanation) -> str:
    step = answer.steps[0]
    if answer.adequacy.undecided:
        return (
            "More is left than the stated noise makes, and nothing tells whether the readings are "
            "noisier than stated or something is missing: it has no structure. The model misses "
            f"the readings by {um(step.fit_rms)} µm rms per axis; {noise_makes(answer)}."
        )
    place = accounted(answer) or mostly_accounted(answer) or ""
    why = "no effect of the catalogue explains it"
    borne_out = answer.remainder.goes_with is not None and answer.remainder.goes_with.borne_out
    if (since := changed_at(place)) and borne_out:
        why = f"it came before pose {since}: the gap goes with {place}"
    elif answer.unnamed:
        why = "no name for it is confirmed by other poses"
        poses = len(answer.base.problem.load_cases.poses)
        if poses < FEW_POSES:
            why += f" ({poses} poses are few: measure at more)"
    elif answer.limits:
        why = "no effect that was looked for explains it"
    return (
        f"Something is missing, and {why}. The model misses the "
        f"readings by {um(step.fit_rms)} µm rms per axis; "
        f"{noise_makes(answer)}.{_little(answer)} Where it lives is told below."
    )


def _little(answer: Explanation) -> str:
    """That what is left is small beside the noise, where many readings show it all the same."""
    left, floor = answer.remainder, answer.noise_floor
    if floor is None or not left.significant or left.interval[1] > LITTLE * floor:
        return ""
    return (
        f" What is left beyond it is little, {um(left.rms)} µm (95 %: up to "
        f"{um(left.interval[1])}), and shows by the number of readings alone."
    )


def shrinks(answer: Explanation) -> str:
    """By how much the gap fell on poses that no fit has seen."""
    first, last = answer.steps[0], answer.steps[-1]
    added = "it" if len(answer.findings) == 1 else "them"
    if any(
        f.effect.id != max(f.evidence.odds, key=f.evidence.odds.__getitem__, default=f.effect.id)
        for f in answer.findings
    ):  # a likelier one was said first
        added = listed([f.effect.id for f in answer.findings])
    if not math.isfinite(last.heldout_rms - first.heldout_rms):
        return (
            f"With {added} in the model the gap goes from {um(first.fit_rms)} to "
            f"{um(last.fit_rms)} µm, at poses that it was fitted to: there are too few to leave "
            f"any out; {noise_makes(answer)}."
        )
    goes = "falls" if last.heldout_rms < first.heldout_rms else "does not fall: it goes"
    return (
        f"With {added} in the model the gap on poses left out of the fit {goes} from "
        f"{um(first.heldout_rms)} to {um(last.heldout_rms)} µm; "
        f"{noise_makes(answer)}."
    )


def noise_makes(answer: Explanation) -> str:
    """What noise alone makes of the gap, in words."""
    if answer.noise_floor is None:
        return "the noise is unknown"
    return f"the noise alone makes {um(answer.noise_floor)} µm"


def sentence_of(answer: Explanation, name: str) -> str:
    """What an effect ``name:where`` is, in its own words."""
    return answer.effect(name).sentence()
