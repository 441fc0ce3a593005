"""What every candidate could take away from the misfit of a model, and what it would cost."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.candidates.sums import Solved, Sums
from sk120stiff.explain.select.score import Scored, most_fallen, price_of_looking
from sk120stiff.explain.select.size_prices import price_of_sizes

SEEN = 1e-9  # of the largest: what a variant shows less of beside a model, it does not show


@dataclass(frozen=True, eq=False)
class Promises:
    """What candidates may explain of what one model leaves.

    Attributes:
        regression, sums: Linearised readings, and the poses of them that count.
        each: (V,) for every variant of every candidate, one candidate after the other, the misfit
            that it could take away, no bound of a parameter kept but that of one alone.
    """

    regression: Regression
    sums: Sums
    each: Array

    @cached_property
    def most(self) -> Array:
        """(candidates,) the most that any variant of each promises."""
        return self._best(self.each)

    @cached_property
    def _worth(self) -> Array:
        """(V,) what is left of each promise when the variant is paid."""
        counts, prices = self.regression.every_variant
        return self.each - price_of_sizes(self.each, counts, max(self.sums.count, 2.0)) - prices

    def likeliest(self, candidate: int) -> int:
        """The variant of a candidate that promises the best score."""
        first, end = self.regression.first_variants[candidate : candidate + 2]
        return int(self._worth[first:end].argmax())

    def hopes(self, model: Scored) -> Array:
        """(candidates,) the score to which the model may come with one of them.

        What is promised need not come true, which makes a score worse. It gets better than that
        where the prices of other effects fall, or a value that lay on its bound moves again: an
        estimate, no bound.
        """
        looking = price_of_looking(self.regression, max(self.sums.count, 2.0))
        more = most_fallen(self.regression, self.sums, model.solved, self.most) - self.most
        return np.asarray(model.score + looking - self._best(self._worth) - more)

    def _best(self, of_variants: Array) -> Array:
        first = self.regression.first_variants
        return np.asarray(np.maximum.reduceat(of_variants, first[:-1]))


def promises(regression: Regression, sums: Sums, model: Solved) -> Promises:
    """What the candidates promise beside a model.

    One projection serves all: with S the columns of one variant and M projecting out the model, it
    is ‖orth(M S)ᵀ r‖².
    """
    inside = model.columns
    gram_in = sums.gram[np.ix_(inside, inside)] + np.diag(regression.plausible[inside] ** -2.0)
    scale = np.sqrt(np.maximum(np.diag(gram_in), 1e-300))
    cross = sums.gram[inside] / scale[:, None]
    solved = np.linalg.solve(gram_in / np.outer(scale, scale), cross)
    residual = sums.moment - solved.T @ (sums.moment[inside] / scale)
    each = np.zeros(int(regression.first_variants[-1]))
    size = np.sqrt(np.maximum(np.diag(sums.gram), 1e-300))
    for places, columns in regression.variants_by_size:
        blocks = sums.gram[columns[:, :, None], columns[:, None, :]]
        blocks = blocks - cross.T[columns] @ np.swapaxes(solved.T[columns], 1, 2)
        scales = size[columns]
        right = residual[columns] / scales
        values, vectors = np.linalg.eigh(blocks / (scales[:, :, None] * scales[:, None, :]))
        along = np.einsum("mki,mk->mi", vectors, right)
        seen = values > SEEN
        found = np.where(seen, along**2 / np.where(seen, values, 1.0), 0.0).sum(axis=1)
        if columns.shape[1] == 1:
            found[(right[:, 0] < 0.0) & (regression.lower[columns[:, 0]] == 0.0)] = 0.0
        each[places] = found
    return Promises(regression, sums, each)
