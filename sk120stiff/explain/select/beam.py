"""Which set of effects explains the gap best: a beam search over models of the catalogue."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression, Solved, Sums
from sk120stiff.explain.select.score import Scored, score_set

BEAM = 12


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
    for e, columns in enumerate(regression.reach):
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
