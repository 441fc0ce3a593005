"""Sums over poses of linearised readings, and least squares on them.

A thousand models of the same readings share XᵀX and Xᵀy; every one of them is a few rows of these.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.linalg.lapack import dposv, dtrtrs

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.measurements.poses import rows_by_label

WIDE = 4  # columns per row of a pose beyond which the sums of all poses take too much room
DEPENDENT = 1e-6  # part of a column beyond the ones before it that is rounding


@dataclass(frozen=True, eq=False)
class Sums:
    """XᵀX, Xᵀy, yᵀy and the number of rows of some choice of poses; `scores` remembers models.

    `form` has the same of the part in which model-form error outweighs the noise.
    """

    gram: Array
    moment: Array
    square: float
    count: float
    form: Sums | None = None
    _marginals: dict[tuple[bytes, float, bytes | None], Marginal] = field(default_factory=dict)
    _inverses: dict[bytes, Array] = field(default_factory=dict)
    scores: dict[bytes, Any] = field(default_factory=dict)

    def left_by(self, solved: Solved | Solutions) -> Array:
        """What a solution leaves of yᵀy, or each of several."""
        v, columns = solved.values, solved.columns
        inner = (self.gram[columns[..., None], columns[..., None, :]] @ v[..., None])[..., 0]
        return np.asarray(self.square + (v * (inner - 2.0 * self.moment[columns])).sum(axis=-1))

    def inverse(self, columns: Index, some: Mask) -> Array:
        """(k, k) inverse of XᵀX for some of k columns, zero for the others."""
        key = columns.tobytes() + some.tobytes()
        if key not in self._inverses:
            within = columns[some]
            gram = self.gram[np.ix_(within, within)]
            scale = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
            both = np.outer(scale, scale)
            out = np.zeros((len(columns), len(columns)))
            out[np.ix_(some, some)] = np.linalg.pinv(gram * both) * both
            self._inverses[key] = out
        return self._inverses[key]

    def marginal(self, members: Index, size: float, columns: Index | None = None) -> Marginal:
        """The sums with columns integrated out whose values are draws of one size τ.

        With y = X v + Z u + noise and u ~ N(0, τ²), Z u joins the noise.

        Args:
            members: The columns that are integrated out.
            size: τ, in typical sizes.
            columns: Columns of which the sums are asked, those of others are zero; default: all.
        """
        some: Any = slice(None) if columns is None else columns
        block: Any = (some, some) if columns is None else np.ix_(some, some)
        key = (members.tobytes(), size, None if columns is None else columns.tobytes())
        if key not in self._marginals:
            inner = self.gram[np.ix_(members, members)] + np.eye(len(members)) / size**2
            factor: Array = np.asarray(np.linalg.cholesky(inner), dtype=float)
            half = solve_triangular(factor, self.gram[members][:, some], lower=True)
            right = solve_triangular(factor, self.moment[members], lower=True)
            gram, moment = np.zeros(self.gram.shape), np.zeros(self.moment.shape)
            gram[block] = self.gram[block] - half.T @ half
            moment[some] = self.moment[some] - half.T @ right
            sums = Sums(gram, moment, self.square - float(right @ right), self.count)
            price = 2.0 * float(np.log(np.diag(factor)).sum() + len(members) * np.log(size))
            self._marginals[key] = Marginal(sums, price, members, factor)
        return self._marginals[key]


def sums_of(X: Array, y: Array) -> Sums:
    """Sums of rows (R, k) and readings (R,) that count once each."""
    return Sums(X.T @ X, X.T @ y, float(y @ y), float(len(y)))


def weighing(
    X: Array, y: Array, group: Index, columns: Index, size: int
) -> Callable[[Array], Sums]:
    """Sums of rows as a function of how often (g,) each pose counts.

    Where poses have many rows for the columns, the sums of each are made once.

    Args:
        X, y, group: (R, k) columns, (R,) readings and their poses.
        columns, size: Which of so many columns these are; the sums of the others are zero.
    """
    whole = np.column_stack([X, y])
    poses = rows_by_label(group)
    if len(poses) * whole.shape[1] <= WIDE * len(whole):
        labels = group[[rows[0] for rows in poses]]
        each = np.empty((len(poses), whole.shape[1], whole.shape[1]))
        for out, rows in zip(each, poses, strict=True):
            np.matmul(whole[rows].T, whole[rows], out=out)
        count = np.array([len(rows) for rows in poses])

        def inner(weights: Array) -> tuple[Array, float]:
            return np.tensordot(weights[labels], each, axes=1), float(weights[labels] @ count)
    else:

        def inner(weights: Array) -> tuple[Array, float]:
            root = np.sqrt(weights)[group]
            kept = np.flatnonzero(root)
            part = whole[kept] * root[kept, None]
            return part.T @ part, float(root @ root)

    def weighed(weights: Array) -> Sums:
        product, counted = inner(weights)
        gram, moment = np.zeros((size, size)), np.zeros(size)
        gram[columns[:, None], columns] = product[:-1, :-1]
        moment[columns] = product[:-1, -1]
        return Sums(gram, moment, float(product[-1, -1]), counted)

    return weighed


@dataclass(frozen=True, eq=False)
class Marginal:
    """Sums without columns that were integrated out.

    Attributes:
        sums: What is left for the other columns.
        price: ln det(1 + τ² ZᵀZ), what the freedom of the draws costs.
        members: The columns.
        factor: Cholesky factor of ZᵀZ + 1/τ².
    """

    sums: Sums
    price: float
    members: Index
    factor: Array

    def joined(self, whole: Sums, rest: Solved) -> Solved:
        """The solution of the other columns with the most likely draws beside it."""
        right = whole.moment[self.members]
        right = right - whole.gram[np.ix_(self.members, rest.columns)] @ rest.values
        draws = np.asarray(cho_solve((self.factor, True), right), dtype=float)
        return Solved(
            np.concatenate([rest.columns, self.members]),
            np.concatenate([rest.values, draws]),
            rest.rss,
        )


@dataclass(frozen=True, eq=False)
class Solved:
    """Least squares over some columns.

    Attributes:
        columns: Columns that moved freely; others asked for lie on their bound of zero.
        values: Their values in typical sizes.
        rss: Residual sum of squares.
    """

    columns: Index
    values: Array
    rss: float


@dataclass(frozen=True, eq=False)
class Solutions:
    """Least squares over several sets of columns, each filled up to k.

    Attributes:
        columns: (m, k) the columns asked for.
        moves: (m, k) those of them that moved freely.
        values: (m, k) their values in typical sizes, zero for the others.
        rss: (m,) residual sums of squares.
    """

    columns: Index
    moves: Mask
    values: Array
    rss: Array

    def each(self) -> list[Solved]:
        """One after the other."""
        rows = zip(self.columns, self.moves, self.values, self.rss.tolist(), strict=True)
        return [Solved(columns[moves], v[moves], rss) for columns, moves, v, rss in rows]


def solve_sets(sums: Sums, sets: Sequence[Index], lower: Array, plausible: Array) -> Solutions:
    """Least squares over sets of columns with non-negative values where `lower` is zero.

    Values are drawn towards zero as if their plausible range were a standard deviation, which only
    counts in directions that the readings do not show; `rss` holds that share too.

    Columns that would be negative are dropped, the worst first.
    """
    shape = len(sets), max(len(each) for each in sets)
    columns, moves = np.zeros(shape, dtype=np.intp), np.zeros(shape, dtype=bool)
    values, rss = np.zeros(shape), np.zeros(len(sets))
    size = np.sqrt(sums.gram.diagonal() + plausible**-2.0)
    shown = size > 0.0
    size[~shown] = 1.0
    problem = _Scaled(sums, size, sums.moment / size, shown, lower == 0.0)
    for k, each in enumerate(sets):
        places, found, rss[k] = _least_squares(problem, each)
        columns[k, : len(each)], moves[k, places], values[k, places] = each, True, found
    return Solutions(columns, moves, values, rss)


class _Scaled(NamedTuple):
    """Least squares of which every column has length one, its prior included.

    Attributes:
        sums: Of the columns as they are.
        size: (P,) their lengths; 1 for those that are not `shown` at all.
        right: (P,) their moments.
        shown: (P,) those that are not zero.
        bounded: (P,) those whose values are not negative.
    """

    sums: Sums
    size: Array
    right: Array
    shown: Mask
    bounded: Mask


def _least_squares(problem: _Scaled, columns: Index) -> tuple[Index, Array, float]:
    """Places of those columns that move, their values, and the residual sum of squares."""
    sums, size, right = problem.sums, problem.size[columns], problem.right[columns]
    bounded = problem.bounded[columns]
    active = problem.shown[columns].nonzero()[0]
    whole = sums.gram[columns[:, None], columns] / (size[:, None] * size)
    whole.flat[:: len(columns) + 1] = 1.0
    while len(active):
        if len(active) < len(columns):
            scaled, along = whole.take(active, axis=0).take(active, axis=1), right.take(active)
        else:
            scaled, along = whole, right
        factor, found, failed = dposv(scaled, along, lower=1)
        if failed:
            drop = _dependent(scaled)
        else:
            pivots = factor.diagonal()
            drop = int(pivots.argmin())
            if pivots[drop] >= DEPENDENT:
                held = found * bounded.take(active)
                drop = int(held.argmin())
                if held[drop] >= 0.0:
                    half, _ = dtrtrs(factor, along, lower=1)
                    rss = max(sums.square - float(half @ half), 0.0)
                    return active, found / size.take(active), rss
        active = np.concatenate((active[:drop], active[drop + 1 :]))
    return active, np.zeros(0), sums.square


def _dependent(scaled: Array) -> int:
    """The last column that the ones before it already span."""
    _, vectors = np.linalg.eigh(scaled)
    involved = np.abs(vectors[:, 0]) > 1e-3 * np.abs(vectors[:, 0]).max()
    return int(np.flatnonzero(involved)[-1])
