"""What errors of forces do to readings: a gauge held by hand, a cable that hangs askew.

A force f that is off by δf moves the point by C δf more than it is written beside, with C the
compliance of the arm at that pose. Each component of δf has a standard uncertainty of a share of
|f|, every reading its own, so with B = |f| C

    V = V_instrument + share² B Bᵀ

(GUM, JCGM 100:2008, 5.1: what an input quantity contributes). An arm that is soft sideways shows a
pull along a stiff direction that was a degree askew; a share of the displacement would not tell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.noise.whitening import Shortening, as_columns
from sk120stiff.measurements.poses import rows_by_label


def by_force_of(measurements: Measurements) -> Array:
    """(N, 3, 3) what the components of the forces move, see `Measurements`.

    Raises:
        InputError: Nothing tells it: that takes a model of the arm.
    """
    if measurements.by_force is None:
        raise InputError(
            "what an error of a force moves is known only with a model of the arm",
            where=measurements.place,
            remedy="Fit a model to these readings: sk.fit(model, readings).",
        )
    return measurements.by_force


class ForceWhitener:
    """V^(-1/2) with the errors of forces: a Cholesky factor per reading, then the shared zero.

    With S of each reading its own covariance (3, 3) and Z Zᵀ that of the error which rows of a
    group share, V = S + Z Zᵀ: what S whitens is shortened along three directions of each group.

    Args:
        own: (N, 3) variance of each row's own error, m², positive; infinite where not read.
        shared: (N, 3) variance of the error that rows of a group share, m².
        group: (N,) number of the group of each row.
        axes: (N, 3, 3) unit vectors, as rows, along which these variances are; None: the axes of
            the readings. Rows that lack an axis have none of their own.
        moved: (N, 3, 3) standard uncertainty that the components of the force bring, m.
    """

    def __init__(
        self, own: Array, shared: Array, group: Integers, axes: Array | None, moved: Array
    ) -> None:
        self.n_readings = len(own)
        read = np.isfinite(own)
        self._read = read
        self.reading: Index = np.nonzero(read)[0]
        """(R,) reading of each number that `apply` whitens."""
        turn = np.eye(3) if axes is None else axes
        both = read[:, :, None] & read[:, None, :]
        diagonal = np.where(read, own, 1.0)[:, :, None] * np.eye(3)
        inner = np.swapaxes(turn, -1, -2) @ diagonal @ turn
        inner += np.where(both, moved @ np.swapaxes(moved, 1, 2), 0.0)
        factor = np.linalg.cholesky(inner)
        self._inverse = np.linalg.inv(factor)
        errors = np.swapaxes(turn, -1, -2) @ (np.sqrt(shared)[:, :, None] * np.eye(3))
        white = self._whitened(errors)
        pivots = np.diagonal(factor, axis1=1, axis2=2)[read]
        logdet = 2.0 * float(np.log(pivots).sum())
        groups = rows_by_label(np.asarray(group)[self.reading])
        self._shared = Shortening(groups, [white[own] for own in groups])
        self.logdet = logdet + self._shared.logdet
        """Natural logarithm of det V, over all numbers that were read; V in m²."""

    def apply(self, x: ArrayLike) -> Array:
        """As `Whitener.apply`."""
        values = as_columns(x, self.n_readings)
        white = self._shared.apply(self._whitened(values.reshape(self.n_readings, 3, -1)))
        return white.reshape(len(white), *values.shape[2:])

    def _whitened(self, columns: Array) -> Array:
        """(R, k) of (N, 3, k) by the own errors alone."""
        known = np.where(self._read[:, :, None], columns, 0.0)
        return np.asarray((self._inverse @ known)[self._read])
