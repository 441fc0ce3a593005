"""Names that a soft part would explain as well: what a user put on, or what the arm stands on.

Such a part is looked for within what is customary (`select/brought.py`), so that it does not stand
for what every arm has beyond its laws. Where a far softer one explains the readings as well as a
name does, or better, and other poses bear it out, the readings do not tell which of the two it is:
what is customary is no reading. Both are the answer then, the soft part at the price of being rare,
and the likelier of them goes first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.errors import Refusal
from sk120stiff.explain.findings import NAMED, Confirmation, Finding
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.confirm import confirm
from sk120stiff.explain.priors import FAR_SOFTER, USUAL
from sk120stiff.explain.select.brought import SoftRivals
from sk120stiff.explain.select.stepwise import Selection, laws_of, with_effects

RARE = 2.0 * float(np.log(USUAL / FAR_SOFTER))  # what a part far softer than is customary pays
LOST = 2.0 * float(np.log(NAMED / (1.0 - NAMED)))  # behind from where on it is not worth a set


def with_soft_parts(
    found: Selection, named: Named, rivals: SoftRivals | None, *, seed: int
) -> tuple[Selection, Named]:
    """The names, each with the soft part that may be meant as well.

    Args:
        found: The selection whose effects stand.
        named: What was said of them.
        rivals: Soft parts that would do in their place.
        seed: Of folds and resampling.
    """
    if rivals is None:
        return found, named
    findings = list(named.findings)
    place = {finding.effect.id: k for k, finding in enumerate(findings)}
    for e, (model, soft) in rivals.best.items():
        regression = rivals.regression
        k = place.get(regression.candidates[e].id)
        gap = model.score + RARE - rivals.named
        if k is None or gap > LOST or not model.plausible:
            continue
        said = confirm(regression, model, soft, (), seed=seed)
        if not said.holds:
            continue
        wider = findings[k].beside(regression.candidates[soft].id, gap)
        if gap < 0.0:
            try:
                soft_found = replace(found, regression=regression)
                found = with_effects(soft_found, laws_of(regression, model))
            except Refusal:
                continue
            head = next(law for law in found.effects if law.id == regression.candidates[soft].id)
            findings[k] = _instead(wider.headed_by(head), said, gap)
            return found, replace(named, findings=tuple(findings))
        findings[k] = wider
    return found, replace(named, findings=tuple(findings))


def _instead(finding: Finding, said: Confirmation, gap: float) -> Finding:
    """A soft part first, with what other poses say; what lies far behind it is not in its set."""
    evidence = replace(finding.evidence, confirmation=said)
    if -gap < LOST:
        return replace(finding, evidence=evidence)
    first, *others = finding.alternatives
    evidence = replace(evidence, runner_up=first, runner_up_gap=-gap)
    return replace(finding, alternatives=tuple(others), evidence=evidence)
