"""The search where the laws are not exact: names are judged against model-form error beside noise.

Where all that is found leaves more than the noise allows, no name can be held against the noise
alone: a search that takes every micrometre for a cause finds impostors, and one that asks for
agreement never says anything of a real arm. So the size of the model-form error is estimated from
what the model leaves, the search is made beside it, and the names that stand are put into the model
that the size is estimated from anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from sk120stiff.explain.judge.attribution import MARGIN, Fallen, Named, judged
from sk120stiff.explain.judge.imitation import imitates
from sk120stiff.explain.select.stepwise import Attempt, with_effects
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements import NoiseModel

ROUNDS = 3  # of estimating, searching and judging
WORTH = 2.0  # gain in -2 ln L by which structure has to beat noise that is merely larger

Try = Callable[[NoiseModel], Attempt]


def beside_model_form(base: Fit, under: Try, *, seed: int) -> tuple[Attempt, Named]:
    """The attempt beside model-form error, with the effects alone that may be named.

    Args:
        base: Fit of the base model under the noise of the readings.
        under: Makes an attempt under one noise model.
        seed: Of folds and resampling.
    """
    at, before = base, None
    for _ in range(ROUNDS):
        found, named = judged(under(with_model_form(at)), seed=seed, least=MARGIN)
        names = {finding.effect.id for finding in named.findings}
        if names == before:
            break
        at, before = found.final, names
    return unless_imitating(found, named, seed)


def unless_imitating(found: Attempt, named: Named, seed: int) -> tuple[Attempt, Named]:
    """The same without names that imitate part of a cause that the catalogue lacks.

    They fall one at a time, the weakest first, and the others are judged anew; those that stand do
    so beside whatever is left.
    """
    for finding in reversed(named.findings):
        reason = imitates(found.final, finding.effect)
        if reason is not None:
            kept = [other.effect for other in named.findings if other is not finding]
            found, again = judged(with_effects(found, kept), seed=seed, least=MARGIN)
            fallen = (*named.fallen, Fallen(finding.effect.id, reason), *again.fallen)
            return unless_imitating(found, Named(again.findings, fallen), seed)
    return found, named


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
