"""Pure error: what repeated readings say of the noise, whatever the model of the robot."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.whitening import Whitener


def pure_error(
    measurements: Measurements, zero: Literal["shared", "separate"] | None = None
) -> tuple[float, int] | None:
    """Standard uncertainty of one reading per axis (m) from repeats, and its degrees of freedom.

    Repeats are rows in use with the same joint values, the same wrench and the same branch. The
    mean of each such cell is free; what is left is weighed by the covariance of the zero readings
    (generalised least squares), so that rows with a common zero reading and rows with zero readings
    of their own give the same σ.

    Parameters
    ----------
    measurements
        Readings with displacements.
    zero
        How zero readings are shared; None takes the data's word, and "unknown" as shared.

    Returns
    -------
    (sigma, dof), or None where nothing was repeated.
    """
    usable = measurements.masked()
    if usable.displacement is None:
        return None
    _, place = np.unique(np.round(usable.joints, 9), axis=0, return_inverse=True)
    cell = _cells(usable, place)
    repeated = np.bincount(cell)[cell] > 1
    separate = (zero or usable.zero) == "separate"
    squares, freedom = 0.0, 0
    for at in np.unique(place[repeated]):
        rows = np.flatnonzero(repeated & (place == at))
        zero_variance = np.repeat(1.0 / usable.zero_count[rows, None], 3, axis=1)
        own = np.ones_like(zero_variance)
        whitener = (
            Whitener(own + zero_variance, np.zeros_like(own), np.arange(len(rows)))
            if separate
            else Whitener(own, zero_variance, usable.zero_group[rows])
        )
        labels, member = np.unique(cell[rows], return_inverse=True)
        means = (member[:, None] == np.arange(len(labels))).astype(np.float64)
        design = np.repeat(means[:, None, :], 3, axis=1)  # (rows, 3, cells)
        y = whitener.apply(usable.displacement[rows]).reshape(-1, 3)
        x = whitener.apply(design).reshape(len(rows), 3, -1)[:, 0]  # the axes do not differ
        q, _ = np.linalg.qr(x)
        squares += float(np.sum((y - q @ (q.T @ y)) ** 2))
        freedom += 3 * (len(rows) - len(labels))
    if freedom == 0:
        return None
    return float(np.sqrt(squares / freedom)), freedom


def _cells(m: Measurements, place: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N,) equal numbers for rows with the same joint values, wrench and branch."""
    branches = ("", "load", "unload")
    branch = np.zeros(m.n_readings)
    if m.branch is not None:
        branch = np.array([branches.index(b) for b in m.branch], dtype=np.float64)
    keys = np.column_stack([place, np.round(m.wrench, 9), branch])
    cells: NDArray[np.int64] = np.unique(keys, axis=0, return_inverse=True)[1]
    return cells
