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

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Index
from sk120stiff.explain.candidates.regression import Regression, price_of_choice
from sk120stiff.explain.candidates.sums import Solved, Sums, solve_columns

FLOOR = 2.0  # least difference of scores for which an effect joins a model
PRICED = 50  # rounds in which a fall and its own price agree; each gains a digit
SWEEPS = 2  # over the candidates of a model, to settle their variants
DRAWN_SIZES = (0.7, 1.5, 3.0, 6.0)  # standard deviations tried, in typical sizes


@dataclass(frozen=True, eq=False)
class Scored:
    """A set of candidate effects with its score.

    Attributes:
        effects: Positions in `Regression.candidates`, ascending.
        score: Extended BIC; lower is better. Differences of 6 are strong, of 10 decisive evidence.
        solved: The least-squares solution.
        plausible: No parameter lies beyond its plausible range.
        variants: By which of its variants each effect entered, see `Regression.variants`.
    """

    effects: tuple[int, ...]
    score: float
    solved: Solved
    plausible: bool
    variants: tuple[int, ...]

    @property
    def by_variant(self) -> dict[int, int]:
        """The variant of each effect."""
        return dict(zip(self.effects, self.variants, strict=True))


def score_set(
    regression: Regression,
    sums: Sums,
    effects: Iterable[int],
    *,
    untied: int | None = None,
    start: Mapping[int, int] | None = None,
    only: Collection[int] | None = None,
) -> Scored:
    """Score the base model with some candidates added.

    Of every candidate the variant that scores best counts, found one candidate after the other
    until none changes.

    Args:
        regression, sums: Linearised readings, and the poses of them that count.
        effects: Candidates in the model.
        untied: One that has to enter with all its parameters.
        start: Variant of each candidate to begin with; the first one of those that are not in it.
        only: Candidates whose variants are tried; the others keep theirs. None: of all.
    """
    chosen = tuple(sorted(effects))
    known = start or {}
    now = {e: known.get(e, 0) for e in chosen}
    if untied is not None and now[untied] == regression.tied[untied]:
        now[untied] = 0
    best = _at(regression, sums, now, untied)
    moving = [e for e in chosen if len(regression.variants[e]) > 1]
    moving = [e for e in moving if only is None or e in only]
    for _ in range(SWEEPS):
        before = best
        for e in moving:
            tried = [
                _at(regression, sums, now | {e: k}, untied)
                for k in range(len(regression.variants[e]))
                if k != now[e] and not (e == untied and k == regression.tied[e])
            ]
            better = min(tried, key=lambda m: (not m.plausible, m.score), default=best)
            if (better.plausible, -better.score) > (best.plausible, -best.score):
                best = better
                now = best.by_variant
        if best is before or len(moving) == 1:
            break
    return best


def _at(
    regression: Regression, sums: Sums, variants: Mapping[int, int], untied: int | None
) -> Scored:
    """Score the base model with some candidates, each by one of its variants."""
    chosen = tuple(variants)
    key = np.array([*variants.items(), (-1 if untied is None else untied, -1)]).tobytes()
    if key in sums.scores:
        found: Scored = sums.scores[key]
        return found
    parts = [
        regression.variants[e][k]
        for e, k in variants.items()
        if not regression.candidates[e].random_effects
    ]
    drawn = [regression.columns[e] for e in chosen if regression.candidates[e].random_effects]
    if drawn:
        solved, score = _with_draws(regression, sums, parts, drawn)
    else:
        solved, score = _with_parts(regression, sums, parts)
    added = ~regression.in_base[solved.columns]
    limits = regression.plausible[solved.columns[added]]
    plausible = bool((np.abs(solved.values[added]) <= limits).all())
    score += sum(_of_choice(regression, e, k, e != untied) for e, k in variants.items())
    made = Scored(chosen, float(score), solved, plausible, tuple(variants.values()))
    sums.scores[key] = made
    return made


def _of_choice(regression: Regression, effect: int, variant: int, tied: bool) -> float:
    if tied:
        return float(regression.prices_of_choice[effect][variant])
    return price_of_choice(regression, effect, variant, tied=False)


def _with_parts(regression: Regression, sums: Sums, parts: Sequence[Index]) -> tuple[Solved, float]:
    """Solution and score of the base model with the columns of some effects."""
    columns = np.concatenate([regression.base, *parts]).astype(np.intp)
    solved = solve_columns(sums, columns, regression.lower, regression.plausible)
    n = max(sums.count, 2.0)
    price = len(parts) * price_of_looking(regression, n) + _sizes(regression, sums, solved, parts)
    # A spring of the base model is there whether it moves or not: none is cheaper for being rigid.
    price += len(regression.base) * np.log(n)
    return solved, _deviance(regression, sums, solved) + price


def _deviance(regression: Regression, sums: Sums, solved: Solved) -> float:
    """-2 ln L up to a constant, at the likeliest variances of what nobody stated."""
    rss, n = solved.rss, max(sums.count, 2.0)
    own = 0.0
    if regression.form is not None and sums.form is not None and sums.form.count:
        left, count = max(sums.form.left_by(solved), 0.0), sums.form.count
        size = max(left / count, regression.form.noise_share)
        own = count * float(np.log(size)) + left / size
        rss, n = max(rss - left, 0.0), n - count
    if regression.sigma_known or n < 1.0:
        return own + rss
    return own + n * float(np.log(max(rss, 1e-300) / n)) + n


def _with_draws(
    regression: Regression, sums: Sums, parts: Sequence[Index], drawn: Sequence[Index]
) -> tuple[Solved, float]:
    """Best solution and score over the common size of random_effects parameters.

    Such parameters (`drawn`, beside the `parts` of other effects) pay by their marginal likelihood;
    that they exist at all is held against chance like one parameter, their size τ.
    """
    members = np.concatenate(drawn)
    flat = len(drawn) * (regression.least_fall + FLOOR)

    def at(size: float) -> tuple[float, Solved]:
        left = sums.marginal(members, size)
        rest, score = _with_parts(regression, left.sums, parts)
        return score + left.price + flat, rest

    # The size hardly goes with the laws of the other effects: the first of as many tells it.
    key = b"size" + np.append(members, len(parts)).tobytes()
    tried = {size: at(size) for size in sums.scores.get(key, DRAWN_SIZES)}
    size = min(tried, key=lambda each: tried[each][0])
    sums.scores[key] = (size,)
    score, rest = tried[size]
    return sums.marginal(members, size).joined(sums, rest), score


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
    known = regression.sigma_known and regression.form is None
    variance = 1.0 if known else max(solved.rss, 1e-300) / n
    added = ~regression.in_base[solved.columns]
    base, own, values = solved.columns[~added], solved.columns[added], solved.values[added]
    across = sums.gram[base[:, None], own]
    left = sums.gram[own[:, None], own] - across.T @ sums.over(base, across)
    owner = np.zeros(len(regression.in_base), dtype=np.intp)
    for k, part in enumerate(parts):
        owner[part] = k
    members = (owner[own][:, None] == np.arange(len(parts))) * values[:, None]
    gains = (members * (left @ members)).sum(axis=0) / variance
    counts = np.bincount(owner[own], minlength=len(parts))
    return sum(
        price_of_sizes(gain, count, n)
        for gain, count in zip(gains.tolist(), counts.tolist(), strict=True)
        if count
    )


def entry_fall(regression: Regression, effect: int) -> float:
    """Fall of the misfit, in noise variances, at which an effect joins a model with all its sizes.

    It is the fall that equals the price of the effect, its sizes included.
    """
    count, rows = len(regression.columns[effect]), float(regression.rows)
    rest = price_of_looking(regression, rows) + price_of_choice(
        regression, effect, regression.usual[effect]
    )
    fall = rest
    for _ in range(PRICED):  # the price of sizes grows with the logarithm of the fall
        fall = rest + price_of_sizes(fall, count, rows)
    return fall


def price_of_sizes(gain: float, count: int, rows: float) -> float:
    """What `count` parameters cost that take `gain` away from the misfit of `rows` readings."""
    return float(count * min(np.log(rows), 1.0 + np.log(max(gain / count, 1.0))))
