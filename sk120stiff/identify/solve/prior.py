"""What is known of parameters beside the readings, in directions in which it counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from sk120stiff.arrays import Array, Mask
from sk120stiff.identify.solve.polish import FAINTEST, seen_directions

NARROWER = 1.0  # times as narrow as what is plausible, from where on it is worth something


@dataclass(frozen=True, eq=False)
class Prior:
    """Directions of the parameters of which something is known beforehand, and counts.

    Attributes:
        ways: (P, b) where a unit step along each leads, parameters over `span`.
        steps: (b, P) how far parameters over `span` are along each.
        errors: (P, b) orthonormal: where a step leads, parameters over `usual`.
        sizes: (b,) how far a unit step leads there.
        span: (P,) sizes beyond which the parameters are implausible.
        usual: (P,) standard uncertainties beforehand; infinite where nothing is known.
        unit: The readings' noise over the noise assumed; infinite where nothing tells it.
    """

    ways: Array
    steps: Array
    errors: Array
    sizes: Array
    span: Array
    usual: Array
    unit: float

    @classmethod
    def of(
        cls, jacobian: Array, held: Mask, span: Array, usual: Array, unit: float, counts: float
    ) -> Prior:
        """Beside a derivative (R, P) over the noise assumed, `held` parameters at rest.

        What readings tell and what was known are sums of squares; the directions make either
        diagonal. It counts where it is `counts` times what readings tell, or more, as standard
        errors. Of a parameter that does not show at all nothing was read, and nothing is said.
        """
        shows = np.linalg.norm(jacobian, axis=0) * span > FAINTEST
        moving = np.flatnonzero(~held & shows)
        P = len(span)
        if not np.isfinite(usual[moving]).any():
            empty = np.zeros((P, 0))
            return cls(empty, empty.T, empty, np.zeros(0), span, usual, unit)
        _, singular, V, null = seen_directions(jacobian[:, moving], span[moving])
        basis = np.hstack([V, null])
        read = np.concatenate([singular / unit, np.zeros(null.shape[1])])
        read = np.maximum(read, FAINTEST) ** 2
        known = (span / usual)[moving, None] * basis
        ratio, W = eigh(known.T @ known, np.diag(read))  # WᵀRW = 1
        sizes = np.sqrt(np.maximum(ratio, 0.0))
        own = W * np.sqrt(read)[:, None]  # orthonormal
        length = np.linalg.norm(W, axis=0)
        told = (sizes > counts) & (sizes > NARROWER * length)
        W, sizes, own, length = W[:, told], sizes[told], own[:, told], length[told]
        ways, errors = (np.zeros((P, len(sizes))) for _ in range(2))
        steps = np.zeros((len(sizes), P))
        ways[moving] = basis @ W / length
        steps[:, moving] = (length * own * np.sqrt(read)[:, None]).T @ basis.T
        errors[moving] = known @ W / sizes
        return cls(ways, steps, errors, sizes / length, span, usual, unit)

    def rows(self) -> Array:
        """(b, P) rows of a derivative over the noise assumed that say as much."""
        known = self.unit if np.isfinite(self.unit) else 0.0
        return np.asarray(known * self.sizes[:, None] * self.steps / self.span)

    def step(self, x: Array) -> Array:
        """(P,) what leads from parameters `x` to where they were likeliest beforehand.

        To first order the predictions change by less than they are known.
        """
        return np.asarray(-self.span * (self.ways @ (self.slope @ x / self.sizes)))

    @property
    def slope(self) -> Array:
        """(b, P) times parameters: by how many standard deviations they are off along each."""
        return np.asarray(self.errors.T / self.usual)

    def beside(self, change: Array) -> Array:
        """(P,) a change of the parameters without what was known of it."""
        over = change / self.span
        return np.asarray(self.span * (over - self.ways @ (self.steps @ over)))
