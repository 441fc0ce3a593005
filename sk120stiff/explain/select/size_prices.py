"""What the sizes of parameters cost in the score of a model.

A parameter of the base model costs ln R. The k parameters of an effect together cost what their
marginal likelihood asks for when they are drawn from one distribution whose width the readings
tell: k (1 + ln(G/k)), with G the misfit that the effect takes away (MacKay 1992), and never more
than k ln R. So six weak parameters of one sensor may be seen where they are significant together,
and the level of a chance finding is the same for an effect of one parameter and for one of six.

A value that is physically bounded, as a compliance is, may lie on its bound of zero. Whether it
does or stays a hair above is chance where the readings do not show it, so it is held at zero where
the misfit grows by less than the price falls, which includes the choice among an effect's values.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

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
    if regression.form is None:  # else rows of two kinds count by two sizes
        bounded = mine & ((regression.lower[own] == 0.0)[:, :, None] & (counts > 1)[:, None])
        rows = np.flatnonzero(bounded.any(axis=(1, 2)))
        scatters = _scatters(regression, sums, solved, rows)
        spread = np.diagonal(scatters, axis1=1, axis2=2) * variance[rows]
        growth = (solved.values[rows] ** 2 / spread)[:, len(base) :, None]
        least = np.where(bounded[rows], growth, np.inf).min(axis=1, initial=np.inf)
        worth = least < prices[rows]  # else the misfit grows by more than the whole price
        for row, scatter, effects in zip(rows, scatters, worth, strict=True):
            ways = _Held(scatter, solved.values[row], float(variance[row, 0]))
            for effect in np.flatnonzero(effects):
                places = (len(base) + np.flatnonzero(bounded[row, :, effect])).tolist()
                price = float(prices[row, effect])
                prices[row, effect] = ways.cheaper(
                    places, price, float(gains[row, effect]), int(counts[row, effect]), n
                )
    return np.asarray(prices.sum(axis=1))


def _scatters(regression: Regression, sums: Sums, solved: Solutions, rows: Index) -> Array:
    """(m, k, k) covariance of the values of some solutions with their beliefs."""
    moves, columns = solved.moves[rows], solved.columns[rows]
    gram = sums.gram[columns[:, :, None], columns[:, None, :]] * (
        moves[:, :, None] & moves[:, None, :]
    )
    diagonal = np.arange(columns.shape[1])
    gram[:, diagonal, diagonal] += np.where(moves, regression.plausible[columns] ** -2.0, 1.0)
    scale = 1.0 / np.sqrt(gram[:, diagonal, diagonal])
    both = scale[:, :, None] * scale[:, None, :]
    return np.linalg.inv(gram * both) * both


class _Held:
    """One solution, some of whose values are held at zero, the others moving on."""

    def __init__(self, scatter: Array, values: Array, variance: float) -> None:
        self._scatter, self._values, self._variance = scatter, values.copy(), variance

    def growth(self, place: int) -> float:
        """Of the misfit, in noise variances, when one more value is held."""
        return float(self._values[place] ** 2 / self._scatter[place, place] / self._variance)

    def hold(self, place: int) -> None:
        """Let the other values move to where the misfit is least."""
        along = self._scatter[place] / self._scatter[place, place]
        self._values -= along * self._values[place]
        self._scatter = self._scatter - np.outer(along, self._scatter[place])

    def cheaper(
        self, places: Sequence[int], price: float, gain: float, count: int, rows: float
    ) -> float:
        """Price of one effect, values at `places` held one after the other while that is cheaper.

        The growth of the misfit is part of the price. What is held stays so for the other effects:
        two that can do each other's work may not both be spared.
        """
        left, spent, held = list(places), 0.0, 0
        while left and held + 1 < count:
            place = min(left, key=self.growth)
            more = spent + self.growth(place)
            if more >= price:
                break
            fewer = more + float(
                price_of_sizes(max(gain - more, 0.0), count - held - 1, rows)
                + 2.0 * math.log(math.comb(len(places), held + 1))
            )
            if fewer >= price:
                break
            self.hold(place)
            left.remove(place)
            price, spent, held = fewer, more, held + 1
        return price
