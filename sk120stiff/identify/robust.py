"""Fits that trust readings less that lie far from all others: Huber's loss on whole readings.

A tracker that was bumped misreads all three axes, so a reading is judged as a whole: by the length
s of its whitened gap, given all other readings of its zero group. Up to a limit k its loss is s²/2,
beyond it k s − k²/2 (Huber 1964), which is least squares with the weight min(1, k/s): its own
variance grows, that of the zero reading which it shares does not.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.errors import Refusal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solve.solvers import Method
from sk120stiff.identify.solving import solve, solve_near
from sk120stiff.identify.written import with_values

# By the number of axes that a reading has, from 0 on:
LIMIT = np.sqrt([0.0, *stats.chi2.ppf(0.99, (1, 2, 3))])  # one clean one in a hundred lies beyond
MIDDLE = np.array([1.0, *stats.chi2.ppf(0.5, (1, 2, 3))])  # and half of them
FAR = 6.0  # times the spread of the others, per axis: no smooth cause is so much at one reading
NOTHING = 1e-9  # weight of a reading that counts no more
FEW = 0.125  # share of the readings that may be slips
ROUNDS = 60  # of reweighting, at most
SETTLED = 1e-6  # largest change of a weight after which rounds end


def solve_robustly(problem: Problem, *, method: Method = "trf") -> Fit:
    """Solve a problem with Huber's loss on whole readings.

    Where σ is not known it is taken from the median of the readings' lengths, which outliers do
    not move.

    Raises:
        Refusal: As `solve`, or the weights do not settle.
    """
    axes = problem.read.sum(axis=1)
    weights = np.ones(len(axes))
    found = solve(problem.with_weights(weights), method=method)
    iterations = found.iterations
    for _ in range(ROUNDS):
        lengths = reading_lengths(found.problem, found.gap)
        spread = 1.0 if problem.noise.known else _spread(lengths, axes, found.estimated)
        new = np.minimum(1.0, LIMIT[axes] * spread / np.maximum(lengths, 1e-300))
        settled = float(np.abs(new - weights).max()) < SETTLED
        if settled:
            return with_values(
                replace(
                    found,
                    iterations=iterations,
                    spread=spread,
                    inflation=_inflation(lengths / spread, new, axes, found.estimated),
                )
            )
        weights = new
        found = solve_near(problem.with_weights(weights), found.x)
        iterations += found.iterations
    raise Refusal(
        "the weights of the robust fit did not settle",
        remedy="Leave out --robust, or mask the readings that are wrong.",
    )


def reading_lengths(problem: Problem, gap: Array) -> Array:
    """(N,) whitened length of each reading's gap, given the other readings of its zero group.

    The square of a clean one has a χ² distribution, with a degree of freedom for each axis that was
    read. The reading itself is taken at full trust, the others at their weights.
    """
    measurements = problem.measurements
    gap = np.where(problem.read, gap, 0.0)
    own, zero = problem.noise.variances(measurements, problem.sizes)
    if problem.noise.zero == "separate":
        return np.asarray(np.sqrt((gap**2 / (own + zero)).sum(axis=1)))
    weights = problem.weights if problem.weights is not None else np.ones(len(gap))
    trust = weights[:, None] / own
    group = np.unique(measurements.zero_group, return_inverse=True)[1]
    sums = np.zeros((2, int(group.max()) + 1, 3))
    np.add.at(sums[0], group, trust)
    np.add.at(sums[1], group, trust * gap)
    information = sums[0][group] - trust
    guess_gain = zero / (1.0 + zero * information)
    guess = guess_gain * (sums[1][group] - trust * gap)
    return np.asarray(np.sqrt(((gap - guess) ** 2 / (own + guess_gain)).sum(axis=1)))


def far_off(fit: Fit) -> Index:
    """Readings so far off a least-squares fit, for its other readings, that they must be slips.

    The worst first, and the others judged without it: one slip pulls all that share its zero
    reading. Their share of all is small, or it is no few readings that are wrong.
    """
    problem = fit.problem
    axes = problem.read.sum(axis=1)
    if problem.weights is not None or fit.degrees_of_freedom < 1:
        return np.zeros(0, dtype=np.intp)
    weights, far = np.ones(len(axes)), list[int]()
    while len(far) <= FEW * len(axes):
        lengths = reading_lengths(problem.with_weights(weights), fit.gap)
        scale = _spread(lengths, axes, fit.estimated)
        limit = FAR * (max(scale, 1.0) if problem.noise.known else scale) * np.sqrt(axes)
        share = np.where(weights < 1.0, 0.0, lengths / np.maximum(limit, 1e-300))
        worst = int(share.argmax())
        if share[worst] <= 1.0:
            return np.array(sorted(far), dtype=np.intp)
        far.append(worst)
        weights[worst] = NOTHING
    return np.zeros(0, dtype=np.intp)


def _spread(lengths: Array, axes: Integers, estimated: int) -> float:
    share = np.median(lengths**2 / MIDDLE[axes])
    return float(np.sqrt(share / _freedom(axes, estimated)))


def _freedom(axes: Integers, estimated: int) -> float:
    """Share of the numbers read that the parameters leave free; `axes` (N,) of each reading."""
    numbers = int(axes.sum())
    return max(numbers - estimated, 1) / numbers


def _inflation(lengths: Array, weights: Array, axes: Integers, estimated: int) -> float:
    """Variance of Huber's estimates over that of the weighted least squares that gives them.

    Huber (1973): cov = E ψ² / (E ψ')² (JᵀJ)⁻¹, here with the axes of a reading together, against
    (JᵀJ)⁻¹ / E w.
    """
    mean = float(axes.mean())
    limit = LIMIT[axes]
    squares = float(np.mean(np.minimum(lengths, limit) ** 2)) / mean / _freedom(axes, estimated)
    slope = float(np.mean((lengths <= limit) + (axes - 1.0) * weights)) / mean
    return squares / slope**2 * float(np.mean(weights))
