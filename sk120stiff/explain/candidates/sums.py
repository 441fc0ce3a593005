"""Sums over poses of linearised readings, and least squares on them.

A thousand models of the same readings share XᵀX and Xᵀy; every one of them is a few rows of these.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg.lapack import dpotrf, dtrtrs

from sk120stiff.arrays import Array, Index

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
    _marginals: dict[tuple[bytes, float], Marginal] = field(default_factory=dict)
    _inverses: dict[bytes, Array] = field(default_factory=dict)
    scores: dict[bytes, Any] = field(default_factory=dict)

    def left_by(self, solved: Solved) -> float:
        """What a solution leaves of yᵀy."""
        v = solved.values
        inner = self.gram[solved.columns[:, None], solved.columns] @ v
        return self.square + float(v @ (inner - 2.0 * self.moment[solved.columns]))

    def over(self, columns: Index, right: Array) -> Array:
        """(XᵀX)⁻¹ of some columns, on a right-hand side (k, ...)."""
        key = columns.tobytes()
        if key not in self._inverses:
            gram = self.gram[np.ix_(columns, columns)]
            scale = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
            self._inverses[key] = np.linalg.pinv(gram * np.outer(scale, scale)) * np.outer(
                scale, scale
            )
        return np.asarray(self._inverses[key] @ right)

    def marginal(self, members: Index, size: float) -> Marginal:
        """The sums with columns integrated out whose values are draws of one size τ.

        With y = X v + Z u + noise and u ~ N(0, τ²), Z u joins the noise.
        """
        key = (members.tobytes(), size)
        if key not in self._marginals:
            inner = self.gram[np.ix_(members, members)] + np.eye(len(members)) / size**2
            factor: Array = np.asarray(np.linalg.cholesky(inner), dtype=float)
            half = np.linalg.solve(factor, self.gram[members])
            right = np.linalg.solve(factor, self.moment[members])
            sums = Sums(
                self.gram - half.T @ half,
                self.moment - half.T @ right,
                self.square - float(right @ right),
                self.count,
            )
            price = 2.0 * float(np.log(np.diag(factor)).sum() + len(members) * np.log(size))
            self._marginals[key] = Marginal(sums, price, members, factor)
        return self._marginals[key]


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
        draws = np.linalg.solve(self.factor.T, np.linalg.solve(self.factor, right))
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


def solve_columns(sums: Sums, columns: Index, lower: Array, plausible: Array) -> Solved:
    """Least squares over `columns` with non-negative values where `lower` is zero.

    Values are drawn towards zero as if their plausible range were a standard deviation, which only
    counts in directions that the readings do not show; `rss` holds that share too.

    Columns that would be negative are dropped, the worst first.
    """
    drawn = plausible[columns] ** -2.0
    size = np.sqrt(sums.gram[columns, columns] + drawn)
    seen = size > 0.0
    columns, size = columns[seen], size[seen]
    whole = sums.gram[columns[:, None], columns] / (size[:, None] * size)
    whole.flat[:: len(columns) + 1] = 1.0
    right = sums.moment[columns] / size
    bound = lower[columns] == 0.0
    active = np.arange(len(columns))
    while len(active):
        scaled = whole[active[:, None], active] if len(active) < len(columns) else whole
        factor, failed = dpotrf(scaled, lower=1, clean=0)
        if failed:
            active = np.delete(active, _dependent(scaled))
            continue
        least = int(factor.diagonal().argmin())
        if factor[least, least] < DEPENDENT:
            active = np.delete(active, least)
            continue
        half, _ = dtrtrs(factor, right[active], lower=1)
        found, _ = dtrtrs(factor, half, lower=1, trans=1)
        forbidden = (found < 0.0) & bound[active]
        if not forbidden.any():
            rss = max(sums.square - float(half @ half), 0.0)
            return Solved(columns[active], found / size[active], rss)
        worst = int(np.where(forbidden, found, np.inf).argmin())
        active = np.concatenate((active[:worst], active[worst + 1 :]))
    return Solved(columns[:0], np.zeros(0), sums.square)


def _dependent(scaled: Array) -> int:
    """The last column that the ones before it already span."""
    _, vectors = np.linalg.eigh(scaled)
    involved = np.abs(vectors[:, 0]) > 1e-3 * np.abs(vectors[:, 0]).max()
    return int(np.flatnonzero(involved)[-1])
