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

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.noise.model_form import rows_of_poses
from sk120stiff.measurements.noise.whitening import Whitens
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
    """V^(-1/2) with the errors of forces: the noise's whitener, then a Cholesky factor per pose.

    Args:
        noise: Whitener of the instrument's noise; readings of two poses have nothing in common.
        share: Standard uncertainty of every component of a force over the force.
        measurements: The N readings, with what forces move.
        weights: (N,) share of its information that each reading keeps; None: all of it.
    """

    def __init__(
        self,
        noise: Whitens,
        share: float,
        measurements: Measurements,
        weights: Array | None = None,
    ) -> None:
        self._noise = noise
        self.n_readings, self.reading = noise.n_readings, noise.reading
        moved = share * by_force_of(measurements)
        if weights is not None:
            moved = moved / np.sqrt(weights)[:, None, None]
        white = noise.apply(_apart(moved, measurements))
        self._alike: list[tuple[Index, Array]] = []
        """Of poses with as many rows: these (m, r), and the inverses (m, r, r) of their factors."""
        rows = rows_of_poses(measurements)
        self.logdet = noise.logdet
        """Natural logarithm of det V, over all numbers that were read; V in m²."""
        for places in rows_by_label(np.array([len(each) for each in rows])):
            same = np.stack([rows[k] for k in places])
            Z = white[same]
            factor = np.linalg.cholesky(np.eye(same.shape[1]) + Z @ np.swapaxes(Z, 1, 2))
            self.logdet += 2.0 * float(np.log(np.diagonal(factor, axis1=1, axis2=2)).sum())
            self._alike.append((same, np.linalg.inv(factor)))

    def apply(self, x: ArrayLike) -> Array:
        """As `Whitener.apply`."""
        white = self._noise.apply(x)
        flat = white.reshape(len(white), -1)
        for rows, inverse in self._alike:
            flat[rows] = inverse @ flat[rows]
        return flat.reshape(white.shape)


def _apart(moved: Array, measurements: Measurements) -> Array:
    """(N, 3, 3k) columns (N, 3, 3) with a place of their own for each of the k rows of a pose."""
    count = len(moved)
    place = np.zeros(count, dtype=np.intp)
    for rows in rows_by_label(measurements.pose_index):
        place[rows] = np.arange(len(rows))
    out = np.zeros((count, 3, int(place.max()) + 1, 3))
    out[np.arange(count), :, place] = moved
    return out.reshape(count, 3, -1)
