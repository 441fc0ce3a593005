"""What the sizes of parameters cost in the score of a model.

A parameter of the base model costs ln R. The k parameters of an effect together cost what their
marginal likelihood asks for when they are drawn from one distribution whose width the readings
tell: k (1 + ln(G/k)), with G the misfit that the effect takes away (MacKay 1992), and never more
than k ln R. So six weak parameters of one sensor may be seen where they are significant together,
and the level of a chance finding is the same for an effect of one parameter and for one of six.

A value that is physically bounded, as a compliance is, may lie on its bound of zero. Whether it
does or stays a hair above is chance where the readings do not show it, so it is held at zero where
the misfit grows by less than the price falls, that of the choice among an effect's values included:
no model is dearer than its neighbour for a hair.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import comb

from sk120stiff.arrays import Array, Index
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.candidates.sums import Solutions, Sums


def price_of_sizes(gain: ArrayLike, count: ArrayLike, rows: float) -> Array:
    """What `count` parameters cost that take `gain` away from the misfit of `rows` readings."""
    each = np.maximum(gain / np.maximum(count, 1), 1.0)
    return np.asarray(count * np.minimum(np.log(rows), 1.0 + np.log(each)))


def prices_of_sizes(
    regression: Regression, sums: Sums, solved: Solutions, several: Sequence[Sequence[Index]]
) -> Array:
    """What the sizes of the effects' parameters cost in each of several models.

    An effect's gain is counted as if it stood alone beside the base model: two effects that undo
    each other's work at large sizes pay for these sizes.
    """
    n, base = max(sums.count, 2.0), regression.base
    known = regression.sigma_known and regression.form is None
    variance = np.ones((len(several), 1)) if known else np.maximum(solved.rss, 1e-300)[:, None] / n
    own, moves = solved.columns[:, len(base) :], solved.moves[:, len(base) :]
    lengths = [[len(part) for part in parts] for parts in several]
    owner = np.full(own.shape, -1)
    for row, each in zip(owner, lengths, strict=True):
        row[: sum(each)] = np.repeat(np.arange(len(each)), each)
    most = max(len(each) for each in lengths)
    mine = (owner[:, :, None] == np.arange(most)) & moves[:, :, None]  # (m, own, effects)
    members = mine * solved.values[:, len(base) :, None]
    within = sums.gram[own[:, :, None], own[:, None, :]] @ members
    across = sums.gram[base[:, None], own[:, None, :]] @ members
    inverse = np.stack([sums.inverse(base, some) for some in solved.moves[:, : len(base)]])
    gains = (members * within).sum(axis=1) - (across * (inverse @ across)).sum(axis=1)
    gains, counts = gains / variance, mine.sum(axis=1)
    prices = price_of_sizes(gains, counts, n)
    bounded = mine & (regression.lower[own] == 0.0)[:, :, None] & (counts > 1)[:, None, :]
    scatter = _scatter(regression, sums, solved)
    growth = solved.values**2 / np.diagonal(scatter, axis1=1, axis2=2) / variance
    least = np.where(bounded, growth[:, len(base) :, None], np.inf).min(axis=1, initial=np.inf)
    for row, effect in np.argwhere(least < prices):
        places = len(base) + np.flatnonzero(bounded[row, :, effect])
        spent = _held_in_turn(scatter[row], solved.values[row], places) / variance[row]
        count, held = counts[row, effect], np.arange(1, len(spent) + 1)
        spent, held = spent[held < count], held[held < count]
        gain = np.maximum(gains[row, effect] - spent, 0.0)
        fewer = spent + price_of_sizes(gain, count - held, n) + 2.0 * np.log(comb(count, held))
        prices[row, effect] = min(prices[row, effect], fewer.min())
    return np.asarray(prices.sum(axis=1))


def _scatter(regression: Regression, sums: Sums, solved: Solutions) -> Array:
    """(m, k, k) covariance of the values that move, in units of the noise; else the identity."""
    columns, moves = solved.columns, solved.moves
    gram = sums.gram[columns[:, :, None], columns[:, None, :]]
    gram[~(moves[:, :, None] & moves[:, None, :])] = 0.0
    each = np.arange(columns.shape[1])
    gram[:, each, each] += np.where(moves, regression.plausible[columns] ** -2.0, 1.0)
    scale = 1.0 / np.sqrt(gram[:, each, each])
    both = scale[:, :, None] * scale[:, None, :]
    return np.asarray(np.linalg.inv(gram * both) * both)


def _held_in_turn(scatter: Array, values: Array, places: Index) -> Array:
    """Growth of the misfit as values at some places are held at zero, the least first, the others
    moving on."""
    scatter, values, left = scatter.copy(), values.copy(), list(places)
    growth = []
    while left:
        each = [values[k] ** 2 / scatter[k, k] for k in left]
        k = left.pop(int(np.argmin(each)))
        growth.append(min(each))
        values -= scatter[k] * (values[k] / scatter[k, k])
        scatter -= np.outer(scatter[k], scatter[k]) / scatter[k, k]
    return np.cumsum(growth)
