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

import numpy as np

from sk120stiff.explain.findings import Finding
from sk120stiff.explain.judge.adequacy import explained, structure
from sk120stiff.explain.judge.attribution import MARGIN, Fallen, Named, judged
from sk120stiff.explain.select.best_attempt import held_against
from sk120stiff.explain.select.stepwise import Attempt, with_effects
from sk120stiff.identify import Fit, yardstick
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements import NoiseModel
from sk120stiff.measurements.model_form import EXACT

ROUNDS = 3  # of estimating, searching and judging
IMITATED = 0.3  # structure left, over what the names explain, from which on they may imitate
DECISIVE = 1e-8  # probability of such structure if what is left were as irregular as draws
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
    return _unless_imitating(found, named, seed)


def _unless_imitating(found: Attempt, named: Named, seed: int) -> tuple[Attempt, Named]:
    """The same without names that may imitate part of a cause that the catalogue lacks.

    What no arm is free of is as irregular as draws, pose by pose. A cause that the catalogue lacks
    leaves more than that beside whatever comes nearest to it: where much of what is left is
    structured, nothing is named. And what explains less than is left falls beside a stronger name.
    """
    noise = yardstick(found.final)
    if not (named.findings and noise.freedom):
        return found, named  # nothing tells noise from structure
    left = structure(found.final, {effect.id for effect in found.effects})
    if left.probability < DECISIVE and left.excess > IMITATED * left.explained:
        undone = tuple(Fallen(each.effect.id, _imitates(each)) for each in named.findings)
        return with_effects(found, []), Named((), (*undone, *named.fallen))
    exactly = held_against(replace(found.final.problem.noise, form=EXACT), found.final)
    left = structure(exactly, {effect.id for effect in found.effects})
    weakest = named.findings[-1]
    unit = float(np.sqrt(yardstick(exactly).scale))
    if (
        len(named.findings) == 1
        or left.probability >= DECISIVE
        or explained(exactly, {weakest.effect.id}) >= unit * left.excess
    ):
        return found, named
    kept = [finding.effect for finding in named.findings[:-1]]
    found, again = judged(with_effects(found, kept), seed=seed, least=MARGIN)
    fallen = (*named.fallen, Fallen(weakest.effect.id, _imitates(weakest)), *again.fallen)
    return _unless_imitating(found, Named(again.findings, fallen), seed)


def _imitates(finding: Finding) -> str:
    return (
        f"{finding.effect.id} fits, but what is left over is too structured to be what any arm "
        "leaves over, and it may imitate part of another cause; it is not named."
    )


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
