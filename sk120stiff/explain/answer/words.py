"""Sentences about an answer that the terminal, the report and verdict.json share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.data_checks import place_of
from sk120stiff.explain.localise.localisation import Localisation
from sk120stiff.explain.localise.words import microns

if TYPE_CHECKING:
    from sk120stiff.explain.answer.explanation import Explanation
    from sk120stiff.explain.findings import Finding

APART = 0.01  # share by which two figures of one gap may differ unexplained
WORSE = 1.5  # times as large held out as fitted: worth a sentence


def accounted(answer: Explanation) -> str | None:
    """What all of the remainder goes with; None where nothing leaves no more than noise."""
    goes_with = answer.remainder.goes_with
    return goes_with.suspect if goes_with is not None and goes_with.whole else None


def mostly_accounted(answer: Explanation) -> str | None:
    """What most of the remainder goes with, beside which the names were judged; None: nothing."""
    goes_with = answer.remainder.goes_with
    partly = goes_with is not None and not goes_with.whole and goes_with.most
    return goes_with.suspect if goes_with is not None and partly else None


def told_next(answer: Explanation, finding: Finding) -> bool:
    """Do the proposed readings tell this finding from all that stand beside it?"""
    own = [pair for pair in answer.next_pairs if pair.name == finding.effect.id]
    return bool(finding.others) and {*finding.others} <= {p.rival for p in own if p.settled}


def noise_words(answer: Explanation) -> tuple[str, ...]:
    """What was decided about the noise; what has a place is not called noise."""
    statement, left = answer.adequacy.of_the_statement(), answer.adequacy
    whole = accounted(answer)
    place, it = (whole, "it") if whole else (mostly_accounted(answer), "most of it")
    if left.whole is None or left.understated is not None or place is None:
        return answer.noise_reasons
    said = (
        f"What is left is {left.whole.factor:.3g} times the stated uncertainty, and {it} is no "
        f"noise: it goes with {place}. The standard errors account for it."
    )
    wrong = set(statement) if left.lacking else set()
    return tuple(said if reason in wrong else reason for reason in answer.noise_reasons)


def plain_words(answer: Explanation) -> tuple[str, ...]:
    """Why the first gap of the steps is not the gap whose place is told."""
    plain = answer.details.get("localisation")
    if not isinstance(plain, Localisation):
        return ()
    first = answer.steps[0].fit_rms
    if abs(first - plain.rms) <= APART * plain.rms:
        return ()
    return (
        f"Beside what has no name a model is fitted so that few poses do not pull it, and leaves "
        f"{microns(first)}; a plain fit of the base model leaves {microns(plain.rms)}, and where "
        "the gap lives is told of that one.",
    )


def held_out_words(answer: Explanation) -> tuple[str, ...]:
    """That a hold-out file contradicts the names, or why it is foretold so much worse."""
    told = answer.borne_out
    if told is not None and told.contradicted:
        return (told.sentence(),)
    offsets = _of_single_poses(answer)
    far = [
        step
        for step in answer.steps[1:] or answer.steps
        if np.isfinite(step.heldout_rms) and step.heldout_rms > WORSE * step.fit_rms
    ]
    if not far:
        return ()
    if far[-1].heldout_rms <= WORSE * np.hypot(far[-1].fit_rms, offsets):
        return (
            f"Poses that are left out have offsets of their own, {microns(offsets)} rms per axis, "
            "which no model foretells: they are most of the held-out gap, and none of the arm's.",
        )
    return (
        f"{far[-1].label.removeprefix('+ ')}: poses that are left out are foretold worse than "
        "others are fitted. Names, laws and values are learned anew without them, and where few "
        "poses show a cause or a spring, the rest may miss it: trust the held-out number.",
    )


def worse_elsewhere(answer: Explanation) -> bool:
    """Does the final model foretell poses that are left out much worse than it fits?"""
    last = answer.steps[-1]
    return bool(np.isfinite(last.heldout_rms) and last.heldout_rms > WORSE * last.fit_rms)


def _of_single_poses(answer: Explanation) -> float:
    """What named draws of single poses move the readings by, rms per axis [m]."""
    drawn = {each.effect.id for each in answer.findings if each.effect.random_effects}
    return float(np.sqrt(sum(share.rms**2 for share in answer.budget if share.name in drawn)))


def set_aside_sentences(answer: Explanation) -> tuple[str, ...]:
    """One for every reading that was set aside, with the slip that would explain it, and a last."""
    if not answer.set_aside:
        return ()
    each = (
        f"Set aside as no smooth cause can have made it: {place_of(answer.readings, row)}"
        + (f"; {answer.slips[row]}." if row in answer.slips else ".")
        for row in answer.set_aside
    )
    return *each, with_set_aside(answer)


def with_set_aside(answer: Explanation) -> str:
    """What the model leaves of the readings in use, with those set aside and without."""
    return (
        f"With what was set aside the model leaves {microns(answer.rms_of_all)} rms per axis, as "
        f"'sk120stiff predict' counts it, without {microns(answer.final.rms)}."
    )
