"""Held-out error: what a model predicts at poses that it was not fitted to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sk120stiff.errors import InputError
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.problem import Problem
from sk120stiff.identify.solving import solve
from sk120stiff.robot.coupling import Array

FOLDS = 10


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Gaps at poses left out of the fit, pose by pose.

    Attributes
    ----------
    poses
        Labels of the g poses.
    squares
        (g,) mean square of the gap per axis at each pose [m²].
    counts
        (g,) number of readings at each pose.
    folds
        In how many parts the poses were left out.
    """

    poses: tuple[str, ...]
    squares: Array
    counts: NDArray[np.int64]
    folds: int

    @property
    def rms(self) -> float:
        """Root mean square of the held-out gap over all readings and axes [m]."""
        return float(np.sqrt(np.average(self.squares, weights=self.counts)))

    @property
    def std(self) -> float:
        """Standard error of `rms` from its scatter over poses [m]."""
        return _std_of_mean(self.squares, self.counts) / (2.0 * max(self.rms, 1e-300))

    def difference(self, other: HeldOut) -> tuple[float, float]:
        """rms of this minus rms of the other [m], and its standard error over the same poses."""
        change = self.squares - other.squares
        mean = max(0.5 * (self.rms + other.rms), 1e-300)
        return self.rms - other.rms, _std_of_mean(change, self.counts) / (2.0 * mean)


def held_out(
    fit: Fit,
    *,
    folds: int | None = None,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> HeldOut:
    """Cross-validate a fit, grouped by pose: no pose is ever in both parts.

    Every part is fitted from the model's starting values, so that what only the left-out poses show
    is not known to it.

    Parameters
    ----------
    fit
        Gives model, readings and noise.
    folds
        Number of parts; by default every pose is left out by itself, ten parts for more than ten.
    seed
        Of the draw of the parts.
    progress
        Called as ``progress(done, total)``.

    Raises
    ------
    InputError
        There is only one pose, or fewer poses than folds.
    Refusal
        A part could not be fitted.
    """
    problem = fit.problem
    index = problem.situation.pose
    labels = problem.measurements.poses
    count = min(FOLDS, len(labels)) if folds is None else folds
    if not 2 <= count <= len(labels):
        raise InputError(
            f"{len(labels)} poses cannot be left out in {count} parts",
            where=str(problem.measurements.path or "measurements"),
            remedy="Measure at two poses or more.",
        )
    part = np.random.default_rng(seed).permutation(np.arange(len(labels)) % count)[index]
    squares = np.zeros(len(part))
    for k in range(count):
        train = problem.measurements.select(part != k)
        weights = None if problem.weights is None else problem.weights[part != k]
        found = solve(Problem(problem.model, train, problem.noise, weights))
        rows = part == k
        gap = problem.measured[rows] - found.model.predict(problem.situation.rows(rows))
        squares[rows] = (gap**2).mean(axis=1)
        if progress is not None:
            progress(k + 1, count)
    counts = np.bincount(index, minlength=len(labels))
    per_pose = np.bincount(index, squares, minlength=len(labels)) / counts
    return HeldOut(labels, per_pose, counts, count)


def _std_of_mean(values: Array, counts: NDArray[np.int64]) -> float:
    """Standard error of the weighted mean of independent values (g,)."""
    weights = counts / counts.sum()
    mean = float(weights @ values)
    g = len(values)
    return float(np.sqrt((weights**2 * (values - mean) ** 2).sum() * g / max(g - 1, 1)))
