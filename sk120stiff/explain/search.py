"""Which set of effects explains the gap best: a beam search over models of the catalogue.

Models are scored by an extended Bayesian information criterion (after Chen & Chen 2008): the
misfit, plus ln R for every parameter that moves, plus a price for every effect, which pays for
having looked at so many candidates.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from sk120stiff.explain.regression import Index, Regression, Solved, Sums, solve_columns
from sk120stiff.robot.coupling import Array

BEAM = 12
LESS_USUAL = {"joint_tilt": 1.0}  # breaks ties: an arm rocks on its floor more often than it tilts
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
        By which of its variants each effect entered; 0 has all its parameters, 1 ties some.
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
    drawn = [e for e in chosen if regression.candidates[e].exchangeable]
    choices = (range(1 if e == untied else len(regression.variants[e])) for e in chosen)
    for variants in product(*choices):
        parts = [regression.variants[e][k] for e, k in zip(chosen, variants, strict=True)]
        columns = np.concatenate([regression.base, *parts]).astype(np.intp)
        if drawn:
            solved, score = _with_draws(regression, sums, columns, drawn, len(chosen))
        else:
            solved = solve_columns(sums, columns, regression.lower, regression.plausible)
            score = _score(regression, sums, solved, len(chosen))
        added = ~np.isin(solved.columns, regression.base)
        size = np.abs(solved.values[added])
        plausible = bool((size <= regression.plausible[solved.columns[added]]).all())
        score += sum(LESS_USUAL.get(regression.candidates[e].name, 0.0) for e in chosen)
        if best is None or (plausible, -score) > (best.plausible, -best.score):
            best = Scored(chosen, score, solved, plausible, variants)
    if best is None:
        raise ValueError("a model without variants")
    return best


def _score(regression: Regression, sums: Sums, solved: Solved, effects: int) -> float:
    n = max(sums.count, 2.0)
    looked = regression.price_of_looking(n)
    return float(
        _misfit(regression, n, solved.rss) + len(solved.columns) * np.log(n) + effects * looked
    )


def _misfit(regression: Regression, n: float, rss: float) -> float:
    return float(rss if regression.sigma_known else n * np.log(max(rss, 1e-300) / n))


def _with_draws(
    regression: Regression, sums: Sums, columns: Index, drawn: Sequence[int], effects: int
) -> tuple[Solved, float]:
    """Best solution and score over the common size of exchangeable parameters.

    Such parameters pay by their marginal likelihood, and one parameter for their size τ.
    """
    members = np.concatenate([regression.columns[e] for e in drawn])
    others = np.setdiff1d(columns, members)
    n = max(sums.count, 2.0)
    looked = regression.price_of_looking(n)
    best: tuple[Solved, float] | None = None
    for size in DRAWN_SIZES:
        left = sums.marginal(members, size)
        rest = solve_columns(left.sums, others, regression.lower, regression.plausible)
        score = _misfit(regression, n, rest.rss) + left.price + effects * looked
        score += (len(rest.columns) + len(drawn)) * np.log(n)
        if best is None or score < best[1]:
            best = (left.joined(sums, rest), float(score))
    if best is None:
        raise ValueError("no sizes to try")
    return best


def gains(regression: Regression, sums: Sums, model: Solved) -> Array:
    """(candidates,) upper bound on the misfit that each candidate could take away from a model.

    One projection serves all candidates: with S the columns of one candidate and M projecting out
    the model, the gain is ‖orth(M S)ᵀ r‖².
    """
    inside = model.columns
    gram_in = sums.gram[np.ix_(inside, inside)] + np.diag(regression.plausible[inside] ** -2.0)
    cross = sums.gram[inside]
    scale = np.sqrt(np.maximum(np.diag(gram_in), 1e-300))
    solved = np.linalg.solve(gram_in / np.outer(scale, scale), cross / scale[:, None])
    projected = sums.gram - (cross / scale[:, None]).T @ solved
    residual = sums.moment - solved.T @ (sums.moment[inside] / scale)
    out = np.zeros(len(regression.candidates))
    for e, columns in enumerate(regression.columns):
        block = projected[np.ix_(columns, columns)]
        size = np.sqrt(np.maximum(np.diag(sums.gram)[columns], 1e-300))
        values, vectors = np.linalg.eigh(block / np.outer(size, size))
        seen = values > 1e-9
        along = vectors[:, seen].T @ (residual[columns] / size)
        out[e] = float((along**2 / values[seen]).sum())
    return out


def beam_search(
    regression: Regression,
    *,
    sums: Sums | None = None,
    width: int = BEAM,
    max_effects: int = 4,
    fixed: Iterable[int] = (),
) -> list[Scored]:
    """The best models met, best first; the base model is always among them.

    Parameters
    ----------
    regression
        Linearised readings.
    sums
        A choice of poses; all of them by default.
    width
        Models kept at each size.
    max_effects
        Largest number of effects.
    fixed
        Candidates that are part of every model.
    """
    total = sums or regression.sums()
    seen: dict[tuple[int, ...], Scored] = {}

    def scored(effects: Iterable[int]) -> Scored:
        key = tuple(sorted(effects))
        if key not in seen:
            seen[key] = score_set(regression, total, key)
        return seen[key]

    front = [scored(fixed)]
    for _ in range(max_effects - len(front[0].effects)):
        proposals: set[tuple[int, ...]] = set()
        for model in front:
            promise = gains(regression, total, model.solved)
            order = [int(e) for e in np.argsort(-promise) if int(e) not in model.effects]
            proposals |= {tuple(sorted((*model.effects, e))) for e in order[: 2 * width]}
        grown = [scored(effects) for effects in proposals]
        grown = sorted((m for m in grown if m.plausible), key=lambda m: m.score)[:width]
        if not grown:
            break
        best_before = min(
            (m.score for m in seen.values() if m.plausible and m not in grown), default=np.inf
        )
        front = grown
        # Larger models that lose to a smaller one by far have no future.
        if grown[0].score > best_before + 40.0:
            break
    for model in sorted(seen.values(), key=lambda m: m.score)[:width]:
        for e in model.effects:  # backward: what a later effect made superfluous
            if e not in set(fixed):
                scored(set(model.effects) - {e})
    return sorted((m for m in seen.values() if m.plausible), key=lambda m: m.score)
