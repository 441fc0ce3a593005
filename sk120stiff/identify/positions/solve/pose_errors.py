"""What all readings of a pose have in common beyond the model: the tool is not where it should be.

Gears and bearings put every pose off by something of its own, and whatever is read there shares it:
three markers on the tool, the marker under one payload after the other. Taken for independent
noise it makes the readings of a pose count several times, and hides what differs between them. So
the tool of each pose is shifted and turned by a draw of its own, every way alike, as far as joints
shift and turn it that stand off by one size τ:

    V = D (I + τ² Z_p Z_pᵀ) D  for every pose,   D = diag(σ),   Z_p = D⁻¹ ∂x/∂(shift, turn)

with x the readings, and τ by restricted likelihood (Patterson & Thompson 1971). Where no pose was
read twice the two cannot be told apart, and all is noise.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array, Index, lengths_of

RANGE = (-16.0, -4.0)  # ln of rad or m; as joints that stand off by 0.1 µrad to 20 mrad
NOTHING = -50.0  # the same of no error at all
CLEAR = 10.83  # fall of -2 ln L, which noise alone brings in one case of 2000


@dataclass(frozen=True, eq=False)
class PoseWhitening:
    """V^(-1/2) of M numbers.

    Args:
        sigma: (M,) standard uncertainty of each number by itself [m or rad].
        ways: (M, k) change of each number by what its pose has of its own, or None: independent.
        pose: (M,) pose of each number.
        common: τ, standard size of each of these [rad or m].
    """

    sigma: Array
    ways: Array | None = None
    pose: Index | None = None
    common: float = 0.0

    @cached_property
    def _parts(self) -> list[tuple[Index, Array, Array]]:
        """Of each pose its numbers (m,), directions (m, k) and variance along them, noise 1."""
        if self.ways is None or self.pose is None or self.common == 0.0:
            return []
        return [
            (rows, U, (self.common * size) ** 2)
            for rows, U, size in directions(self.ways / self.sigma[:, None], self.pose)
        ]

    @cached_property
    def logdet(self) -> float:
        """Natural logarithm of the determinant of the covariance."""
        more = sum(float(np.log1p(variance).sum()) for _, _, variance in self._parts)
        return float(2.0 * np.log(self.sigma).sum()) + more

    def apply(self, x: ArrayLike) -> Array:
        """(M, ...) in units of the noise, and independent."""
        flat = np.array(x, dtype=float)
        flat = (flat.T / self.sigma).T
        for rows, U, variance in self._parts:
            part = flat[rows]
            flat[rows] = part + U @ (((1.0 + variance) ** -0.5 - 1.0) * (U.T @ part).T).T
        return flat

    def undo(self, white: ArrayLike) -> Array:
        """(M, ...) as they were before `apply`."""
        flat = np.array(white, dtype=float)
        for rows, U, variance in self._parts:
            part = flat[rows]
            flat[rows] = part + U @ (((1.0 + variance) ** 0.5 - 1.0) * (U.T @ part).T).T
        return np.asarray((flat.T * self.sigma).T)


class Common(NamedTuple):
    """What the readings of a pose have in common.

    Attributes:
        size: τ [rad or m]; 0 where noise may be all.
        noise: Noise over the one assumed, beside it.
        gained: By how much -2 ln L falls with it.
    """

    size: float
    noise: float
    gained: float

    @property
    def chance(self) -> float:
        """Probability that noise alone would show as much: a size is not negative."""
        return 0.5 * float(stats.chi2.sf(self.gained, 1))


def directions(white: Array, pose: Index) -> Iterator[tuple[Index, Array, Array]]:
    """Of each pose its numbers (m,), the ways in which it moves them (m, k), and how far (k,)."""
    order = np.argsort(pose, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(pose[order])) + 1):
        U, size, _ = np.linalg.svd(white[rows], full_matrices=False)
        kept = size > 1e-12 * max(float(size.max(initial=0.0)), 1e-300)
        yield rows, U[:, kept], size[kept]


def common_error(
    gap: Array, derivative: Array, whitening: PoseWhitening, *, stated: bool
) -> Common:
    """How far the tool is off at a pose, in offsets of joints.

    Args:
        gap: (M,) what a fit leaves [m or rad].
        derivative: (M, P) of the readings by what was estimated, in any units.
        whitening: σ, ways and poses; its τ does not count.
        stated: σ is stated, and what is left may be more, but not less.
    """
    if whitening.ways is None or whitening.pose is None:
        return Common(0.0, 1.0, 0.0)
    white = whitening.ways / whitening.sigma[:, None]
    parts = list(directions(white, whitening.pose))
    X = derivative / whitening.sigma[:, None]
    size = lengths_of(X)
    X = X[:, size > 0.0] / size[size > 0.0]
    U, told, _ = np.linalg.svd(X, full_matrices=False)
    X = U[:, told > 1e-9 * told.max(initial=1e-300)]  # what they span, of full rank
    A = np.column_stack([X, gap / whitening.sigma])
    inside = [(rows, U, size**2, U.T @ A[rows]) for rows, U, size in parts]
    freedom = max(len(gap) - X.shape[1], 1)

    def unlikely(logarithm: float) -> tuple[float, float]:
        """-2 ln L, restricted, at its likeliest noise; and that noise over the one assumed."""
        tau2, level, B = float(np.exp(2.0 * logarithm)), 0.0, A.copy()
        for rows, U, square, along in inside:
            variance = tau2 * square
            B[rows] += U @ (((1.0 + variance) ** -0.5 - 1.0)[:, None] * along)
            level += float(np.log1p(variance).sum())
        R = np.linalg.qr(B, mode="r")
        own = np.abs(np.diag(R))
        left = float(own[-1] ** 2)
        level += 2.0 * float(np.log(np.maximum(own[:-1], 1e-300)).sum())
        noise = max(left / freedom, 1.0 if stated else 1e-300)
        return float(left / noise + freedom * np.log(noise) + level), float(np.sqrt(noise))

    grid = np.linspace(*RANGE, 13)
    start = grid[int(np.argmin([unlikely(each)[0] for each in grid]))]
    best = minimize_scalar(
        lambda each: unlikely(each)[0],
        bounds=(start - 1.0, start + 1.0), method="bounded", options={"xatol": 0.02},
    )  # fmt: skip
    gained = max(unlikely(NOTHING)[0] - float(best.fun), 0.0)
    if gained <= CLEAR:
        return Common(0.0, unlikely(NOTHING)[1], gained)
    noise = unlikely(best.x)[1]
    return Common(float(np.exp(best.x)) * noise, noise, gained)
