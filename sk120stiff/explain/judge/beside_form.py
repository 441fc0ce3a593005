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

from sk120stiff.explain.judge.adequacy import structure
from sk120stiff.explain.judge.attribution import MARGIN, Fallen, Named, judged
from sk120stiff.explain.select.stepwise import Attempt, with_effects
from sk120stiff.identify import Fit, yardstick
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements import NoiseModel

ROUNDS = 3  # of estimating, searching and judging
IMITATED = 0.3  # structure left, over what the names explain, from which on they may imitate
DECISIVE = 1e-8  # probability of such structure if what is left were as irregular as draws
WORTH = 2.0  # gain in -2 ln L by which structure has to beat noise that is merely larger

Try = Callable[[NoiseModel], Attempt]


def beside_model_form(base: Fit, under: Try, *, seed: int) -> tuple[Attempt, Named]:
    """The attempt beside model-form error, with the effects alone that may be named.

    Parameters
    ----------
    base
        Fit of the base model under the noise of the readings.
    under
        Makes an attempt under one noise model.
    seed
        Of folds and resampling.
    """
    at, before = base, None
    for _ in range(ROUNDS):
        found, named = judged(under(with_model_form(at)), seed=seed, least=MARGIN)
        names = {finding.effect.id for finding in named.findings}
        if names == before:
            break
        at, before = found.final, names
    return _unless_imitating(found, named)


def _unless_imitating(found: Attempt, named: Named) -> tuple[Attempt, Named]:
    """The same, without names if much of what is left is structured: they may imitate its cause.

    What no arm is free of is as irregular as draws, pose by pose. A cause that the catalogue lacks
    leaves more than that beside whatever comes nearest to it.
    """
    if not yardstick(found.final).freedom:
        return found, named  # nothing tells noise from structure
    left = structure(found.final, found.regression, found.scored.solved.columns)
    large = left.excess > IMITATED * left.explained
    if not (named.findings and left.probability < DECISIVE and large):
        return found, named
    undone = tuple(
        Fallen(
            finding.effect.id,
            f"{finding.effect.id} fits best, but what it leaves is too structured to be what any "
            "arm leaves over, so it may imitate another cause; it is not named.",
        )
        for finding in named.findings
    )
    return with_effects(found, []), Named((), (*undone, *named.fallen))


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
