"""Probabilities of names from the scores of models.

Scores are -2 ln(evidence × prior) up to a constant (`score.py`), so a model's share among models
that exclude one another is exp(-score/2) over the sum of all (Kass & Raftery 1995). They are
probabilities within the catalogue: a cause that it lacks has no score.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.findings import NAMED, Finding
from sk120stiff.explain.judge.one_gear import Imitated
from sk120stiff.explain.priors import FALLEN, FURTHER_IMPOSTOR, IMPOSTOR
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import score_set

USUAL_LEVEL = 0.05  # of chance, up to which a gain is significant as the word is used
LISTED = 0.01  # probability from which on a candidate is worth a line
NONE = "none"  # of the catalogue
LOOKED_AT = 24  # candidates that are scored


def posterior(scores: Mapping[str, float], *, none: float) -> dict[str, float]:
    """Probability of each of some models, beside the one without any of them.

    Parameters
    ----------
    scores
        Score of the model with each name.
    none
        Score of the model without all of them.
    """
    values = np.array([none, *scores.values()])
    weights = np.exp(-0.5 * (values - values.min()))
    shares = weights / weights.sum()
    return {name: float(share) for name, share in zip(scores, shares[1:], strict=True)}


def until_covered(odds: Mapping[str, float], listed: Collection[str]) -> tuple[str, ...]:
    """The likeliest names beside those listed, until `NAMED` is covered.

    Where all names together have less, `NAMED` of what they have is covered; where they have hardly
    more, none is listed for the sake of less than `LISTED`.

    Args:
        odds: As of `posterior`.
        listed: Names that are listed already.
    """
    others = sorted((name for name in odds if name not in listed), key=odds.__getitem__)
    covered = sum(odds.get(name, 0.0) for name in set(listed))
    whole = sum(odds.values())
    enough = NAMED * whole if whole < NAMED else min(NAMED, whole - LISTED)
    more: list[str] = []
    while others and covered < enough:
        more.append(others.pop())
        covered += odds[more[-1]]
    return tuple(more)


def doubted_findings(
    findings: Sequence[Finding],
    something_else: float,
    together: Sequence[Imitated],
    *,
    noise_known: bool,
) -> tuple[Finding, ...]:
    """The findings, the strongest first, each as probable as all that speaks against it lets it be.

    Beside a cause without a name the strongest seldom imitates a part of it; a further name may,
    unless its gain at poses left out is beyond chance. Where nobody said how large the noise is,
    those poses are the only witness that what a name takes off is no noise.

    Args:
        findings: By their evidence.
        something_else: Probability that a cause without a name is at work.
        together: Names of one gear that may be one cause.
        noise_known: The noise was stated, or repeats tell it.
    """
    out = []
    for k, each in enumerate(findings):
        chance = each.evidence.confirmation.chance
        further = (FURTHER_IMPOSTOR - IMPOSTOR) * min(chance / USUAL_LEVEL, 1.0)
        imitates = IMPOSTOR + further * (k > 0)
        one_cause = sum(part.probability for part in together if each.effect.id in part.ids)
        found = each.doubted(imitates * something_else).doubted(one_cause)
        out.append(in_full(found if noise_known else found.doubted(chance)))
    return tuple(out)


def in_full(finding: Finding) -> Finding:
    """The same with all names that an open answer lists; as evidence they count no more."""
    said = finding.evidence
    more = until_covered(said.odds, {finding.effect.id, *finding.alternatives})
    if not more:
        return finding
    names = (*finding.alternatives, *more)
    rest = {name: gap for name, gap in said.rivals.items() if name not in names}
    best = min(rest, key=rest.__getitem__, default=None)
    gap = np.inf if best is None else rest[best]
    return replace(
        finding, alternatives=names, evidence=replace(said, runner_up=best, runner_up_gap=gap)
    )


def one_more(regression: Regression, model: tuple[int, ...]) -> dict[str, float]:
    """Probability of every candidate as one effect more, above a hundredth, and of `NONE`."""
    sums = regression.sums()
    base = score_set(regression, sums, model)
    most = promises(regression, sums, base.solved).most
    order = [int(e) for e in np.argsort(-most) if int(e) not in model][:LOOKED_AT]
    start = base.by_variant
    scored = {e: score_set(regression, sums, (*model, e), start=start, only=(e,)) for e in order}
    fair = {regression.candidates[e].id: m.score for e, m in scored.items() if m.plausible}
    found = posterior(fair, none=base.score)
    listed = {name: share for name, share in found.items() if share > LISTED}
    return {NONE: 1.0 - sum(found.values()), **listed}


def doubted(
    odds: Mapping[str, float], fallen: Collection[str], something_else: float
) -> dict[str, float]:
    """Probabilities of one effect more, where names have fallen or may imitate what has none.

    Args:
        odds: As of `one_more`.
        fallen: Names that fell in the judgement.
        something_else: Probability that a cause without a name is at work.
    """
    held = 1.0 - FURTHER_IMPOSTOR * something_else
    return {
        name: share * (FALLEN if name in fallen else 1.0 if name == NONE else held)
        for name, share in odds.items()
    }
