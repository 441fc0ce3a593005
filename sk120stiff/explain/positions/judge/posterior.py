"""How probable a chosen name is, and which others explain as much in its place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import expit

from sk120stiff.arrays import Array
from sk120stiff.explain.positions.select.choose import RIVAL, confirmed, frames_of, gain, usual
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.priors import FALLEN


def alternatives(linear: Linear, chosen: tuple[int, ...], e: int) -> tuple[tuple[int, ...], float]:
    """Candidates that explain as much in the place of one of the chosen, and its probability."""
    rivals, _, weight = _rivals(linear, chosen, e)
    return rivals, float(weight[:-1].sum() / weight.sum())


def of_all(linear: Linear, chosen: tuple[int, ...]) -> float:
    """Probability that what all of the chosen take off together is no part of an unknown cause.

    Of errors of geometry that stand for one another none is likely by itself.
    """
    if linear.errors is None:
        return 1.0
    odds = linear.errors.score(chosen) - linear.errors.score(())
    return float(expit(odds - np.log(len(linear.candidates) + 1.0)))


def standing(linear: Linear, chosen: tuple[int, ...], e: int) -> dict[str, float]:
    """Probability of one of the chosen, and of each that explains as much in its place.

    Together they have that of `alternatives`; among themselves they share it by their usual odds.
    """
    rivals, prior, weight = _rivals(linear, chosen, e)
    own = weight[:-1] * np.exp(prior)
    share = weight[:-1].sum() / weight.sum() * own / own.sum()
    names = [linear.candidates[c].id for c in (e, *rivals)]
    return dict(zip(names, map(float, share), strict=True))


def _rivals(
    linear: Linear, chosen: tuple[int, ...], e: int
) -> tuple[tuple[int, ...], list[float], Array]:
    """Rivals, their usual odds with those of the chosen one first, and weights, last of nothing.

    Evidence beyond that of the chosen one, which poses left out bear out, is no evidence where they
    do not: few readings far from all others make as much.
    """
    rest = linear.less(chosen, e)
    score = scores_beside(linear, chosen, rest)
    own, nothing = score(chosen), score(rest)
    frames = set(frames_of(linear))
    alone = e in frames and frames & set(rest)  # no frame is exact where others are off
    others = {
        c: score((*rest, c))
        for c in linear.may_join(rest)
        if c not in chosen and (not alone or c in frames)
    }
    rivals = tuple(
        c
        for c, there in others.items()
        if there + usual(linear.candidates[c]) > own + usual(linear.candidates[e]) - RIVAL
        and there > nothing
    )
    most = own + float(np.log(FALLEN))
    for c in rivals:
        if others[c] > most and not confirmed(gain(linear, (*rest, c), c), linear):
            others[c] = most
    scores = np.array([own, *(others[c] for c in rivals), nothing + np.log(len(others) + 1.0)])
    prior = [usual(linear.candidates[c]) for c in (e, *rivals)]
    weight = np.exp(scores - scores.max())
    narrow = float(weight[:-1].sum() / weight.sum())
    sure = _beside_what_every_arm_has(linear, chosen, (e, *rivals), narrow, len(others))
    doubt = (1.0 - sure) / max(sure, 1e-300)
    weight[-1] = doubt * weight[:-1].sum()
    return rivals, prior, weight


def scores_beside(
    linear: Linear, chosen: tuple[int, ...], *others: tuple[int, ...]
) -> Callable[[tuple[int, ...]], float]:
    """The evidence of sets beside what is left of the chosen, or beside errors that may be there.

    Args:
        linear: The positions linearised.
        chosen: A set.
        others: Sets like it, that have their say in which errors may be there.
    """
    if linear.errors is not None:
        return linear.errors.likeliest((chosen, *others)).score
    noise = linear.noise(chosen)
    return lambda each: linear.score(each, noise)


def _beside_what_every_arm_has(
    linear: Linear, chosen: tuple[int, ...], own: tuple[int, ...], narrow: float, others: int
) -> float:
    """Probability of a name, averaged over the chosen model and that with all frames and springs.

    Where few numbers are left over, those that nothing asked for may bring as much; where many are,
    they cost more than they explain, and do not count.

    Args:
        linear: The positions linearised.
        chosen: The causes of the answer.
        own: The name, and what explains as much in its place.
        narrow: Its probability where nothing else is at work.
        others: How many names were looked at in its place.
    """
    springs = (c for c, effect in enumerate(linear.candidates) if effect.joint_spring)
    usual_ones = [c for c in (*frames_of(linear), *springs) if c not in (*chosen, *own)]
    if not usual_ones:
        return narrow
    wide = (*chosen, *usual_ones)
    without = linear.less(wide, own[0])
    sets = chosen, wide, without
    if linear.errors is None:
        scores = [linear.score(each, linear.noise(each)) for each in sets]
    else:
        scores = [linear.errors.score(each) for each in sets]
    taken = 1.0 / (1.0 + np.exp(np.clip(scores[2] + np.log(others + 1.0) - scores[1], -50, 50)))
    share = 1.0 / (1.0 + np.exp(np.clip(scores[0] - scores[1], -50.0, 50.0)))
    return float((1.0 - share) * narrow + share * min(taken, narrow))
