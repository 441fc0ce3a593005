"""Does a name survive other poses: those left out of the fit, and those drawn again?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection
from functools import partial

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.candidates.sums import Sums
from sk120stiff.explain.findings import Confirmation, Finding
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import Scored, score_set, score_sets
from sk120stiff.identify import drawn_parts

FOLDS = 5  # parts in which poses are left out, as is usual
RESAMPLES = 100  # at most
RIVALS = 8  # for a place in the model, on every drawing
LIKELY = 2 * RIVALS  # rivals by all poses, of which each drawing has its own
ENOUGH = 10  # after which the drawings may be decided: ten of ten are
MOSTLY, SELDOM = 0.5, 0.33  # share of the drawings that a name wins, or that is too few
WANTED = 6.0  # evidence from which on an effect is wanted beside what beats it
SURE = 1e-3  # probability that more drawings would decide otherwise

#: Of an effect that other poses were not asked about; it does not hold.
UNTRIED = Confirmation(0, 1, 0.0, np.inf, 0.0, 0.0)


def confirm(
    regression: Regression,
    model: Scored,
    effect: int,
    alternatives: Collection[int],
    *,
    seed: int = 0,
) -> Confirmation:
    """Cross-validate and resample one effect of a model.

    Args:
        regression: Linearised readings.
        model: The model, whose laws all keep but that of the effect.
        effect: The one in question, part of `model`.
        alternatives: Candidates that count as the same answer.
        seed: Of the folds and the resampling.
    """
    rng = np.random.default_rng(seed)
    same = {effect, *alternatives}
    weigh = regression.weighing(_in_question(regression, model, effect, same))
    per_pose = _held_out_gain(regression, weigh, model, effect, rng)
    fold_gain, pose_gain, error, axes = per_pose
    folds = len(fold_gain)
    wins: Counter[int | None] = Counter()
    for count in range(1, RESAMPLES + 1):
        drawn = _resampled(weigh, regression.poses, rng)
        wins[_winner(regression, model, effect, same, drawn)] += 1
        own = sum(times for winner, times in wins.items() if winner in same)
        if count % ENOUGH == 0 and _decided(own, count):
            break
    others = {
        regression.candidates[winner].id: times / count
        for winner, times in wins.items()
        if winner not in same and winner is not None
    }
    return Confirmation(
        folds_improved=int((fold_gain > 0.0).sum()),
        folds=folds,
        gain=float(pose_gain.sum() / axes),
        gain_error=(error if len(pose_gain) > 1 else np.inf) / axes,
        frequency=own / count,
        rival_frequency=max(others.values(), default=0.0),
        foretells=not regression.candidates[effect].random_effects,
        others=others,
    )


def _in_question(
    regression: Regression, model: Scored, effect: int, same: Collection[int]
) -> Index:
    """Columns of all that may take the place of an effect on some drawing of the poses."""
    rest = tuple(e for e in model.effects if e != effect)
    sums = regression.sums()
    beside = score_set(regression, sums, rest, start=model.by_variant, only=())
    order = np.argsort(-promises(regression, sums, beside.solved).most).tolist()
    likely = {*same, *model.effects, *[e for e in order if e not in rest][:LIKELY]}
    parts = [part for e in likely for part in regression.variants[e]]
    return np.unique(np.concatenate([regression.base, *parts]))


def _decided(own: int, count: int) -> bool:
    """Can more drawings hardly change whether the name wins in half of them (Clopper & Pearson)?"""
    low = float(stats.beta.ppf(SURE, own, count - own + 1)) if own else 0.0
    high = float(stats.beta.isf(SURE, own + 1, count - own)) if own < count else 1.0
    return low > MOSTLY or high < SELDOM


def _held_out_gain(
    regression: Regression,
    weigh: Callable[[Array], Sums],
    model: Scored,
    effect: int,
    rng: np.random.Generator,
) -> tuple[Array, Array, float, float]:
    """Fall of the held-out misfit by fold and by pose, its error, and the number of reading axes.

    Squares fall by 2 a d + d², where a is left and d was taken off; the error is that of the first
    term over the poses. That d differs from pose to pose, with some that show the effect best, is
    no doubt of it.
    """
    fold = drawn_parts(regression.poses, FOLDS, rng)
    smaller = tuple(e for e in model.effects if e != effect)
    left, taken = np.zeros(len(regression.y)), np.zeros(len(regression.y))
    for k in range(int(fold.max(initial=0)) + 1):
        train, there = weigh((fold != k).astype(float)), fold[regression.group] == k
        rests = []
        for effects in (smaller, model.effects):
            solved = score_set(
                regression, train, effects, start=model.by_variant, only=(effect,)
            ).solved
            v = np.zeros(regression.X.shape[1])
            v[solved.columns] = solved.values
            rests.append((regression.y - regression.X @ v)[there])
        left[there], taken[there] = rests[1], rests[0] - rests[1]
    by_pose = partial(np.bincount, regression.group, minlength=regression.poses)
    pose_gain = np.asarray(by_pose((2.0 * left + taken) * taken), dtype=float)
    error = 2.0 * float(np.linalg.norm(by_pose(left * taken)))
    fold_gain = np.array([pose_gain[fold == k].sum() for k in range(int(fold.max(initial=0)) + 1)])
    return fold_gain, pose_gain, error, float(regression.rows)


def _resampled(weigh: Callable[[Array], Sums], poses: int, rng: np.random.Generator) -> Sums:
    draw = rng.integers(0, poses, poses)
    return weigh(np.bincount(draw, minlength=poses).astype(float))


def _winner(
    regression: Regression, model: Scored, effect: int, same: Collection[int], sums: Sums
) -> int | None:
    """The best in the place of one effect on these poses; None if none is plausible.

    What beats the effect and leaves it strong evidence beside itself explains something else: the
    place is the effect's then.
    """
    rest = tuple(e for e in model.effects if e != effect)
    start = model.by_variant
    beside = score_set(regression, sums, rest, start=start, only=())
    promised = promises(regression, sums, beside.solved)
    order = [int(e) for e in np.argsort(-promised.most) if int(e) not in rest][:RIVALS]
    contenders = {*same, *(e for e in order if not regression.candidates[e].random_effects)}
    likely = [beside.by_variant | {e: promised.likeliest(e)} for e in contenders]
    sets = [dict(sorted(variants.items())) for variants in likely]
    scored = dict(zip(contenders, score_sets(regression, sums, sets), strict=True))
    for e, laws in zip(contenders, sets, strict=True):
        if not scored[e].plausible:  # another law of it may be
            scored[e] = score_set(regression, sums, laws, start=laws, only=(e,))
    fair = {e: model.score for e, model in scored.items() if model.plausible}
    best = min(fair, key=lambda e: fair[e], default=None)
    if best is None or best in same or effect not in fair:
        return best
    laws = start | scored[best].by_variant | {effect: scored[effect].by_variant[effect]}
    both = score_set(regression, sums, (*rest, best, effect), start=laws, only=())
    return effect if both.plausible and fair[best] - both.score > WANTED else best


def unconfirmed(finding: Finding) -> str:
    """Why a name falls by what other poses say of it, in a sentence."""
    seen = finding.evidence.confirmation
    if seen.holds:
        return (
            f"{finding.effect.id} fits, but what it takes off at poses left out the scatter of the "
            f"rest takes off as often as not (p = {seen.chance:.2f}); it is not named."
        )
    folds = f"better in {seen.folds_improved} of {seen.folds} folds, " if seen.foretells else ""
    return (
        f"{finding.effect.id} fits best, but other poses do not confirm it ({folds}the same name "
        f"in {100.0 * seen.frequency:.0f} % of resamplings, the next in "
        f"{100.0 * seen.rival_frequency:.0f} %); it is not named."
    )
