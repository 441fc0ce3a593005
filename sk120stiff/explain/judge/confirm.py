"""Does a name survive other poses: those left out of the fit, and those drawn again?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression, Sums
from sk120stiff.explain.findings import Confirmation
from sk120stiff.explain.select.beam import gains
from sk120stiff.explain.select.score import score_set
from sk120stiff.identify import drawn_parts

FOLDS = 5
RESAMPLES = 100


#: Of an effect that other poses were not asked about; it does not hold.
UNTRIED = Confirmation(0, 1, 0.0, np.inf, 0.0, 0.0)


def confirm(
    regression: Regression,
    model: tuple[int, ...],
    effect: int,
    alternatives: Collection[int],
    *,
    seed: int = 0,
) -> Confirmation:
    """Cross-validate and resample one effect of a model.

    Parameters
    ----------
    regression
        Linearised readings.
    model
        Candidates in the model.
    effect
        The one in question, part of `model`.
    alternatives
        Candidates that count as the same answer.
    seed
        Of the folds and the resampling.
    """
    rng = np.random.default_rng(seed)
    per_pose = _held_out_gain(regression, model, effect, rng)
    fold_gain, pose_gain, axes = per_pose
    folds = len(fold_gain)
    error = float(pose_gain.std(ddof=1) * np.sqrt(len(pose_gain))) if len(pose_gain) > 1 else np.inf
    same = {effect, *alternatives}
    rest = tuple(e for e in model if e != effect)
    wins = Counter(
        _winner(regression, rest, same, _resampled(regression, rng)) for _ in range(RESAMPLES)
    )
    own = sum(count for winner, count in wins.items() if winner in same)
    rivals = [count for winner, count in wins.items() if winner not in same and winner is not None]
    return Confirmation(
        folds_improved=int((fold_gain > 0.0).sum()),
        folds=folds,
        gain=float(pose_gain.sum() / axes),
        gain_error=error / axes,
        frequency=own / RESAMPLES,
        rival_frequency=max(rivals, default=0) / RESAMPLES,
        foretells=not regression.candidates[effect].exchangeable,
    )


def _held_out_gain(
    regression: Regression, model: tuple[int, ...], effect: int, rng: np.random.Generator
) -> tuple[Array, Array, float]:
    """Fall of the held-out misfit by fold and by pose, and the number of reading axes."""
    fold = drawn_parts(regression.poses, FOLDS, rng)
    smaller = tuple(e for e in model if e != effect)
    pose_gain = np.zeros(regression.poses)
    for k in range(int(fold.max(initial=0)) + 1):
        train = regression.sums((fold != k).astype(float))
        misfit = []
        for effects in (smaller, model):
            solved = score_set(regression, train, effects).solved
            v = np.zeros(regression.X.shape[1])
            v[solved.columns] = solved.values
            rest = regression.y - regression.X @ v
            misfit.append(np.bincount(regression.group, rest**2, regression.poses)[fold == k])
        pose_gain[fold == k] = misfit[0] - misfit[1]
    fold_gain = np.array([pose_gain[fold == k].sum() for k in range(int(fold.max(initial=0)) + 1)])
    return fold_gain, pose_gain, float(regression.rows)


def _resampled(regression: Regression, rng: np.random.Generator) -> Sums:
    draw = rng.integers(0, regression.poses, regression.poses)
    return regression.sums(np.bincount(draw, minlength=regression.poses).astype(float))


def _winner(
    regression: Regression, rest: tuple[int, ...], same: Collection[int], sums: Sums
) -> int | None:
    """The best single effect to add to `rest` on these poses; None if none is plausible."""
    promise = gains(regression, sums, score_set(regression, sums, rest).solved)
    order = [int(e) for e in np.argsort(-promise) if int(e) not in rest][:8]
    contenders = {*same, *(e for e in order if not regression.candidates[e].exchangeable)}
    scored = {e: score_set(regression, sums, (*rest, e)) for e in contenders}
    fair = {e: model.score for e, model in scored.items() if model.plausible}
    return min(fair, key=lambda e: fair[e], default=None)
