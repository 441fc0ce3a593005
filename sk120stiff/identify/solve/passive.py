"""The best fit in which no part gives off energy.

Where two compliances are coupled, c_k² ≤ c_i c_j for springs: their matrix has no negative
eigenvalue. A fit that ends beyond goes on along the edge, with the square roots of c_i and c_j as
parameters, in which the edge c_k = ± √c_i √c_j is smooth to its very end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.identify.solve.polish import TRIAL, Minimum, polish
from sk120stiff.identify.solve.problem import Problem

INSIDE = 1e-3  # share of the largest coupling by which it is held below


def passive(problem: Problem, found: Minimum) -> Minimum:
    """The minimum found, or the best on the edge where a coupling is beyond it.

    Raises:
        Refusal: The search along the edge does not come to an end.
    """
    beyond = [own for own in problem.couplings if _is_beyond(problem, found.x, *own)]
    if not beyond:
        return found
    edge = _Edge(problem, np.array(beyond), np.sign(found.x))
    best = polish(edge.evaluate, edge.start(found.x), edge.bounds, edge.span, faint=TRIAL)
    x = edge.whole(best.x)
    residual, jacobian = problem.evaluate(x)
    at_bound = np.ones(len(x), dtype=bool)
    at_bound[edge.moving] = best.at_bound
    return Minimum(x, residual, jacobian, at_bound, found.iterations + best.iterations + 1)


def _is_beyond(problem: Problem, x: Array, i: int, j: int, k: int) -> bool:
    values = x * problem.scale
    return bool(values[k] ** 2 > values[i] * values[j])


@dataclass(frozen=True, eq=False)
class _Edge:
    """The problem without its couplings, which are as large as they may be.

    Attributes:
        problem: The whole.
        beyond: (m, 3) places i, j, k of what is coupled.
        sign: (P_free,) of every value; that of a coupling stays.
    """

    problem: Problem
    beyond: Index
    sign: Array

    @property
    def moving(self) -> Index:
        """Places of the parameters that are left."""
        return np.delete(np.arange(len(self.sign)), self.beyond[:, 2])

    @property
    def rooted(self) -> Index:
        """Places whose square roots stand for them."""
        return np.unique(self.beyond[:, :2])

    def start(self, x: Array) -> Array:
        """A point on the edge near scaled values (P_free,)."""
        out = x.copy()
        out[self.rooted] = np.sqrt(np.maximum(x[self.rooted], 0.0))
        for i, j, k in self.beyond:  # neither is zero where the coupling is not
            least = np.sqrt(np.abs(x[k]) / self._factor(i, j, k)) / 2.0
            out[i], out[j] = max(out[i], least), max(out[j], least)
        return out[self.moving]

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Of what is left."""
        lower, upper = (bound.copy() for bound in self.problem.bounds)
        lower[self.rooted] = 0.0
        upper[self.rooted] = np.sqrt(upper[self.rooted])
        return lower[self.moving], upper[self.moving]

    @property
    def span(self) -> Array:
        """Of what is left."""
        out = self.problem.span.copy()
        out[self.rooted] = np.sqrt(out[self.rooted])
        return np.asarray(out[self.moving])

    def whole(self, part: Array) -> Array:
        """(P_free,) scaled values for what is left."""
        x = np.zeros(len(self.sign))
        x[self.moving] = part
        for i, j, k in self.beyond:
            x[k] = self.sign[k] * self._factor(i, j, k) * x[i] * x[j]
        x[self.rooted] **= 2
        return x

    def evaluate(self, part: Array) -> tuple[Array, Array]:
        """Residual and its derivative by what is left."""
        x = self.whole(part)
        residual, jacobian = self.problem.evaluate(x)
        by = jacobian.copy()
        roots = np.sqrt(x[self.rooted])
        by[:, self.rooted] *= 2.0 * roots
        for i, j, k in self.beyond:
            factor = self.sign[k] * self._factor(i, j, k)
            by[:, i] += factor * np.sqrt(x[j]) * jacobian[:, k]
            by[:, j] += factor * np.sqrt(x[i]) * jacobian[:, k]
        return residual, by[:, self.moving]

    def _factor(self, i: int, j: int, k: int) -> float:
        """Scaled coupling per product of the square roots of the two scaled compliances."""
        scale = self.problem.scale
        return float((1.0 - INSIDE) * np.sqrt(scale[i] * scale[j]) / scale[k])
