"""What comes nearest where nothing is confirmed: how well it foretells poses, and the best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import InputError, Refusal
from sk120stiff.explain.findings import Contender
from sk120stiff.explain.select.stepwise import Attempt, refit
from sk120stiff.identify import Fit, Problem, held_out, solve_near
from sk120stiff.measurements import Measurements

MOST = 4  # contenders that are left out pose by pose


def contenders(
    found: Attempt, names: Sequence[str], *, seed: int
) -> tuple[tuple[Contender, ...], Fit | None]:
    """How much the held-out gap falls with each, best first, and the fit with the best.

    Parameters
    ----------
    found
        The attempt; its base model is what each is added to.
    names
        Effects (``name:where``) that fitted and are not named, the likeliest first.
    seed
        Of the parts in which poses are left out.
    """
    by_id = {effect.id: effect for effect in found.candidates}
    effects = [by_id[name] for name in dict.fromkeys(names) if name in by_id][:MOST]
    seen = [_contender(found, effect, seed) for effect in effects]
    gains = {c.id: fit for c, fit in seen if fit is not None and c.heldout_gain > 0.0}
    ranked = sorted((c for c, _ in seen), key=lambda c: -np.nan_to_num(c.heldout_gain, nan=-1e9))
    best = ranked[0].id if ranked else ""
    return tuple(ranked), gains.get(best)


def _contender(found: Attempt, effect: Effect, seed: int) -> tuple[Contender, Fit | None]:
    try:
        whole = refit(found.base, [effect])
        base = found.base

        def learn(readings: Measurements) -> list[Fit]:
            return [
                solve_near(Problem(fit.model, readings, fit.problem.noise), fit.x)
                for fit in (base, whole)
            ]

        before, after = held_out(base.problem.measurements, learn, seed=seed)
    except (InputError, Refusal):
        return Contender(effect.id, float("nan")), None
    return Contender(effect.id, before.rms - after.rms), whole
