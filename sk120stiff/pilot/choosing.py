"""Which reading to take next: the one of which most is expected, about names and sizes.

The information that a reading brings is that about which hypothesis is true plus, under each, that
about its parameters. The first is bounded from below by pairwise distances of the predictions
(Kolchinsky & Tracey 2017, with Bhattacharyya's), the second is ½ ln det S in units of the noise,
exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.pilot.belief import Belief, Hypothesis

NEGLIGIBLE = 1e-3  # probability of a hypothesis that is not weighed at all
WEIGHED = 40  # hypotheses whose predictions are held against each other: all single causes
# Of information about sizes, against that about names. Before any name shows, sizes alone decide;
# where two names that are nearly alike remain, a reading tells a tenth of a nat between them, and
# more than this share would choose those that make springs a little better known.
SIZE_SHARE = 0.03


@dataclass(frozen=True, eq=False)
class Expected:
    """What each of M readings is expected to bring [nat].

    Attributes:
        names: (M,) about which name is true.
        sizes: (M,) about the sizes, on average over the names.
    """

    names: Array
    sizes: Array

    @property
    def worth(self) -> Array:
        """(M,) what counts."""
        return self.names + SIZE_SHARE * self.sizes


def expected(belief: Belief, X: Array) -> Expected:
    """Expected information of readings with whitened columns X (M, 3, P)."""
    rows = [(weight, h) for weight, h in belief.likely(WEIGHED) if weight > NEGLIGIBLE]
    means, covariances = [], []
    for _, h in rows:
        own = X[:, :, h.columns]
        means.append(own @ h.mean)
        covariances.append(np.eye(3) + own @ h.covariance @ own.transpose(0, 2, 1))
    p = np.array([weight for weight, _ in rows])
    mu, S = np.array(means), np.array(covariances)  # (K, M, 3), (K, M, 3, 3)
    logdet, _ = _within(S, np.zeros(3))
    sizes = 0.5 * p @ logdet
    K = len(rows)
    overlap = np.ones((K, K, len(X)))
    i, j = np.triu_indices(K, 1)
    middle, square = _within(0.5 * (S[i] + S[j]), mu[i] - mu[j])
    far = 0.125 * square + 0.5 * middle - 0.25 * (logdet[i] + logdet[j])
    overlap[i, j] = overlap[j, i] = np.exp(-far)
    names = -p @ np.log(np.einsum("j,ijm->im", p, overlap))
    return Expected(np.maximum(names, 0.0), sizes)


def _within(S: Array, x: Array) -> tuple[Array, Array]:
    """ln det S and xᵀ S⁻¹ x of S (..., 3, 3) by its LDLᵀ, written out: LAPACK's calls cost more."""
    a, b, c, d, e, f = (S[..., i, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)))
    p, q = b / a, c / a
    second = d - b * p
    r = (e - c * p) / second
    third = f - c * q - second * r * r
    u = x[..., 0]
    v = x[..., 1] - p * u
    w = x[..., 2] - q * u - r * v
    square = u * u / a + v * v / second + w * w / third
    return np.log(a) + np.log(second) + np.log(third), square


def separation(
    belief: Belief, first: Hypothesis, second: Hypothesis, X: Array, count: int
) -> float:
    """√λ that `count` more readings could bring between two hypotheses, at best.

    If the first is true with the size that was found, what of it cannot the second imitate? Asked
    of all the pool's readings together, of which the `count` best then count.
    """
    k = len(belief.linear.base)
    own = np.setdiff1d(first.columns[k:], second.columns[k:])
    if not len(own):
        return np.inf
    signature = X[:, :, own] @ first.mean[np.isin(first.columns, own)]
    other = X[:, :, second.columns].reshape(-1, len(second.columns))
    flat = signature.reshape(-1)
    ridge = np.concatenate(
        [belief.linear.spread[-1] ** -1.0, np.full(len(second.columns) - k, 0.1)]
    )
    A = np.vstack([other, np.diag(ridge)])
    b = np.concatenate([flat, np.zeros(len(ridge))])
    left = flat - other @ np.linalg.lstsq(A, b, rcond=None)[0]
    each = np.sort((left.reshape(-1, 3) ** 2).sum(axis=1))[::-1]
    return float(np.sqrt(each[:count].sum()))


def best(belief: Belief, X: Array, open_: Mask) -> int:
    """The reading of the pool that is worth most among those that are open."""
    return int(np.argmax(np.where(open_, expected(belief, X).worth, -np.inf)))
