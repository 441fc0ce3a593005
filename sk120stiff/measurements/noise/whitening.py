"""Whitening by the exact Cholesky factor of a diagonal plus one shared error per group.

A group of rows that subtract the same zero reading has, per axis, the covariance
V = diag(d) + c·11ᵀ: d the own variances, c that of the shared zero. Its Cholesky factor L need not
be built. Row i of L⁻¹x is the innovation of x_i, given the rows before it: with the sums over those
rows t = Σ 1/d_j and s = Σ x_j/d_j, the best guess of the shared error is g·s with g = c/(1 + c·t),
and the variance left is d_i + g. Hence L⁻¹x = (x_i − g·s)/√(d_i + g).

An axis that was not read has an infinite variance d: it adds nothing to t and s, and has no row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.errors import InputError


class Whitens(Protocol):
    """V^(-1/2) of some covariance V of N displacement readings, of which R numbers were read."""

    n_readings: int
    reading: Index
    """(R,) reading of each number that `apply` whitens."""
    logdet: float
    """Natural logarithm of det V, over all numbers that were read; V in m²."""

    def apply(self, x: ArrayLike) -> Array:
        """V^(-1/2) x: (N, 3) becomes (R,), and (N, 3, k) becomes (R, k); see `Whitener.apply`."""
        ...


class Whitener:
    """L⁻¹ of the covariance V = L Lᵀ of N displacement readings.

    Args:
        own: (N, 3) variance of each row's own error, m², positive; infinite where not read.
        shared: (N, 3) variance of the error that rows of a group share, m², equal within a group.
        group: (N,) number of the group of each row.
        axes: (N, 3, 3) unit vectors, as rows, along which the variances are, where that is not
            along the axes of the readings; equal within a group. Rows that lack an axis have none
            of their own.
    """

    def __init__(
        self, own: Array, shared: Array, group: Integers, axes: Array | None = None
    ) -> None:
        if own.ndim != 2 or own.shape[1] != 3 or shared.shape != own.shape:
            raise InputError(f"variances of shapes {own.shape} and {shared.shape} are no (N, 3)")
        if not (np.all(own > 0) and np.all(np.isfinite(shared)) and np.all(shared >= 0)):
            raise InputError("a variance is not positive")
        self.n_readings = len(own)
        self._axes = axes
        read = np.isfinite(own)
        self._read = None if read.all() else read  # (N, 3); None: everything
        self.reading: Index = np.nonzero(read)[0]
        """(R,) reading of each number that `apply` whitens."""
        self._blocks: list[tuple[Integers, Array, Array, Array]] = []
        logdet = 0.0
        for rows in _blocks(np.asarray(group)):
            own_inverse = 1.0 / own[rows]  # (g, L, 3)
            c = shared[rows]
            gain = c / (1.0 + c * _sum_before(own_inverse))
            variance = own[rows] + gain
            logdet += float(np.sum(np.log(variance[np.isfinite(variance)])))
            self._blocks.append((rows, own_inverse, gain, 1.0 / np.sqrt(variance)))
        self.logdet = logdet
        """Natural logarithm of det V, over all numbers that were read; V in m²."""

    def apply(self, x: ArrayLike) -> Array:
        """L⁻¹x: (N, 3) becomes (R,), and (N, 3, k) becomes (R, k), row by row and axis by axis.

        R numbers were read, 3N at most. `x` is in the axes in which the displacements were
        reported; what it has in an axis that was not read does not matter.
        """
        values = as_columns(x, self.n_readings)
        columns = values.reshape(self.n_readings, 3, -1)
        if self._read is not None:
            columns = np.where(self._read[:, :, None], columns, 0.0)
        if self._axes is not None:
            columns = self._axes @ columns
        out = np.empty_like(columns)
        for rows, own_inverse, gain, scale in self._blocks:
            block = columns[rows]  # (g, L, 3, k)
            if rows.shape[1] > 1:
                block = block - gain[..., None] * _sum_before(block * own_inverse[..., None])
            out[rows] = block * scale[..., None]
        numbers = out.reshape(3 * self.n_readings, -1) if self._read is None else out[self._read]
        return numbers.reshape(len(numbers), *values.shape[2:])


def as_columns(x: ArrayLike, count: int) -> Array:
    """The array, if it is (count, 3) or (count, 3, k).

    Raises:
        InputError: It is of another shape.
    """
    values = np.asarray(x, dtype=np.float64)
    if values.shape[:2] != (count, 3) or values.ndim > 3:
        raise InputError(
            f"an array of shape {values.shape} cannot be whitened",
            remedy=f"Give ({count}, 3) or ({count}, 3, k).",
        )
    return values


def _blocks(group: Integers) -> list[Integers]:
    """Rows of groups of equal size together: arrays (groups, size) of row numbers."""
    order = np.argsort(group, kind="stable")
    _, start, size = np.unique(group[order], return_index=True, return_counts=True)
    return [order[start[size == k][:, None] + np.arange(k)] for k in np.unique(size)]


def _sum_before(x: Array) -> Array:
    """Sums over the rows before each row of a block, along axis 1."""
    sums = np.zeros_like(x)
    np.cumsum(x[:, :-1], axis=1, out=sums[:, 1:])
    return sums


class Shortening:
    """(I + Z Zᵀ)^(-1/2) for columns Z that each group of numbers has of its own.

    Z = U S Vᵀ leaves what is across U as it is and shortens what lies along it, by 1/√(1 + s²).

    Args:
        groups: Of each group its numbers (r,); none is in two.
        columns: Of each group its columns (r, k), whitened.
    """

    def __init__(self, groups: Sequence[Index], columns: Sequence[Array]) -> None:
        self.directions: list[tuple[Array, Array]] = [(Z, Z) for Z in columns]
        """Of each group the directions U (r, k) and the sizes s (k,)."""
        self.logdet = 0.0
        """Natural logarithm of det(I + Z Zᵀ)."""
        self._alike: list[tuple[Index, Array, Array]] = []
        """Of groups of one shape: their numbers (m, r), U (m, r, k) and what is lost (m, k)."""
        shapes: dict[tuple[int, ...], list[int]] = {}
        for k, Z in enumerate(columns):
            shapes.setdefault(Z.shape, []).append(k)
        for _, places in sorted(shapes.items()):
            U, s, _ = np.linalg.svd(np.stack([columns[k] for k in places]), full_matrices=False)
            numbers = np.stack([groups[k] for k in places])
            self._alike.append((numbers, U, 1.0 - 1.0 / np.sqrt(1.0 + s**2)))
            self.logdet += float(np.log1p(s**2).sum())
            for k, own, size in zip(places, U, s, strict=True):
                self.directions[k] = own, size

    def apply(self, white: Array) -> Array:
        """(R, ...) shortened, in place where memory allows."""
        flat = white.reshape(len(white), -1)
        for numbers, U, lost in self._alike:
            flat[numbers] -= U @ (lost[:, :, None] * (np.swapaxes(U, 1, 2) @ flat[numbers]))
        return flat.reshape(white.shape)
