"""Noise as a laser tracker makes it, and what the data's description says about it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .rotations import Array
from .rows import Rows


@dataclass(frozen=True)
class Noise:
    """How readings scatter. All of it is drawn per *reading*; a displacement is two readings."""

    sigma: float  # [m] standard uncertainty of one reading per axis
    shared_zero: bool = True  # all rows of a pose subtract the same zero reading
    growth: float = 0.0  # added standard uncertainty per displacement
    angular: float = 0.0  # [rad] across the line of sight, so it grows with distance
    along: float = 1.0  # factor on sigma along the line of sight
    tracker: tuple[float, float, float] = (3.0, -2.0, 0.5)  # [m]
    outliers: float = 0.0  # share of readings
    outlier_size: float = 0.0  # [m]
    wander: float = 0.0  # [m] per root of reading, random walk of the tracker
    warm_up: float = 0.0  # [m] whole way that the tracker drifts while it warms up
    warm_time: float = 20.0  # readings after which a third of that way is left
    declared: dict[str, object] = field(default_factory=dict)  # the YAML's words, if not the truth

    def _own(self, displacement: Array, position: Array) -> tuple[Array, Array]:
        """Covariance (N, 3, 3) of a loaded and of a zero reading."""
        sight = position - np.array(self.tracker)
        distance = np.linalg.norm(sight, axis=1)
        sight = sight / distance[:, None]
        ray = sight[:, :, None] * sight[:, None, :]
        across = self.sigma**2 + (self.angular * distance) ** 2
        zero = across[:, None, None] * (np.eye(3) - ray) + (self.sigma * self.along) ** 2 * ray
        size = np.linalg.norm(displacement, axis=1)
        grown = (self.growth * size) ** 2
        return zero + grown[:, None, None] * np.eye(3), zero

    def covariance(self, rows: Rows, displacement: Array, position: Array) -> Array:
        """Covariance (3N, 3N) of the displacements, outliers, wander and warm-up left out."""
        loaded, zero = self._own(displacement, position)
        count = rows.count
        out = np.zeros((count, 3, count, 3))
        index = np.arange(count)
        out[index, :, index, :] = loaded + zero
        if self.shared_zero:
            same = rows.zero_order[:, None] == rows.zero_order[None, :]
            for i, j in zip(*np.nonzero(same), strict=True):
                if i != j:
                    out[i, :, j, :] = zero[i]
        return out.reshape(3 * count, 3 * count)

    def whitener(self, rows: Rows, displacement: Array, position: Array) -> Array:
        """W (3N, 3N) with W cov W' = 1."""
        lower = np.linalg.cholesky(self.covariance(rows, displacement, position))
        return np.linalg.inv(lower)

    def sample(
        self, rows: Rows, displacement: Array, position: Array, rng: np.random.Generator
    ) -> tuple[Array, Array]:
        """Errors (N, 3) of the loaded and of the zero reading of every row."""
        loaded, zero = self._own(displacement, position)
        first = np.linalg.cholesky(zero) @ rng.normal(size=(rows.count, 3, 1))
        own = np.linalg.cholesky(loaded) @ rng.normal(size=(rows.count, 3, 1))
        error, zero_error = own[..., 0], first[..., 0]
        _, owner = np.unique(rows.zero_order, return_index=True)
        if self.shared_zero:
            source = {rows.zero_order[i]: i for i in owner}
            zero_error = zero_error[[source[z] for z in rows.zero_order]]
        hit = rng.random(rows.count) < self.outliers
        direction = rng.normal(size=(rows.count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        size = self.outlier_size * rng.uniform(0.5, 1.5, rows.count)
        error = error + (hit * size)[:, None] * direction
        if self.wander > 0.0:
            steps = int(max(rows.order.max(), rows.zero_order.max())) + 1
            walk = np.cumsum(self.wander * rng.normal(size=(steps, 3)), axis=0)
            error = error + walk[rows.order.astype(int)]
            zero_error = zero_error + walk[rows.zero_order.astype(int)]
        if self.warm_up > 0.0:
            way = rng.normal(size=3)
            way *= self.warm_up / np.linalg.norm(way)
            error = error - np.exp(-rows.order / self.warm_time)[:, None] * way
            zero_error = zero_error - np.exp(-rows.zero_order / self.warm_time)[:, None] * way
        return error, zero_error
