"""What comes nearest where nothing is confirmed: how well it foretells poses, and the best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import InputError, Refusal
from sk120stiff.explain.findings import Contender
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit, Problem, held_out, solve_near
from sk120stiff.measurements import Measurements

MOST = 4  # contenders that are left out pose by pose


def contenders(
    found: Selection, names: Sequence[str], *, seed: int
) -> tuple[tuple[Contender, ...], Fit | None]:
    """How much the held-out gap falls with each, best first, and the fit with the best.

    Args:
        found: The selection; its base model is what each is added to.
        names: Effects (``name:where``) that fitted and are not named, the likeliest first.
        seed: Of the parts in which poses are left out.
    """
    by_id = {effect.id: effect for effect in found.candidates}
    effects = [by_id[name] for name in dict.fromkeys(names) if name in by_id][:MOST]
    fits = {effect.id: _added(found, effect) for effect in effects}
    gains = _heldout_gains(found.base, [fit for fit in fits.values() if fit is not None], seed)
    told = iter(gains)
    seen = [Contender(name, float("nan") if f is None else next(told)) for name, f in fits.items()]
    ranked = sorted(seen, key=lambda c: -np.nan_to_num(c.heldout_gain, nan=-1e9))
    good = ranked and ranked[0].heldout_gain > 0.0
    return tuple(ranked), fits[ranked[0].id] if good else None


def _added(found: Selection, effect: Effect) -> Fit | None:
    try:
        return refit(found.base, [effect])
    except Refusal:
        return None


def _heldout_gains(base: Fit, fits: Sequence[Fit], seed: int) -> list[float]:
    """By how much the gap at poses left out falls from the base model to each of some others."""
    if not fits:
        return []

    def learn(readings: Measurements) -> list[Fit]:
        return [
            solve_near(Problem(fit.model, readings, fit.problem.noise), fit.x)
            for fit in (base, *fits)
        ]

    try:
        before, *after = held_out(base.problem.measurements, learn, seed=seed)
    except (InputError, Refusal):
        # one of them does not hold on some poses; then each is asked by itself
        alone = [_heldout_gains(base, [fit], seed) for fit in fits] if len(fits) > 1 else [[np.nan]]
        return [gain for gains in alone for gain in gains]
    return [before.rms - each.rms for each in after]
