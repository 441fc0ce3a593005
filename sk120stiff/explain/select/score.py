"""How well a set of effects explains the gap, in one number.

Models are scored by an extended Bayesian information criterion (after Chen & Chen 2008): the
misfit, plus a price for every parameter that moves, plus a price for every effect, which pays for
having looked at so many candidates.

A parameter of the base model costs ln R. The k parameters of an effect together cost what their
marginal likelihood asks for when they are drawn from one distribution whose width the readings
tell: k (1 + ln(G/k)), with G the misfit that the effect takes away (MacKay 1992), and never more
than k ln R. So six weak parameters of one sensor may be seen where they are significant together,
and the level of a chance finding is the same for an effect of one parameter and for one of six.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.explain.candidates.regression import Regression, Solved, Sums, solve_columns

FLOOR = 2.0  # least difference of scores for which an effect joins a model
PRICED = 50  # rounds in which a fall and its own price agree; each gains a digit
DRAWN_SIZES = (0.7, 1.5, 3.0, 6.0)  # standard deviations tried, in typical sizes


@dataclass(frozen=True, eq=False)
class Scored:
    """A set of candidate effects with its score.

    Attributes
    ----------
    effects
        Positions in `Regression.candidates`, ascending.
    score
        Extended BIC; lower is better. Differences of 6 are strong, of 10 decisive evidence.
    solved
        The least-squares solution.
    plausible
        No parameter lies beyond its plausible range.
    variants
        By which of its variants each effect entered, see `Regression.variants`.
    """

    effects: tuple[int, ...]
    score: float
    solved: Solved
    plausible: bool
    variants: tuple[int, ...]


def score_set(
    regression: Regression, sums: Sums, effects: Iterable[int], *, untied: int | None = None
) -> Scored:
    """Score the base model with some candidates added.

    Of every candidate the variant that scores best counts; `untied` names one that has to enter
    with all its parameters.
    """
    chosen = tuple(sorted(effects))
    best: Scored | None = None
    sizes: tuple[float, ...] = DRAWN_SIZES
    drawn = [regression.columns[e] for e in chosen if regression.candidates[e].exchangeable]
    choices = (range(1 if e == untied else len(regression.variants[e])) for e in chosen)
    for variants in product(*choices):
        parts = [
            regression.variants[e][k]
            for e, k in zip(chosen, variants, strict=True)
            if not regression.candidates[e].exchangeable
        ]
        if drawn:
            solved, score, size = _with_draws(regression, sums, parts, drawn, sizes)
            sizes = (size,)  # hardly goes with the law of another effect
        else:
            solved, score = _with_parts(regression, sums, parts)
        added = ~regression.in_base[solved.columns]
        limits = regression.plausible[solved.columns[added]]
        plausible = bool((np.abs(solved.values[added]) <= limits).all())
        score += sum(_price_of_choice(regression, e, tied=e != untied) for e in chosen)
        if best is None or (plausible, -score) > (best.plausible, -best.score):
            best = Scored(chosen, score, solved, plausible, variants)
    if best is None:
        raise ValueError("a model without variants")
    return best


def _price_of_choice(regression: Regression, effect: int, *, tied: bool) -> float:
    """What an effect pays for the variants that are open to it, and for being less usual."""
    count = len(regression.variants[effect]) if tied else 1
    return 2.0 * float(np.log(count)) + regression.candidates[effect].less_usual


def _with_parts(regression: Regression, sums: Sums, parts: Sequence[Index]) -> tuple[Solved, float]:
    """Solution and score of the base model with the columns of some effects."""
    columns = np.concatenate([regression.base, *parts]).astype(np.intp)
    solved = solve_columns(sums, columns, regression.lower, regression.plausible)
    n = max(sums.count, 2.0)
    price = len(parts) * price_of_looking(regression, n) + _sizes(regression, sums, solved, parts)
    # A spring of the base model is there whether it moves or not: none is cheaper for being rigid.
    price += len(regression.base) * np.log(n)
    return solved, float(_misfit(regression, n, solved.rss) + price)


def _misfit(regression: Regression, n: float, rss: float) -> float:
    return float(rss if regression.sigma_known else n * np.log(max(rss, 1e-300) / n))


def _with_draws(
    regression: Regression,
    sums: Sums,
    parts: Sequence[Index],
    drawn: Sequence[Index],
    sizes: Sequence[float],
) -> tuple[Solved, float, float]:
    """Best solution and score over the common size of exchangeable parameters, and that size.

    Such parameters (`drawn`, beside the `parts` of other effects) pay by their marginal likelihood;
    that they exist at all is held against chance like one parameter, their size τ.
    """
    members = np.concatenate(drawn)
    flat = len(drawn) * (regression.least_fall + FLOOR)

    def at(size: float) -> tuple[float, Solved]:
        left = sums.marginal(members, size)
        rest, score = _with_parts(regression, left.sums, parts)
        return score + left.price + flat, rest

    tried = {size: at(size) for size in sizes}
    size = min(tried, key=lambda each: tried[each][0])
    score, rest = tried[size]
    return sums.marginal(members, size).joined(sums, rest), score, size


def price_of_looking(regression: Regression, rows: float) -> float:
    """What every effect pays because so many were looked at.

    With it, the fall of the misfit that one more parameter needs is the χ² quantile of alpha over
    the number of candidates (Bonferroni) and a little more.
    """
    needed = regression.least_fall + FLOOR
    return max(needed - price_of_sizes(needed, 1, rows), FLOOR)


def _sizes(regression: Regression, sums: Sums, solved: Solved, parts: Sequence[Index]) -> float:
    """What the sizes of the effects' parameters cost.

    An effect's gain is counted as if it stood alone beside the base model: two effects that undo
    each other's work at large sizes pay for these sizes.
    """
    if not parts:
        return 0.0
    n = max(sums.count, 2.0)
    variance = 1.0 if regression.sigma_known else max(solved.rss, 1e-300) / n
    base = solved.columns[regression.in_base[solved.columns]]
    price = 0.0
    for part in parts:
        inside = (solved.columns[:, None] == part).any(axis=1)
        own, values = solved.columns[inside], solved.values[inside]
        if len(own):
            signature = sums.gram[np.ix_(own, own)] @ values
            covered = sums.gram[np.ix_(base, own)] @ values
            gain = float(values @ signature - covered @ sums.over(base, covered)) / variance
            price += price_of_sizes(gain, len(own), n)
    return price


def entry_fall(regression: Regression, effect: int) -> float:
    """Fall of the misfit, in noise variances, at which an effect joins a model with all its sizes.

    It is the fall that equals the price of the effect, its sizes included.
    """
    count, rows = len(regression.columns[effect]), float(regression.rows)
    rest = price_of_looking(regression, rows) + _price_of_choice(regression, effect, tied=True)
    fall = rest
    for _ in range(PRICED):  # the price of sizes grows with the logarithm of the fall
        fall = rest + price_of_sizes(fall, count, rows)
    return fall


def price_of_sizes(gain: float, count: int, rows: float) -> float:
    """What `count` parameters cost that take `gain` away from the misfit of `rows` readings."""
    return float(count * min(np.log(rows), 1.0 + np.log(max(gain / count, 1.0))))
