"""Held-out error: what a model predicts at poses that had no part in it.

Whatever is decided from readings (values, noise, which effects are in the model) is decided anew
from the readings of the other poses: `Learn` is the whole way from readings to a fit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.identify.estimate import fit_displacements
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.solvers import Method
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Model

FOLDS = 10  # parts in which poses are left out, as is usual
FEWER = 5  # of many poses, as usual: a fifth of them is little missed
MANY = 30  # poses from which on there are fewer parts, in half the time
SAME = 9  # decimals to which joint values of one and the same posture agree [rad or m]

#: From readings to fits: of one model, or of several that were learned together.
Learn = Callable[[Measurements], Sequence[Fit]]


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Gaps at poses left out of the fit, pose by pose.

    Attributes:
        poses: Labels of the g poses.
        squares: (g,) mean square of the gap per axis at each pose [m²].
        counts: (g,) how many numbers were read at each pose.
        folds: In how many parts the poses were left out.
    """

    poses: tuple[str, ...]
    squares: Array
    counts: Integers
    folds: int

    def __post_init__(self) -> None:
        if not np.isfinite(self.squares).all():
            raise ValueError("a pose was left out and not predicted")

    @property
    def rms(self) -> float:
        """Root mean square of the held-out gap over all numbers read [m]."""
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


def refitted(
    model: Model, *, noise: NoiseModel | None = None, method: Method = "trf", robust: bool = False
) -> Learn:
    """Learning by `fit`: values, and the noise unless it is given, from the readings at hand."""
    return lambda readings: [
        fit_displacements(model, readings, noise=noise, method=method, robust=robust)
    ]


def held_out(
    measurements: Measurements,
    learn: Learn,
    *,
    folds: int | None = None,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[HeldOut, ...]:
    """Leave poses out, learn from the others, predict those left out; for all poses in turn.

    Args:
        measurements: Readings with displacements; masked ones take no part.
        learn: The way from readings to fits, see `refitted`.
        folds: Number of parts, at most; with fewer poses every pose is left out by itself. Default:
            `FOLDS`, or `FEWER` of `MANY` poses.
        seed: Of the draw of the parts.
        progress: Called as ``progress(done, total)``.

    Returns:
        tuple of HeldOut: One for every fit that `learn` gives.

    Raises:
        InputError: There are no displacements, or only one pose.
        Refusal: A part could not be fitted, so that nothing can be said of its poses.
    """
    used = measurements.masked()
    measured = used.displacement
    parts = folds or (FOLDS if len(used.poses) < MANY else FEWER)
    part = pose_parts(used, folds=parts, seed=seed)[used.pose_index]
    count = int(part.max(initial=0)) + 1
    if measured is None or count < 2:
        raise InputError(
            "poses cannot be left out: there is only one"
            if measured is not None
            else "there are no measured displacements",
            where=used.place,
            remedy="Measure at two poses or more.",
        )
    squares: list[Array] = []
    for k in range(count):
        rows = part == k
        test = used.select(rows)
        for place, found in enumerate(learn(used.select(~rows))):
            if place == len(squares):
                squares.append(np.full(len(part), np.nan))
            gap = measured[rows] - found.model.predict(load_cases_of(found.model.robot, test))
            squares[place][rows] = np.nansum(gap**2, axis=1)
        if progress is not None:
            progress(k + 1, count)
    counts = np.bincount(used.pose_index[used.row_of_number], minlength=len(used.poses))
    return tuple(
        HeldOut(
            poses=used.poses,
            squares=np.bincount(used.pose_index, square, minlength=len(used.poses)) / counts,
            counts=counts,
            folds=count,
        )
        for square in squares
    )


def pose_parts(measurements: Measurements, *, folds: int, seed: int) -> Index:
    """(g,) part of each pose, as equal as can be; poses of one posture are in one part.

    A posture may have been measured under two labels. What is left out must not be known from the
    other one.
    """
    first = [measurements.rows_of(label)[0] for label in measurements.poses]
    postures = np.round(measurements.joints[first], SAME) + 0.0
    _, posture = np.unique(postures, axis=0, return_inverse=True)
    posture = posture.reshape(-1)
    number = int(posture.max(initial=-1)) + 1
    return drawn_parts(number, folds, np.random.default_rng(seed))[posture]


def drawn_parts(number: int, folds: int, rng: np.random.Generator) -> Index:
    """(number,) part of each of some things, drawn; parts are as equal as can be."""
    return np.asarray(rng.permutation(np.arange(number) % max(min(folds, number), 1)), np.intp)


def _std_of_mean(values: Array, counts: Integers) -> float:
    """Standard error of the weighted mean of independent values (g,)."""
    weights = counts / counts.sum()
    mean = float(weights @ values)
    g = len(values)
    return float(np.sqrt((weights**2 * (values - mean) ** 2).sum() * g / max(g - 1, 1)))
