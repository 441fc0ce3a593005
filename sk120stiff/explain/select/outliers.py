"""Readings that no smooth cause can have made, found before any cause is named.

Several hide each other by the spread that they bring: Rosner (1983), Percentage points for a
generalized ESD many-outlier procedure, *Technometrics* 25.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import pairwise, takewhile
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.identify import Problem
from sk120stiff.measurements import Whitens
from sk120stiff.measurements.poses import rows_by_label

LIMIT = 4.2  # standard errors; among 300 axes noise alone gets there once in a hundred files
NEXT = 3.7  # the same once one outlier is certain
ALONE = 8.0  # of what no catalogue explains: no smooth cause is so much at one reading
LEAST_LEFT = 0.05  # share of a row that the fit must leave, if the row is to tell of the noise
ROUNDING = 1e-10  # of the most that a shift has of its own
LARGEST_SHARE = 0.06  # more than this is no crowd of outliers but a missing cause
MANY = 0.125  # the same where each is far off, and nothing is left without them
CLEAN = 1e-3  # probability that noise alone leaves more


def outlying_rows(
    regression: Regression,
    whitener: Whitens,
    courses: Sequence[Array] = (),
    borne_out: Mask | None = None,
) -> Index:
    """Rows (readings) whose own shift would be significant beyond the whole catalogue together.

    The catalogue is fitted with every parameter drawn towards zero by its plausible range, which is
    flexible enough for any cause like those in it. A reading stands out if a shift of one of its
    axes would still take more than `LIMIT` standard errors (`NEXT`, once one was found). The worst
    is taken out first, and the rest judged again.

    An outlier is a slip at a single reading. Where readings stand out, each of the `courses` is
    fitted beside the catalogue too: if it leaves less than the shifts do, each at the price of its
    parameters (BIC), no slip is needed for what it explains.

    Where so many readings are farther off than the stated noise that no catalogue explains them,
    some are outliers if without them, each far off, the noise is all that is left. Otherwise what
    is left of the others is the noise that an outlier has to stand out of; a whole crowd of them
    has to stand apart: slips leave nothing between themselves and the rest, a smooth cause does.

    Args:
        regression: The readings linearised at the base model.
        whitener: Their noise.
        courses: (N, 3, 3) each: what a drift that dies away makes of the readings, along x, y, z.
        borne_out: (N,) readings that were taken again and came out alike: none of them slipped.
    """
    X, prior = _whole_catalogue(regression)
    y = regression.y
    axes = np.bincount(whitener.reading)  # (N,) how many were read
    shifts = _shift_columns(whitener, regression.group, borne_out)
    known = regression.sigma_known
    found = _one_by_one(_peeled(X, prior, y, shifts, known), shifts)
    if found is None:
        clean = chi2.isf(CLEAN, len(y)) if known else None
        found = _far_off(partial(_peeled, X, prior, y, shifts), shifts, clean)
    if not len(found.rows):
        return found.rows
    each = np.log(len(y))  # the price of a parameter
    ways = [(found.left + float(axes[found.rows].sum()) * each, found.rows)]
    for course in courses:
        beside = whitener.apply(course)
        size = np.sqrt((beside**2).sum(0))
        if (size > 0.0).all():
            free = np.hstack([X, beside / size]), np.concatenate([prior, np.zeros(3)])
            other = _one_by_one(_peeled(*free, y, shifts, known, noise=found.noise), shifts)
            if other is not None:
                spent = float(axes[other.rows].sum()) + 4.0
                ways.append((other.left + spent * each, other.rows))
    return min(ways, key=lambda way: way[0])[1]


def standing_apart(
    regression: Regression,
    whitener: Whitens,
    effects: Iterable[int],
    borne_out: Mask | None = None,
) -> Index:
    """Rows far off a model that holds all others, beyond any noise that they have.

    The whole catalogue together may follow single readings of a small campaign, and hide that they
    are off. Beside the few effects of a model they are not hidden; it may lack a smooth cause, so
    each must be far off, and nothing else left.

    Args:
        regression: The readings linearised at the model.
        whitener: Their noise.
        effects: Of the model, each by its usual law.
        borne_out: (N,) readings that were taken again and came out alike.
    """
    columns = np.concatenate([regression.base, *(regression.columns[e] for e in effects)])
    held = _held_to_what_is_plausible(regression, columns)
    shifts = _shift_columns(whitener, regression.group, borne_out)
    clean = chi2.isf(CLEAN, len(regression.y)) if regression.sigma_known else None
    return _far_off(partial(_peeled, *held, regression.y, shifts), shifts, clean).rows


def still_outlying(outliers: Index, residual: Array, problem: Problem, scale: float) -> Index:
    """Those of some outliers that are so beside a model, too, which was found without them.

    A reading on a flank of a gear's curve is off all that the catalogue says at once by its usual
    laws; the law that was named holds it.

    Args:
        outliers: Rows of all readings.
        residual: (R,) what the model leaves of all readings, whitened.
        problem: Of all readings.
        scale: Of the noise of the others, in units of what was assumed.
    """
    shifts = _shift_columns(problem.whitener, problem.load_cases.pose[problem.whitener.reading])
    off = np.zeros((problem.measurements.n_readings, 3))
    for each in shifts:
        size = np.sqrt(np.maximum((each.columns**2).sum(1), 1e-300))
        off[each.readings] = np.abs(each.along(residual[None])[0]) / size
    return np.asarray(outliers[off[outliers].max(axis=1) > NEXT * scale])


def _whole_catalogue(regression: Regression) -> tuple[Array, Array]:
    """Columns (R, P) of base and catalogue, and how firmly each (P,) is drawn towards zero."""
    # one law of each effect: all of them together would follow any single reading
    columns = np.concatenate([regression.base, *regression.columns])
    return _held_to_what_is_plausible(regression, columns)


def _held_to_what_is_plausible(regression: Regression, columns: Index) -> tuple[Array, Array]:
    """Columns (R, P), and how firmly each (P,) is drawn towards zero; those of the base are not."""
    X = regression.X[:, columns]
    prior = 3.0 / np.maximum(regression.plausible[columns], 1e-300)
    prior[: len(regression.base)] = 0.0
    return X, np.where(np.diag(X.T @ X) > 0.0, prior, 1.0)


def everything(regression: Regression) -> tuple[Array, Array]:
    """What base and catalogue together leave of the readings (R,), and each row's leverage (R,)."""
    X, prior = _whole_catalogue(regression)
    half = _half(X, prior)
    return regression.y - half.T @ (half @ regression.y), (half**2).sum(0)


def _half(columns: Array, weight: Array) -> Array:
    """(P, R) with columns drawn towards zero: the fit of y is halfᵀ half y."""
    gram = columns.T @ columns + np.diag(weight**2)
    scale = 1.0 / np.sqrt(np.diag(gram))
    factor = np.linalg.cholesky(gram * np.outer(scale, scale) + 1e-12 * np.eye(len(gram)))
    return np.asarray(np.linalg.solve(factor, (columns * scale).T))


class _Peeled(NamedTuple):
    """Rows that were taken out, and what is beside them.

    Attributes:
        rows: Of the readings, in order.
        left: χ² of the others.
        noise: What this was held to.
        next: Standard errors by which the farthest of the others is off.
    """

    rows: Index
    left: float
    noise: float
    next: float


class _Shifts(NamedTuple):
    """What a shift of one reading alone does to the whitened rows of its pose.

    Attributes:
        readings: (g, n) of g poses that have as many.
        rows: (g, r) of these poses; whitening mixes no others.
        columns: (g, r, n, 3) shift of each reading along x, y, z; zero where that was not read, and
            of readings that cannot have slipped.
    """

    readings: Index
    rows: Index
    columns: Array

    def along(self, rows: Array) -> Array:
        """(k, g, n, 3) scalar products of the shifts with some rows (k, R)."""
        g, r, n, axes = self.columns.shape
        some = np.moveaxis(rows[:, self.rows], 0, 1) @ self.columns.reshape(g, r, n * axes)
        return np.moveaxis(some, 0, 1).reshape(len(rows), g, n, axes)


def _one_by_one(
    peeled: Iterable[_Peeled],
    shifts: Sequence[_Shifts],
    limits: tuple[float, float] = (LIMIT, NEXT),
    most: float = LARGEST_SHARE,
) -> _Peeled | None:
    """What stands out, until the next does not; None where that is more than a share of them.

    They do by so many standard errors (`limits`): the first, and those after it.
    """
    for state in _as_many(peeled, shifts, most):
        if state.next <= limits[len(state.rows) > 0]:
            return state
    return None


def _far_off(
    peel: Callable[[bool], Iterable[_Peeled]], shifts: Sequence[_Shifts], clean: float | None
) -> _Peeled:
    """What stands far out, though far more is left than noise.

    Args:
        peel: Takes out the worst one by one; whether the noise is known.
        shifts: What a shift of each reading does.
        clean: The most that the stated noise leaves (None: nobody stated it).
    """
    far = (ALONE, ALONE)
    if clean is not None:
        found = _one_by_one(peel(True), shifts, far, MANY)
        if found is not None and found.left <= clean:
            return found
    # Several hide each other, also by the noise that is made of them: the last that stood far out
    # of what is left without it counts, however many are taken before.
    states = list(_as_many(peel(False), shifts, MANY))
    out = (before.next * before.noise / after.noise for before, after in pairwise(states))
    last = max((k for k, far in enumerate(out, start=1) if far > ALONE), default=0)
    if last < len(states) and states[last].next <= LIMIT:
        return states[last]
    found = None if clean is None else _one_by_one(states, shifts, far)
    return states[0] if found is None else found


def _as_many(
    peeled: Iterable[_Peeled], shifts: Sequence[_Shifts], most: float
) -> Iterator[_Peeled]:
    """While no more than a share of the readings was taken out."""
    count = sum(each.readings.size for each in shifts)
    return takewhile(lambda state: len(state.rows) <= most * count, peeled)


def _peeled(
    X: Array,
    prior: Array,
    y: Array,
    shifts: Sequence[_Shifts],
    sigma_known: bool,
    noise: float | None = None,
) -> Iterator[_Peeled]:
    """Take out, one by one, the reading that stands out most of the columns X (R, P).

    These are drawn towards zero by `prior` (P,). A shift that joins the fit adds rows to `half`,
    with which halfᵀ half is the fit again.
    """
    out: list[int] = []
    count = 1 + max((int(each.readings.max()) for each in shifts), default=-1)
    half = _Half(_half(X, prior))
    residual = y - half.first.T @ (half.first @ y)
    leverage = (half.first**2).sum(0)
    total, left, score = (np.zeros((count, 3)) for _ in range(3))
    for each in shifts:
        total[each.readings] = (each.columns**2).sum(1)
        left[each.readings] = total[each.readings] - (each.along(half.first) ** 2).sum(0)
    while True:
        size = noise
        if size is None:
            size = 1.0 if sigma_known else robust_scale(residual, leverage)
        for each in shifts:
            score[each.readings] = np.abs(each.along(residual[None])[0])
        score /= size * np.sqrt(np.maximum(left, 1e-9))
        score[left <= LEAST_LEFT * total] = 0.0
        score[out] = 0.0
        worst = int(score.max(axis=1).argmax())
        rows = np.array(sorted(out), dtype=np.intp)
        yield _Peeled(rows, float(y @ residual) / size**2, size, float(score[worst].max()))
        out.append(worst)
        new = half.join(shifts, worst)
        residual = residual - new.T @ (new @ y)
        leverage += (new**2).sum(0)
        for each in shifts:
            left[each.readings] -= (each.along(new) ** 2).sum(0)


class _Half:
    """Rows (P, R) with which halfᵀ half is a fit, and those that join it one after the other."""

    def __init__(self, first: Array) -> None:
        self.first = first
        self._more = np.empty((0, first.shape[1]))
        self._joined = 0

    def join(self, shifts: Sequence[_Shifts], reading: int) -> Array:
        """(k, R) rows that join when a shift of one reading is free, drawn to nothing."""
        group = next(each for each in shifts if reading in each.readings)
        pose, place = np.argwhere(group.readings == reading)[0]
        rows, own = group.rows[pose], group.columns[pose, :, place]
        more = self._more[: self._joined]
        near, far = self.first[:, rows] @ own, more[:, rows] @ own
        free = -(self.first.T @ near) - more.T @ far
        free[rows] += own
        values, vectors = np.linalg.eigh(own.T @ own - near.T @ near - far.T @ far)
        seen = values > ROUNDING * values.max()
        new = np.asarray((free @ (vectors[:, seen] / np.sqrt(values[seen]))).T)
        if self._joined + len(new) > len(self._more):  # room for twice as many
            self._more = np.vstack([self._more, new, np.empty_like(self._more)])
        self._more[self._joined : self._joined + len(new)] = new
        self._joined += len(new)
        return new


def _shift_columns(whitener: Whitens, pose: Index, borne_out: Mask | None = None) -> list[_Shifts]:
    """The shifts of all readings. Whitening mixes rows of one pose (R,) only."""
    count, reading = whitener.n_readings, whitener.reading
    numbers = rows_by_label(pose)  # of each pose
    members = [np.unique(reading[rows]) for rows in numbers]
    position = np.zeros(count, dtype=np.intp)
    for own in members:
        position[own] = np.arange(len(own))
    width = int(position.max(initial=0)) + 1
    unit = np.zeros((count, 3, width, 3))
    unit[np.arange(count), :, position, :] = np.eye(3)
    if borne_out is not None:
        unit[borne_out] = 0.0
    white = whitener.apply(unit.reshape(count, 3, -1)).reshape(len(reading), width, 3)
    alike: dict[tuple[int, int], list[int]] = {}
    for k, (own, rows) in enumerate(zip(members, numbers, strict=True)):
        alike.setdefault((len(own), len(rows)), []).append(k)
    return [
        _Shifts(
            np.array([members[k] for k in poses]),
            np.array([numbers[k] for k in poses]),
            np.array([white[numbers[k]][:, :n] for k in poses]),
        )
        for (n, _), poses in alike.items()
    ]


def robust_scale(residual: Array, leverage: Array) -> float:
    """Scale of the noise from residuals, each put right for what the fit took of it."""
    free = leverage < 1.0 - LEAST_LEFT
    if not free.any():
        return 1.0
    fair = residual[free] / np.sqrt(1.0 - leverage[free])
    return float(1.4826 * np.median(np.abs(fair))) or 1.0
