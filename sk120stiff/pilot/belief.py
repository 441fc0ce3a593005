"""How probable each name is after some readings: exact evidence of linear Gaussian models.

A hypothesis is a set of effects beside the base model: none, each alone, and pairs of the leaders.
Parameters are Gaussian beforehand: those of the springs about the model's values, near them where
the model is a good one and over a wide range where it is not; those of an effect about zero, with a
size that is a multiple of the typical one. Both are integrated over. Then ln Z = -½ (yᵀy
- mᵀ(G + Λ)⁻¹m + ln det(G + Λ) - ln det Λ) (Bishop 2006, 3.5), and compliances that would be
negative count for as much as their posterior lies above zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from scipy.special import log_ndtr, logsumexp
from scipy.stats import chi2

from sk120stiff.arrays import Array, Index
from sk120stiff.explain.candidates.sums import Sums
from sk120stiff.explain.priors import price
from sk120stiff.pilot.linear import LinearMap

SIZES = (0.3, 1.0, 3.0, 10.0)  # typical sizes that an effect may have, equally probable
NOTHING = 0.5  # probability beforehand that nothing is missing
TWO = 0.1  # that two effects are, of the rest
LEADERS = 6  # effects of which pairs are weighed
UNEXPLAINED = 1e-4  # probability of the misfit below which no hypothesis will do


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One set of effects.

    Attributes:
        members: Positions of its effects in the map.
        log_weight: ln of prior times evidence, over the sizes.
        columns: Its parameters' columns, the base's first.
        mean, covariance: Moments of their posterior over all sizes, typical sizes.
        misfit: χ² that it leaves at the most probable size.
    """

    members: tuple[int, ...]
    log_weight: float
    columns: Index
    mean: Array
    covariance: Array
    misfit: float


@dataclass(frozen=True, eq=False)
class Belief:
    """What readings say of every name.

    Attributes:
        linear: The candidates.
        sums: The readings.
    """

    linear: LinearMap
    sums: Sums

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All that were weighed, the most probable first."""
        count = len(self.linear.effects)
        odds = np.array([-0.5 * price(effect, {}) for effect in self.linear.effects])
        share = odds - logsumexp(odds)
        singles = [
            self._weighed((e,), np.log((1 - NOTHING) * (1 - TWO)) + share[e]) for e in range(count)
        ]
        leading = sorted(range(count), key=lambda e: -singles[e].log_weight)[:LEADERS]
        # pairs of effects: the strongest of what the first leaves counts too
        first = leading[0] if leading else None
        partners = [] if first is None else self._beside(first)
        pairs = {tuple(sorted(p)) for p in combinations(leading, 2)}
        pairs |= {tuple(sorted((first, e))) for e in partners if first is not None}
        each = np.log((1 - NOTHING) * TWO) - np.log(0.5)
        doubles = [self._weighed(pair, each + share[pair[0]] + share[pair[1]]) for pair in pairs]
        everything = [self._weighed((), float(np.log(NOTHING))), *singles, *doubles]
        return tuple(sorted(everything, key=lambda h: -h.log_weight))

    @cached_property
    def weights(self) -> Array:
        """Probabilities of the hypotheses."""
        logs = np.array([h.log_weight for h in self.hypotheses])
        return np.asarray(np.exp(logs - logsumexp(logs)))

    @cached_property
    def probabilities(self) -> dict[str, float]:
        """Probability of each effect being at work, and of ``none``; the largest first."""
        found: dict[str, float] = {"none": 0.0}
        for h, weight in zip(self.hypotheses, self.weights, strict=True):
            for name in [self.linear.effects[e].id for e in h.members] or ["none"]:
                found[name] = found.get(name, 0.0) + float(weight)
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @property
    def leader(self) -> Hypothesis:
        """The most probable hypothesis."""
        return self.hypotheses[0]

    @property
    def unexplained(self) -> bool:
        """Even the best hypothesis leaves more than noise."""
        return self.chance < UNEXPLAINED

    @property
    def chance(self) -> float:
        """Probability of a misfit as large as the leader's by noise alone."""
        h = self.leader
        freedom = max(self.sums.count - len(h.columns), 1)
        return float(chi2.sf(h.misfit, freedom)) if self.sums.count else 1.0

    def likely(self, most: int) -> list[tuple[float, Hypothesis]]:
        """The leading hypotheses with their probabilities, which add up to one."""
        chosen = list(zip(self.weights[:most], self.hypotheses[:most], strict=False))
        total = sum(weight for weight, _ in chosen)
        return [(float(weight / total), h) for weight, h in chosen]

    def spring_errors(self) -> Array:
        """(len(base),) posterior standard deviations of the base parameters [typical sizes].

        Those of the leading hypotheses, with what these differ in.
        """
        k = len(self.linear.base)
        rows = self.likely(12)
        mean = sum(w * h.mean[:k] for w, h in rows)
        second = sum(w * (np.diag(h.covariance)[:k] + (h.mean[:k] - mean) ** 2) for w, h in rows)
        return np.asarray(np.sqrt(np.asarray(second)))

    def _beside(self, first: int) -> list[int]:
        """Effects that explain most of what one leaves."""
        columns = self._columns((first,))
        gram = self.sums.gram[np.ix_(columns, columns)]
        gram = gram + np.diag(self._precision(columns, self.linear.spread[-1], 3.0))
        inverse = np.linalg.inv(gram)
        gains = []
        for e, own in enumerate(self.linear.columns):
            cross = self.sums.gram[np.ix_(columns, own)]
            left = self.sums.moment[own] - cross.T @ inverse @ self.sums.moment[columns]
            inner = self.sums.gram[np.ix_(own, own)] - cross.T @ inverse @ cross + np.eye(len(own))
            gains.append(-np.inf if e == first else float(left @ np.linalg.solve(inner, left)))
        return [int(e) for e in np.argsort(gains)[::-1][:LEADERS]]

    def _columns(self, members: Sequence[int]) -> Index:
        return np.concatenate([self.linear.base, *(self.linear.columns[e] for e in members)])

    def _precision(self, columns: Index, spread: Array, size: float) -> Array:
        return np.concatenate([spread**-2.0, np.full(len(columns) - len(spread), size**-2)])

    def _weighed(self, members: tuple[int, ...], prior: float) -> Hypothesis:
        columns, k = self._columns(members), len(self.linear.base)
        sums = self.sums
        gram, moment = sums.gram[np.ix_(columns, columns)], sums.moment[columns]
        bound = self.linear.positive[columns].copy()
        bound[:k] = False
        sizes = SIZES if members else (1.0,)
        precision = np.array(  # (S, k)
            [self._precision(columns, near, size) for near in self.linear.spread for size in sizes]
        )
        inner = gram + precision[:, :, None] * np.eye(len(columns))
        covariances = np.linalg.inv(inner)
        means = covariances @ moment
        logs = -0.5 * (sums.square - means @ moment)
        logs += 0.5 * (np.log(precision).sum(axis=1) - np.linalg.slogdet(inner)[1])
        if bound.any():
            variance = np.diagonal(covariances, axis1=1, axis2=2)[:, bound]
            logs += (log_ndtr(means[:, bound] / np.sqrt(variance)) + np.log(2.0)).sum(axis=1)
        best = means[int(np.argmax(logs))]
        misfit = sums.square - 2.0 * float(best @ moment) + float(best @ gram @ best)
        evidence = float(np.logaddexp.reduce(logs))
        # One size alone, the smallest while little is known, would hide what a reading could show.
        share = np.exp(logs - evidence)
        mean = share @ means
        off = means - mean
        covariance = np.einsum("s,sij->ij", share, covariances + off[:, :, None] * off[:, None])
        total = evidence - float(np.log(len(precision))) + prior
        return Hypothesis(members, total, columns, mean, covariance, max(misfit, 0.0))
