"""What all readings of a pose have in common beyond the model: the tool is not where it should be.

Gears and bearings put every pose off by something of its own, and whatever is read there shares it:
three markers on the tool, the marker under one payload after the other. Taken for independent
noise it makes the readings of a pose count several times, and hides what differs between them. So
the tool of each pose is shifted and turned by a draw of its own, every way alike, as far as joints
shift it that stand off by one size τ, and turned by ρ times as far as these turn it:

    V = D (I + τ² Z_p Z_pᵀ) D  for every pose,   D = diag(σ),   Z_p = D⁻¹ ∂x/∂(shift, ρ turn)

with x the readings, and τ by restricted likelihood (Patterson & Thompson 1971), and so ρ where
something else than 1 stands out: a wrist that yields turns a tool farther than it shifts it, and
turns that count for more than they are worth draw all else after them. Where no pose was read
twice noise and pose cannot be told apart, and all is noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array, Index, Mask, lengths_of
from sk120stiff.measurements.poses import rows_by_label

RANGE = (-16.0, -4.0)  # ln of rad or m; as joints that stand off by 0.1 µrad to 20 mrad
CLEAR = 10.83  # fall of -2 ln L, which noise alone brings in one case of 2000
TURNS = 16.0  # times as far as joints turn it, and as little, that a tool may turn of its own


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
        turning: ρ, how many times as far as joints the tool turns beside its shift.
    """

    size: float
    noise: float
    gained: float
    turning: float = 1.0

    @property
    def chance(self) -> float:
        """Probability that noise alone would show as much: a size is not negative."""
        return 0.5 * float(stats.chi2.sf(self.gained, 1))


def directions(white: Array, pose: Index) -> Iterator[tuple[Index, Array, Array]]:
    """Of each pose its numbers (m,), the ways in which it moves them (m, k), and how far (k,)."""
    for rows in rows_by_label(pose):
        U, size, _ = np.linalg.svd(white[rows], full_matrices=False)
        kept = size > 1e-12 * max(float(size.max(initial=0.0)), 1e-300)
        yield rows, U[:, kept], size[kept]


def common_error(
    gap: Array,
    derivative: Array,
    whitening: PoseWhitening,
    *,
    stated: bool,
    turns: Mask | None = None,
) -> Common:
    """How far the tool is off at a pose, in offsets of joints.

    Args:
        gap: (M,) what a fit leaves [m or rad].
        derivative: (M, P) of the readings by what was estimated, in any units.
        whitening: σ, ways and poses; its τ does not count.
        stated: σ is stated, and what is left may be more, but not less.
        turns: (k,) ways that turn the tool, and may be of another size; None: none may.
    """
    ways, pose = whitening.ways, whitening.pose
    if ways is None or pose is None:
        return Common(0.0, 1.0, 0.0)
    spanned = _spanned(derivative / whitening.sigma[:, None])
    A = np.column_stack([spanned, gap / whitening.sigma])
    likelihood = _Restricted(ways / whitening.sigma[:, None], pose, A, stated)
    turning_ways = np.zeros(ways.shape[1], dtype=bool) if turns is None else turns
    nothing, noise_alone = likelihood.of_noise()

    def least(turning: float, about: float | None = None) -> Common:
        """The likeliest τ beside a ρ; `about` one where it is the likeliest beside another."""
        unlikely = likelihood.with_ways(np.where(turning_ways, turning, 1.0))
        grid = np.linspace(*RANGE, 13)
        if about is None:
            start, wide = grid[int(np.argmin([unlikely(each)[0] for each in grid]))], 1.0
        else:
            start, wide = float(np.log(about)), float(np.log(TURNS))
        best = minimize_scalar(
            lambda each: unlikely(each)[0],
            bounds=(start - wide, start + wide), method="bounded", options={"xatol": 0.02},
        )  # fmt: skip
        noise = unlikely(best.x)[1]
        size = float(np.exp(best.x)) * noise
        return Common(size, noise, max(nothing - float(best.fun), 0.0), turning)

    found = least(1.0)
    if found.gained <= CLEAR:
        return Common(0.0, noise_alone, found.gained)
    if not turning_ways.any() or turning_ways.all():
        return found
    most = float(np.log(TURNS))
    at = found.size / found.noise
    other = minimize_scalar(
        lambda each: -least(float(np.exp(each)), at).gained,
        bounds=(-most, most), method="bounded", options={"xatol": 0.1},
    )  # fmt: skip
    turned = least(float(np.exp(other.x)), at)
    return turned if turned.gained > found.gained + CLEAR else found


def _spanned(X: Array) -> Array:
    """(M, r) what columns (M, P) span, of full rank."""
    size = lengths_of(X)
    U, told, _ = np.linalg.svd(X[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.asarray(U[:, told > 1e-9 * told.max(initial=1e-300)])


@dataclass(frozen=True, eq=False)
class _Restricted:
    """-2 ln L, restricted, of what a fit leaves, as a function of what poses have of their own.

    Attributes:
        ways: (M, k) in units of the noise.
        pose: (M,) pose of each number.
        A: (M, r + 1) what the estimated parameters span, and the gap, in units of the noise.
        stated: See `common_error`.
    """

    ways: Array
    pose: Index
    A: Array
    stated: bool

    def of_noise(self) -> tuple[float, float]:
        """It where all is noise, and that noise over the one assumed."""
        return self._of(self.A, 0.0)

    def with_ways(self, times: Array) -> Callable[[float], tuple[float, float]]:
        """The same as a function of ln τ, with ways so many times as large."""
        A = self.A
        inside = [
            (rows, U, size**2, U.T @ A[rows])
            for rows, U, size in directions(self.ways * times, self.pose)
        ]

        def unlikely(logarithm: float) -> tuple[float, float]:
            tau2, level, B = float(np.exp(2.0 * logarithm)), 0.0, A.copy()
            for rows, U, square, along in inside:
                variance = tau2 * square
                B[rows] += U @ (((1.0 + variance) ** -0.5 - 1.0)[:, None] * along)
                level += float(np.log1p(variance).sum())
            return self._of(B, level)

        return unlikely

    def _of(self, B: Array, level: float) -> tuple[float, float]:
        """At its likeliest noise, of whitened `A` and the logarithm of what whitened it."""
        freedom = max(len(B) - B.shape[1] + 1, 1)
        own = np.abs(np.diag(np.linalg.qr(B, mode="r")))
        left = float(own[-1] ** 2)
        level += 2.0 * float(np.log(np.maximum(own[:-1], 1e-300)).sum())
        noise = max(left / freedom, 1.0 if self.stated else 1e-300)
        return float(left / noise + freedom * np.log(noise) + level), float(np.sqrt(noise))
