"""What would fit, were its size to be believed.

An effect is only looked for within what is plausible of an arm of this size. Where something
remains that an effect beyond that range explains far better than all within it, the reader hears of
it: units may be wrong, or the arm is not what was thought.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import Scored, score_set
from sk120stiff.explain.select.stepwise import Selection

DECISIVE = 10.0  # difference of scores (BIC: Kass & Raftery 1995) that is worth a sentence


@dataclass(frozen=True)
class Implausible:
    """An effect that would explain by far the most, and by what size, in a sentence."""

    id: str
    sentence: str


def implausible(found: Selection) -> Implausible | None:
    """The one effect more that explains by far the most, if its size is beyond belief."""
    regression, sums, now = found.regression, found.regression.sums(), found.scored
    promised = promises(regression, sums, now.solved)
    tried: dict[int, Scored] = {}
    for e in set(range(len(regression.candidates))) - set(now.effects):
        if not regression.candidates[e].random_effects:
            law = now.by_variant | {e: promised.likeliest(e)}
            tried[e] = score_set(regression, sums, law, untied=e, start=law, only=())
    beyond = [e for e in tried if not regression.are_sizes_believed(tried[e].solved)]
    if not beyond or not now.plausible:
        return None
    best = min(beyond, key=lambda e: tried[e].score)
    believed = min([now.score, *(model.score for model in tried.values() if model.plausible)])
    if tried[best].score > believed - DECISIVE:
        return None
    return Implausible(regression.candidates[best].id, _told(regression, best, tried[best]))


def _told(regression: Regression, effect: int, model: Scored) -> str:
    """The parameter that is farthest beyond what is believed, with both numbers."""
    variant = model.by_variant[effect]
    law, columns = regression.law(effect, variant), regression.variants[effect][variant]
    found = model.solved.columns.tolist()
    sizes = dict(zip(found, model.solved.values, strict=True))
    limits = dict(zip(found, regression.believed(model.solved), strict=True))
    ratios = [abs(sizes.get(c, 0.0)) / limits.get(c, np.inf) for c in columns.tolist()]
    k = int(np.argmax(ratios))
    spec, column = law.parameters[k], int(columns[k])
    value = spec.public(sizes[column] * spec.typical)
    limit = abs(spec.public(limits[column] * spec.typical))
    bound = "softer than" if spec.reciprocal else "beyond"
    return (
        f"{law.id} would explain more than anything believable, but by {spec.name} = "
        f"{value:.3g} {spec.unit}, {bound} what is believed of an arm of this size "
        f"({limit:.3g} {spec.unit}). Check the units and what was stated of arm and tool; if it is "
        f"so, take it for granted with --assume {law.id}."
    )
