"""Laws that leave the drives their springs.

No gear is rigid. Where the compliance of a drive vanishes once a name is in the model, the law of
that name has taken it over. Another law of the same name that fits nearly as well and leaves the
drive a spring is the likelier one, by what is known of gears before anything is measured. And where
one parameter of the name is the spring in other words, as a tilt about the next joint's axis is, it
is held rigid: the readings give the sum of both, and the spring is there in any case.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.select.score import Scored, score_set
from sk120stiff.explain.select.stepwise import Selection, with_effects
from sk120stiff.identify import Fit, solve

UNLIKELY = 6.0  # evidence (-2 ln of the odds, one in twenty) against a gear that does not yield
TRIED = 4  # other laws that are fitted exactly
HELD = "held rigid"  # in the origin of a parameter that is a spring in other words


def without_rigid_gears(found: Selection, named: Named) -> tuple[Selection, Named]:
    """The same names, by laws that leave no gear rigid where there are such laws.

    Args:
        found: The selection whose effects stand.
        named: What was said of them.
    """
    regression, before = found.regression, _rigid(found.final)
    if not before or not named.findings:
        return found, named
    place = {effect.id: e for e, effect in enumerate(regression.candidates)}
    now = score_set(regression, regression.sums(), found.chosen, only=())
    others: list[tuple[float, int, int]] = []
    for finding in named.findings:
        e = place[finding.effect.id]
        for k, law in enumerate(regression.laws[e]):
            if law == finding.effect:  # its parameters tied or not, it is the law that is fitted
                continue
            start = now.by_variant | {e: k}
            model = score_set(regression, regression.sums(), found.chosen, start=start, only=())
            others.append((_total(regression, model), e, k))
    for total, e, k in sorted(others)[:TRIED]:
        if total >= _total(regression, now):
            break
        law = regression.law(e, k)
        effects = [law if effect.id == law.id else effect for effect in found.effects]
        try:
            other = with_effects(found, effects)
        except Refusal:
            continue
        if _rigid(other.final) < before:
            findings = tuple(
                replace(finding, effect=law) if finding.effect.id == law.id else finding
                for finding in named.findings
            )
            return without_rigid_gears(other, replace(named, findings=findings))
    return replace(found, final=_with_one_held(found.final, named, before)), named


def held_rigid(fit: Fit) -> tuple[str, ...]:
    """What is to be said of parameters that were held rigid, in sentences."""
    return tuple(
        f"{parameter.name} is {HELD}: the readings give only its sum with the spring of a drive."
        for parameter in fit.model.parameters
        if parameter.origin == HELD
    )


def _with_one_held(fit: Fit, named: Named, before: int) -> Fit:
    """The fit with the one parameter of the names held rigid that leaves more drives a spring."""
    names = {finding.effect for finding in named.findings}
    others = []
    for k in fit.problem.free:
        parameter = fit.model.parameters[k]
        alone = sum(other.effect == parameter.effect for other in fit.parameters) == 1
        if parameter.effect not in names or alone or parameter.spec.lower != 0.0:
            continue
        held = replace(parameter, internal=0.0, internal_std=None, free=False, origin=HELD)
        parameters = tuple(held if p is parameter else p for p in fit.model.parameters)
        problem = replace(fit.problem, model=replace(fit.model, parameters=parameters))
        try:
            others.append(solve(problem))
        except Refusal:
            continue
    fair = [each for each in others if each.chi_square < fit.chi_square + UNLIKELY]
    best = min(fair, key=lambda each: (_rigid(each), each.chi_square), default=fit)
    return best if _rigid(best) < before else fit


def _rigid(fit: Fit) -> int:
    """How many joint springs of a model lie on their bound."""
    return sum(p.free and p.effect.joint_spring and p.internal == 0.0 for p in fit.parameters)


def _total(regression: Regression, model: Scored) -> float:
    """Score of a model with the price of every compliance of the base model that vanishes in it.

    Infinite where a size is beyond belief.
    """
    base = regression.base[regression.lower[regression.base] == 0.0]
    rigid = len(base) - int(np.isin(base, model.solved.columns).sum())
    return model.score + UNLIKELY * rigid if model.plausible else np.inf
