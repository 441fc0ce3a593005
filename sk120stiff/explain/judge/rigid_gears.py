"""Laws and names that leave the drives their springs.

No gear is rigid, and the stiffest drive of an arm is not many times stiffer than its others: by
springs that were published of industrial arms (KUKA KR 240 and KR 270, FANUC R-2000iC: Dumas et
al. 2011, Klimchik et al. 2014) three to eight times their median. Where the compliance of a drive
all but vanishes once a name is in the model, the name has taken it over. So every drive has its
price, by what is known of drives before anything is measured: how far out of line it is with the
others, less where readings hardly tell it. Another law of the same name, or another name that the
readings cannot tell from it, that fits nearly as well and leaves the drive a spring is the
likelier one. And where one parameter of the name is the spring in other words, as a tilt about the
next joint's axis is, it is held rigid: the readings give the sum of both, and the spring is there
in any case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.posterior import LISTED
from sk120stiff.explain.select.score import Scored, score_set, unit
from sk120stiff.explain.select.stepwise import Selection, with_effects
from sk120stiff.identify import Fit, solve

SPREAD = 1.0  # standard deviation of ln K among the drives of one arm
OUT_OF_LINE = 4.0  # price of a drive from which on other laws and names are looked at
UNLIKELY = 6.0  # evidence (-2 ln of the odds, one in twenty) against a gear that does not yield
TRIED = 4  # other laws and names that are fitted exactly
FINE = np.exp(np.linspace(-12.0, 0.0, 241))  # compliances that are tried, over the usual one
HELD = "held rigid"  # in the origin of a parameter that is a spring in other words


def without_rigid_gears(found: Selection, named: Named) -> tuple[Selection, Named]:
    """The names by laws that leave no gear rigid, or their rivals, where there are such.

    Args:
        found: The selection whose effects stand.
        named: What was said of them.
    """
    regression = found.regression
    now = score_set(regression, regression.sums(), found.chosen, only=())
    prices = prices_of_drives(regression, now)
    before = float(prices.sum())
    if not named.findings:
        return found, named
    if prices.max(initial=0.0) >= OUT_OF_LINE:
        for total, model, place, e in sorted(
            _others(found, named, now), key=lambda other: other[0]
        )[:TRIED]:
            if total >= now.score + before:
                break
            head = regression.law(e, model.by_variant[e])
            old = named.findings[place].effect
            effects = [head if effect.id == old.id else effect for effect in found.effects]
            try:
                other = with_effects(found, effects)
            except Refusal:
                continue
            again = score_set(other.regression, other.regression.sums(), other.chosen, only=())
            if prices_of_drives(other.regression, again).sum() < before:
                findings = list(named.findings)
                findings[place] = findings[place].headed_by(head)
                return without_rigid_gears(other, replace(named, findings=tuple(findings)))
    held = _with_one_held(found.final, named)
    return (found if held is found.final else replace(found, final=held)), named


def prices_of_drives(regression: Regression, model: Scored) -> Array:
    """(k,) -2 ln of the odds against each of k drives being as stiff as a model has it.

    It is held against the median of the others that yield, and may be as soft as readings allow.
    """
    springs = regression.springs
    values = np.zeros(regression.X.shape[1])
    values[model.solved.columns] = model.solved.values
    prices = np.zeros(len(springs))
    for place, j in enumerate(springs.tolist()):
        others = [values[k] for k in springs.tolist() if k != j and values[k] > 0.0]
        if not others:
            continue
        usual = float(np.exp(np.median(np.log(others))))
        if values[j] < usual:
            likeliest, std = _by_readings(regression, model, j)
            tried = np.append(usual * FINE, max(values[j], FINE[0] * usual))
            away = ((tried - likeliest) ** 2 - (values[j] - likeliest) ** 2) / std**2
            prices[place] = np.min(away + (np.log(tried / usual) / SPREAD) ** 2)
    return prices


def _by_readings(regression: Regression, model: Scored, j: int) -> tuple[float, float]:
    """Compliance of a drive by the readings alone, negative or not, and its standard error."""
    columns = np.union1d(model.solved.columns, [j])
    sums, place = regression.sums(), int(np.searchsorted(columns, j))
    inner = sums.gram[np.ix_(columns, columns)] + np.diag(regression.plausible[columns] ** -2.0)
    scale = 1.0 / np.sqrt(np.diag(inner))
    known: Array = np.linalg.inv(inner * np.outer(scale, scale)) * np.outer(scale, scale)
    value = float((known @ sums.moment[columns])[place])
    return value, float(np.sqrt(known[place, place] * unit(regression, model)))


def held_rigid(fit: Fit) -> tuple[str, ...]:
    """What is to be said of parameters that were held rigid, in sentences."""
    return tuple(
        f"{parameter.name} is {HELD}: the readings give only its sum with the spring of a drive."
        for parameter in fit.model.parameters
        if parameter.origin == HELD
    )


def _others(found: Selection, named: Named, now: Scored) -> list[tuple[float, Scored, int, int]]:
    """Models by other laws of the names and by their rivals: total, model, finding, candidate."""
    regression = found.regression
    place = {effect.id: e for e, effect in enumerate(regression.candidates)}
    chosen: Mapping[int, int] = now.by_variant
    out: list[tuple[float, Scored, int, int]] = []
    for number, finding in enumerate(named.findings):
        own = place[finding.effect.id]
        rest = {e: k for e, k in chosen.items() if e != own}
        odds = finding.evidence.odds
        near = {*finding.others, *(name for name in odds if odds[name] > LISTED)}
        rivals = [place[name] for name in near if name in place]
        for e in (own, *(e for e in rivals if e not in chosen)):
            for k, law in enumerate(regression.laws[e]):
                if law == finding.effect:  # parameters tied or not, it is the law that is fitted
                    continue
                start = rest | {e: k}
                model = score_set(regression, regression.sums(), start, start=start, only=())
                total = model.score + float(prices_of_drives(regression, model).sum())
                out.append((total if model.plausible else np.inf, model, number, e))
    return out


def _with_one_held(fit: Fit, named: Named) -> Fit:
    """The fit with the one parameter of the names held rigid that leaves more drives a spring."""
    before, names = _rigid(fit), {finding.effect for finding in named.findings}
    if not before:
        return fit
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
