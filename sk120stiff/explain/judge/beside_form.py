"""The search where the laws are not exact: names are judged against model-form error beside noise.

Where all that is found leaves more than the noise allows, no name can be held against the noise
alone: a search that takes every micrometre for a cause finds impostors, and one that asks for
agreement never says anything of a real arm. So the size of the model-form error is estimated from
what the model leaves, the search is made beside it, and the names that stand are put into the model
that the size is estimated from anew.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from sk120stiff.explain.judge.attribution import MARGIN, Fallen, Named, judged
from sk120stiff.explain.judge.imitation import imitated
from sk120stiff.explain.select.stepwise import Selection, with_effects
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements import NoiseModel

ROUNDS = 3  # of estimating, searching and judging
WORTH = 2.0  # gain in -2 ln L by which structure has to beat noise that is merely larger

Try = Callable[[NoiseModel], Selection]


def beside_model_form(
    at: Fit, under: Try, *, names: Collection[str] = (), seed: int
) -> tuple[Selection, Named]:
    """The selection beside model-form error, with the effects alone that may be named.

    What confirmed names explain is no model-form error: the search begins beside what they leave.

    Args:
        at: Fit under the noise of the readings, of the base model with the effects that stand
            against the noise alone.
        under: Makes a selection under one noise model.
        names: Ids of these effects.
        seed: Of folds and resampling.
    """
    before = set(names)
    for _ in range(ROUNDS):
        found, named = judged(under(with_model_form(at)), seed=seed, least=MARGIN)
        now = {finding.effect.id for finding in named.findings}
        if now == before:
            break
        at, before = found.final, now
    return unless_imitating(found, named, seed)


def unless_imitating(found: Selection, named: Named, seed: int) -> tuple[Selection, Named]:
    """The same without names that imitate part of a cause that the catalogue lacks.

    They fall one at a time, the weakest first, and the others are judged anew; those that stand do
    so beside whatever is left.
    """
    effects = [finding.effect for finding in named.findings]
    reason = imitated(found.final, effects)
    if reason is None:
        return found, named
    kept = [effect for effect in effects if effect.id != reason[0]]
    found, again = judged(with_effects(found, kept), seed=seed, least=MARGIN)
    fallen = (*named.fallen, Fallen(*reason), *again.fallen)
    return unless_imitating(found, Named(again.findings, fallen), seed)


def with_model_form(fit: Fit) -> NoiseModel:
    """The noise of a fit's readings with the model-form error that its gap asks for.

    Where a larger noise would do as well, nothing is structured, and only the size is let free.
    """
    noise = fit.problem.noise
    found = variance_components(fit)
    if noise.known and found.inflation_gain > found.gain - WORTH:
        return replace(noise, freedom=0)
    if not noise.known:
        noise = replace(noise, sigma=noise.sigma * found.noise_factor)
    return replace(noise, form=found.form)
