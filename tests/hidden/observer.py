"""An observer of linear causes in normal noise: what is likely, and what it says of that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp

from .generator.noise import Noise
from .generator.rotations import Array
from .generator.rows import Rows

SURE = 0.95  # probability that an answer covers
STRICT, LENIENT = 1.0 - SURE, 0.5  # probability of no cause up to which names are given


@dataclass(frozen=True)
class Whole(Noise):
    """The same noise with wander and warm-up in its covariance; outliers stay left out."""

    def covariance(self, rows: Rows, displacement: Array, position: Array) -> Array:
        n, stops = rows.count, np.concatenate([rows.order, rows.zero_order])
        walk = self.wander**2 * (np.minimum.outer(stops, stops) + 1.0)
        extra = walk[:n, :n] + walk[n:, n:] - walk[:n, n:] - walk[n:, :n]
        cold = np.exp(-stops / self.warm_time)
        extra += self.warm_up**2 / 3.0 * np.outer(cold[n:] - cold[:n], cold[n:] - cold[:n])
        return super().covariance(rows, displacement, position) + np.kron(extra, np.eye(3))


@dataclass(frozen=True)
class Law:
    """Whitened change = strength (mean + spread z), z normal: one way for a candidate to look."""

    mean: Array  # (n,)
    spread: Array  # (n, k)
    strengths: Array
    weight: float = 1.0  # probability of each of the strengths, given the candidate

    def through(self, cut: Array) -> Law:
        """The same as it looks once a matrix (n, n) has taken away what others may cause."""
        return replace(self, mean=cut @ self.mean, spread=cut @ self.spread)

    def evidence(self, seen: Array) -> Array:
        """Logarithm of weight and likelihood ratio to no cause: (strengths, draws)."""
        left, values, _ = np.linalg.svd(self.spread, full_matrices=False)
        inside, along, own = left.T @ seen, self.mean @ seen, left.T @ self.mean
        out = []
        for a in self.strengths:
            gain = (a * values) ** 2
            fit = 0.5 * (gain / (1.0 + gain)) @ (inside - a * own[:, None]) ** 2
            size = np.log1p(gain).sum() + a**2 * self.mean @ self.mean
            out.append(np.log(self.weight) + fit + a * along - 0.5 * size)
        return np.array(out)


Candidates = dict[str, list[Law]]


def posterior(candidates: Candidates, seen: Array, nothing: float = 0.5) -> Array:
    """Probability of every candidate and, last, of none, which has the prior `nothing`:
    (candidates + 1, draws). The candidates share the rest alike."""
    share = np.log((1.0 - nothing) / len(candidates))
    each = [
        share + logsumexp(np.concatenate([law.evidence(seen) for law in laws]), axis=0)
        for laws in candidates.values()
    ]
    table = np.array([*each, np.full(seen.shape[1], np.log(nothing))])
    out: Array = np.exp(table - logsumexp(table, axis=0))
    return out


def decide(names: Sequence[str], chances: Array, allowed: float = STRICT) -> frozenset[str]:
    """The likeliest names that cover `SURE` together; none where no cause has more than `allowed`.
    With more allowed than `SURE` leaves, they cover that part of what speaks for a cause."""
    nothing = float(chances[-1])
    if nothing > allowed:
        return frozenset()
    need = SURE if allowed <= STRICT else SURE * (1.0 - nothing)
    order = np.argsort(-chances[:-1])
    count = int(np.searchsorted(np.cumsum(chances[:-1][order]), need - 1e-12)) + 1
    return frozenset(names[i] for i in order[:count])
