"""What a stronger effect's law leaves over and another name would explain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.effects.base import Elastic, Geometric
from sk120stiff.explain.findings import Finding
from sk120stiff.explain.select.score import score_set, unit
from sk120stiff.explain.select.stepwise import Selection, positions
from sk120stiff.robot.anatomy import arm_joints

CURVE = 0.15  # of a gear's twist to which no law of it is exact: a second law may mend the first
NEIGHBOURS = 2  # places along the chain: a linkage may hold a passive joint in between
CHANCE = 2.0  # by which noise lengthens what a law leaves over


def stronger(found: Selection, findings: list[Finding], place: int) -> Finding | None:
    """The stronger effect whose law leaves over what this one explains.

    No gear follows a cubic to the last digit; what is left looks like play or friction there. Which
    of two laws of one gear is the stronger is told by what the misfit loses without each, not by
    the micrometres of each: play takes more of these, and hardly any where the curve bends anyway.
    No link is as thick at its end as at its root; what is left looks like a tilting bearing.
    """
    finding = findings[place]
    gain = np.sqrt(max(finding.evidence.misfit_gain, 0.0))
    for other in findings:
        both = finding.effect.of_gear and other.effect.of_gear
        weaker = finding.evidence.misfit_gain < other.evidence.misfit_gain
        if both and weaker and finding.effect.where == other.effect.where:
            without = [each.effect for each in findings if each is not finding]
            if gain < CURVE * _length(found, other.effect, without):
                return other
    for other in findings[:place]:
        share = other.effect.inexact
        if (
            share
            and _beside(found, finding.effect, other.effect)
            and gain < share * _length(found, other.effect, [other.effect]) + CHANCE
        ):
            return other
    return None


def _beside(found: Selection, effect: Effect, link: Effect) -> bool:
    """Does this yield in proportion to its load, at the link or at a neighbour of it?

    Or does it move the levers there: where along a beam it yields tells a lever from a taper.
    """
    if not isinstance(effect, Elastic | Geometric) or effect.of_gear:
        return False
    place: dict[str, int] = {}
    for number, joint in enumerate(arm_joints(found.final.model.robot)):
        place |= {joint.name: number, joint.link: number}
    both = effect.where in place and link.where in place
    return both and abs(place[effect.where] - place[link.where]) <= NEIGHBOURS


def _length(found: Selection, effect: Effect, among: Sequence[Effect]) -> float:
    """Fall of the misfit that an effect brings among some, as a length √λ in units of the noise."""
    regression, sums = found.regression, found.regression.sums()
    chosen = set(positions(regression, among))
    place = positions(regression, [effect])[0]
    start = found.scored.by_variant
    with_it = score_set(regression, sums, chosen, start=start).solved.rss
    without = score_set(regression, sums, chosen - {place}, start=start).solved.rss
    return float(np.sqrt(max((without - with_it) / unit(regression, found.scored), 0.0)))
