"""What effects of known sizes leave of the readings of one fit, beyond what its parameters take on.

With Z the random effects of poses, X the derivative, both whitened by the noise in û and C alone,

    left = (Z − X (XᵀX)⁻¹ XᵀZ) u = A u,   u ~ N(û, C) given the gap

(Searle, Casella & McCulloch, chapter 7). Its square is a quadratic form of normal variables, taken
for a multiple of χ² (Satterthwaite 1946).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array
from sk120stiff.identify.uncertainty.laid_out import LaidOut, Products, orthonormal_parameters
from sk120stiff.measurements.model_form import ModelForm

ENDS = (0.025, 0.975)  # of an interval that holds 95 %
SHORT = 1e-6  # of the longest: what a direction has of its own


@dataclass(frozen=True, eq=False)
class LeftByPoses:
    """What random effects of poses leave.

    C is a matrix per pose and one of the rank of X; so is K = AᵀA. Nothing larger is built.
    """

    white: Products
    raw: Products
    proportional: int
    rows: int

    @classmethod
    def of(cls, laid: LaidOut) -> LeftByPoses:
        """From the gap of a fitted model."""
        return cls(laid.white(), laid.raw(), laid.proportional, laid.rows)

    def of_sizes(self, form: ModelForm, noise_factor: float) -> tuple[float, float, float]:
        """2.5 %, mean and 97.5 % of what is left, rms per axis [m]."""
        q = self.white.zz.shape[1]
        size = np.where(np.arange(q) < self.proportional, form.proportional, form.constant)
        white, raw = self._scaled(self.white, size), self._scaled(self.raw, size)
        variance = noise_factor**2
        T = orthonormal_parameters(white.xx[:-1, :-1] / variance)
        W, H = white.zx[:, :, :-1] @ T / variance, raw.zx[:, :, :-1] @ T
        D, B = raw.zz, np.linalg.inv(np.eye(q) + white.zz / variance)
        V = B @ W
        S = np.linalg.inv(np.eye(T.shape[1]) - _dot(W, V))
        U = np.concatenate([W, H], axis=2)
        one, R = np.eye(T.shape[1]), T.T @ raw.xx[:-1, :-1] @ T
        middle = np.block([[R, -one], [-one, np.zeros_like(one)]])

        def C(x: Array) -> Array:
            return B @ x + V @ (S @ _dot(V, x))

        def K(x: Array) -> Array:
            return D @ x + U @ (middle @ _dot(U, x))

        gap = white.zx[:, :, -1:] / variance - W @ (T.T @ white.xx[:-1, -1:] / variance)
        likeliest = C(gap)
        E, F = np.concatenate([D @ V @ S, U @ middle], axis=2), np.concatenate([V, C(U)], axis=2)
        DB = D @ B
        mean = _dot(likeliest, K(likeliest)).item() + np.trace(DB, axis1=1, axis2=2).sum()
        mean += np.trace(_dot(F, E))
        spread = np.trace(DB @ DB, axis1=1, axis2=2).sum() + 2.0 * np.trace(_dot(F, DB @ E))
        spread += np.trace(_dot(F, E) @ _dot(F, E))
        pull = K(likeliest)
        return _ends(mean, 2.0 * spread + 4.0 * _dot(pull, C(pull)).item(), self.rows)

    @staticmethod
    def _scaled(sums: Products, size: Array) -> Products:
        return Products(sums.zz * np.outer(size, size), sums.zx * size[:, None], sums.xx)


def _dot(x: Array, y: Array) -> Array:
    """xᵀy of (G, q, m) and (G, q, n): (m, n)."""
    return np.asarray(np.einsum("gqm,gqn->mn", x, y))


def left_by_all(laid: LaidOut, columns: Array, noise_factor: float) -> tuple[float, float, float]:
    """What columns that all poses share leave, as `LeftByPoses.of_sizes`.

    Args:
        laid: The gap of a fitted model.
        columns: (N, 3, k) change of the readings per unit of each of k factors, reading axes [m].
        noise_factor: The noise over the one assumed.
    """
    rows, noise = laid.rows, laid.problem.whitener
    white, taken = noise.apply(columns), noise.apply(laid.derivative)
    T = orthonormal_parameters(taken[:, :-1].T @ taken[:, :-1])
    inside, gap = taken[:, :-1] @ T, taken[:, -1]
    imitated = inside.T @ white
    U, size, right = np.linalg.svd(white - inside @ imitated, full_matrices=False)
    seen = size > SHORT * max(float(np.linalg.norm(white, axis=0).max(initial=0.0)), 1e-300)
    along = U[:, seen].T @ (gap - inside @ (inside.T @ gap))
    square = float(along @ along)
    if not len(along):
        return 0.0, 0.0, 0.0
    read = laid.problem.read
    moved = columns[read] - laid.derivative[:, :, :-1][read] @ T @ imitated
    moved = moved @ right[seen].T / size[seen]
    variance = noise_factor**2
    kept = max(1.0 - variance * len(along) / square, 0.0) if square else 0.0
    K, likeliest, C = moved.T @ moved, kept * along, kept * variance
    mean = float(likeliest @ K @ likeliest + C * np.trace(K))
    deviation = float(2.0 * C**2 * np.trace(K @ K) + 4.0 * C * likeliest @ K @ K @ likeliest)
    return _ends(mean, deviation, rows)


def _ends(mean: float, variance: float, rows: int) -> tuple[float, float, float]:
    """2.5 %, mean and 97.5 % of a sum of squares over so many rows, as rms."""
    if mean <= 0.0 or variance <= 0.0:
        return 0.0, 0.0, 0.0
    freedom = 2.0 * mean**2 / variance
    low, high = stats.chi2.ppf(ENDS, freedom) / freedom
    low, middle, high = np.sqrt(mean / rows * np.array([low, 1.0, high]))
    return float(low), float(middle), float(max(high, middle))
