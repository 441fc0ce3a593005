"""How well a set of effects explains the gap, in one number.

Models are scored by an extended Bayesian information criterion (after Chen & Chen 2008): the
misfit, plus a price for every parameter that moves, plus a price for every effect, which pays for
having looked at so many candidates.

What the sizes of parameters cost is told in `size_prices.py`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.explain.candidates.regression import Regression, price_of_choice
from sk120stiff.explain.candidates.sums import Marginal, Solutions, Solved, Sums, solve_sets
from sk120stiff.explain.select.size_prices import price_of_sizes, prices_of_sizes

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
    best = score_sets(regression, sums, [now], untied)[0]
    moving = [e for e in chosen if len(regression.variants[e]) > 1]
    moving = [e for e in moving if only is None or e in only]
    for _ in range(SWEEPS):
        before = best
        for e in moving:
            others = [
                now | {e: k}
                for k in range(len(regression.variants[e]))
                if k != now[e] and not (e == untied and k == regression.tied[e])
            ]
            tried = score_sets(regression, sums, others, untied)
            better = min(tried, key=lambda m: (not m.plausible, m.score), default=best)
            if (better.plausible, -better.score) > (best.plausible, -best.score):
                best = better
                now = best.by_variant
        if best is before or len(moving) == 1:
            break
    return best


def score_sets(
    regression: Regression,
    sums: Sums,
    sets: Sequence[Mapping[int, int]],
    untied: int | None = None,
) -> list[Scored]:
    """Score the base model with several sets of candidates, each by one of its variants.

    Args:
        regression, sums: Linearised readings, and the poses of them that count.
        sets: The variant of every candidate, ascending.
        untied: A candidate that has to enter with all its parameters.
    """
    last = (-1 if untied is None else untied, -1)
    keys = [np.array([*variants.items(), last]).tobytes() for variants in sets]
    alike: dict[tuple[tuple[int, ...], int], dict[bytes, Mapping[int, int]]] = {}
    for key, variants in zip(keys, sets, strict=True):
        if key not in sums.scores:
            drawn = tuple(e for e in variants if regression.candidates[e].random_effects)
            alike.setdefault((drawn, len(variants)), {})[key] = variants
    for (drawn, _), same in alike.items():
        several = [
            [regression.variants[e][k] for e, k in variants.items() if e not in drawn]
            for variants in same.values()
        ]
        if drawn:
            solutions = _with_draws(regression, sums, several, drawn)
        else:
            solutions = _with_parts(regression, sums, several)
        for (key, variants), (solved, score) in zip(same.items(), solutions, strict=True):
            plausible = regression.is_believed(solved)
            score += sum(_of_choice(regression, e, k, e != untied) for e, k in variants.items())
            chosen, laws = tuple(variants), tuple(variants.values())
            sums.scores[key] = Scored(chosen, float(score), solved, plausible, laws)
    return [sums.scores[key] for key in keys]


def _of_choice(regression: Regression, effect: int, variant: int, tied: bool) -> float:
    if tied:
        return float(regression.prices_of_choice[effect][variant])
    return price_of_choice(regression, effect, variant, tied=False)


def _with_parts(
    regression: Regression, sums: Sums, several: Sequence[Sequence[Index]]
) -> list[tuple[Solved, float]]:
    """Solution and score of the base model with the columns of some effects, for several such."""
    base = regression.base
    sets = [np.concatenate([base, *parts]) for parts in several]
    solved = solve_sets(sums, sets, regression.lower, regression.plausible)
    n = max(sums.count, 2.0)
    # A spring of the base model is there whether it moves or not: none is cheaper for being rigid.
    score = _Left.by(regression, sums, solved).deviance(regression) + len(base) * np.log(n)
    score += price_of_looking(regression, n) * np.array([len(parts) for parts in several])
    score += prices_of_sizes(regression, sums, solved, several)
    return list(zip(solved.each(), score.tolist(), strict=True))


class _Left(NamedTuple):
    """What solutions leave of the rows whose noise counts, and of those of model-form error.

    Attributes:
        rss, rows: Misfit of the first, and how many they are.
        form, form_rows: The same of the others; no rows where there is no such error.
    """

    rss: Array
    rows: float
    form: Array
    form_rows: float

    @classmethod
    def by(cls, regression: Regression, sums: Sums, solved: Solved | Solutions) -> _Left:
        """By one solution, or by each of several."""
        rss, rows = np.asarray(solved.rss), max(sums.count, 2.0)
        if regression.form is None or sums.form is None or not sums.form.count:
            return cls(rss, rows, np.zeros(rss.shape), 0.0)
        form = np.maximum(sums.form.left_by(solved), 0.0)
        return cls(np.maximum(rss - form, 0.0), rows - sums.form.count, form, sums.form.count)

    def deviance(self, regression: Regression) -> Array:
        """-2 ln L up to a constant, at the likeliest variances of what nobody stated."""
        own = np.zeros(np.shape(self.form))
        if regression.form is not None and self.form_rows:
            size = np.maximum(self.form / self.form_rows, regression.form.noise_share)
            own = self.form_rows * np.log(size) + self.form / size
        if regression.sigma_known or self.rows < 1.0:
            return own + self.rss
        n = self.rows
        return np.asarray(own + n * np.log(np.maximum(self.rss, 1e-300) / n) + n)


def unit(regression: Regression, model: Scored) -> float:
    """Noise variance over the one assumed; where nobody stated it, what the model leaves tells."""
    if regression.sigma_known:
        return 1.0
    return max(model.solved.rss / max(regression.rows - len(model.solved.columns), 1), 1e-300)


def most_fallen(regression: Regression, sums: Sums, model: Solved, falls: Array) -> Array:
    """By how much -2 ln L of a model falls at most where its misfit falls so much (k,).

    Where a size is estimated by every model for itself, of the noise or of model-form error, its
    logarithm may fall faster than the misfit: fastest where one kind of rows has the whole fall.
    """
    left = _Left.by(regression, sums, model)
    both = [
        left._replace(rss=np.maximum(left.rss - falls, 0.0)),
        left._replace(form=np.maximum(left.form - falls, 0.0)),
    ]
    fallen = [left.deviance(regression) - each.deviance(regression) for each in both]
    return np.maximum(*fallen)


def _with_draws(
    regression: Regression, sums: Sums, several: Sequence[Sequence[Index]], drawn: Sequence[int]
) -> list[tuple[Solved, float]]:
    """Best solutions and scores over the common size of random_effects parameters.

    Such parameters (`drawn`, beside the parts of other effects) pay by their marginal likelihood;
    that they exist at all is held against chance like one parameter, their size τ.
    """
    members = np.concatenate([regression.columns[e] for e in drawn])
    flat = len(drawn) * (regression.least_fall + FLOOR)

    def at(left: Marginal, several: Sequence[Sequence[Index]]) -> list[tuple[Solved, float]]:
        price = left.price + flat
        return [
            (rest, score + price) for rest, score in _with_parts(regression, left.sums, several)
        ]

    # The size hardly goes with the laws of the other effects: the first of as many tells it.
    first = np.concatenate([regression.base, *several[0]])
    key = b"size" + np.append(members, len(several[0])).tobytes()
    if key not in sums.scores:
        sums.scores[key] = min(
            DRAWN_SIZES,
            key=lambda size: at(sums.marginal(members, size, first), several[:1])[0][1],
        )
    whole = sums.marginal(members, sums.scores[key])
    return [(whole.joined(sums, rest), score) for rest, score in at(whole, several)]


def price_of_looking(regression: Regression, rows: float) -> float:
    """What every effect pays because so many were looked at.

    With it, the fall of the misfit that one more parameter needs is the χ² quantile of alpha over
    the number of candidates (Bonferroni) and a little more.
    """
    needed = regression.least_fall + FLOOR
    return max(needed - float(price_of_sizes(needed, 1, rows)), FLOOR)


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
        fall = rest + float(price_of_sizes(fall, count, rows))
    return fall
