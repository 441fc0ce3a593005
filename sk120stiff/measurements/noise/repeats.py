"""Pure error: what repeated readings say of the noise, whatever the model of the robot.

Repeats are rows with the same joint values, the same wrench and the same branch. A load that was
reached once from below and once from above was not repeated: what differs there may be the arm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Integers, Mask
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import read_apart
from sk120stiff.measurements.noise.whitening import Whitener
from sk120stiff.measurements.poses import rows_by_label
from sk120stiff.measurements.table.branches import branches_of

Zero = Literal["shared", "separate"]

STRONG = 10.0  # twice the log-likelihood by which noise that grows must win
ENOUGH = 10  # degrees of freedom; fewer leave σ open by a quarter or more
ALIKE = 4.0  # times the usual distance of repeats, within which one bears out the other
_REACH = (-7.0, 7.0)  # natural logarithm of growth·|d|/σ at the usual displacement


@dataclass(frozen=True)
class Repeated:
    """Noise as repeats show it.

    Attributes:
        sigma: Standard uncertainty of one reading per axis [m].
        growth: Standard uncertainty per metre of displacement, in squares beside it; 0 unless the
            repeats ask for it strongly.
        freedom: Degrees of freedom behind them.
    """

    sigma: float
    growth: float
    freedom: int


def repeated(
    measurements: Measurements, zero: Zero | None = None, *, grows: bool = True
) -> Repeated | None:
    """Noise from repeats; None where nothing was repeated.

    The mean of each cell of repeats is free; what is left is weighed by the covariance of the zero
    readings (generalised least squares), so that rows with a common zero reading and rows with zero
    readings of their own give the same σ.

    Args:
        measurements: Readings with displacements.
        zero: How zero readings are shared; None takes the data's word, and "unknown" as shared.
        grows: Look for a part that grows with the displacement too.
    """
    usable = measurements.masked()
    if usable.displacement is None:
        return None
    separate = (zero or usable.zero) == "separate"
    cell = cells_of(usable)
    rows = np.flatnonzero(np.bincount(cell)[cell] > 1)
    if not len(rows):
        return None
    usable, cell = usable.select(rows), cell[rows]
    plain, freedom, level = _left(usable, cell, 0.0, separate)
    if not freedom:
        return None  # no axis was read twice
    flat = Repeated(float(np.sqrt(plain / freedom)), 0.0, freedom)
    usual = float(np.median(np.linalg.norm(usable.moved, axis=1)))
    if not grows or freedom < ENOUGH or usual == 0.0 or plain == 0.0:
        return flat

    def unlikely(logarithm: float) -> float:
        squares, _, logdet = _left(usable, cell, float(np.exp(logarithm)) / usual, separate)
        return freedom * float(np.log(squares)) + logdet

    best = minimize_scalar(unlikely, bounds=_REACH, method="bounded", options={"xatol": 0.02})
    if freedom * float(np.log(plain)) + level - best.fun < STRONG:
        return flat
    ratio = float(np.exp(best.x)) / usual
    sigma = float(np.sqrt(_left(usable, cell, ratio, separate)[0] / freedom))
    return Repeated(sigma, min(ratio * sigma, 0.99), freedom)


def borne_out(measurements: Measurements) -> Mask:
    """(N,) readings that were taken again and came out alike, whatever a model makes of them.

    Each is held against the one before and the one after it of the same pose and load. Alike is
    what lies no farther apart, along every axis, than `ALIKE` times what repeats usually do; where
    less than `ENOUGH` distances tell that, nothing is borne out.

    Args:
        measurements: Readings with displacements.
    """
    out = np.zeros(measurements.n_readings, dtype=bool)
    cell = cells_of(measurements)
    order = np.argsort(cell, kind="stable")
    again = np.diff(cell[order]) == 0
    first, second = order[:-1][again], order[1:][again]
    apart = np.abs(measurements.moved[first] - measurements.moved[second])
    apart[~(measurements.read[first] & measurements.read[second])] = np.nan
    told = np.isfinite(apart)
    if told.sum() < ENOUGH:
        return out
    usual = 1.4826 * float(np.median(apart[told]))
    near = told.any(axis=1) & (~told | (apart <= ALIKE * usual)).all(axis=1)
    out[first[near]] = out[second[near]] = True
    return out


def cells_of(m: Measurements) -> Integers:
    """(N,) equal numbers for rows with the same joint values, wrench and branch, and the same axes.

    Where no branch is written, loads that rise and then fall tell it.
    """
    _, place = np.unique(np.round(m.joints, 9), axis=0, return_inverse=True)
    branches = ("", "load", "unload")
    branch = np.zeros(m.n_readings)
    clock = next((c for c in (m.order, m.time) if c is not None), np.arange(float(len(branch))))
    words = branches_of(m.branch, m.pose_index, m.wrench, clock)[0]
    if words is not None:
        branch = np.array([branches.index(b) for b in words], dtype=np.float64)
    keys = np.column_stack([place, np.round(m.wrench, 9), branch])
    cells: Integers = np.unique(keys, axis=0, return_inverse=True)[1]
    return read_apart(m.directions, cells)


def _left(
    m: Measurements, cell: Integers, ratio: float, separate: bool
) -> tuple[float, int, float]:
    """Weighted squares that the means of the cells leave, their freedom, and what V costs.

    V is in units of σ², its part that grows is (ratio·|d|)². The cost is ln det V + ln det XᵀV⁻¹X,
    of the restricted likelihood.
    """
    size = np.linalg.norm(m.moved, axis=1)
    own = np.where(m.read, 1.0 + (ratio * size[:, None]) ** 2, np.inf)
    zero = np.repeat(1.0 / m.zero_count[:, None], 3, axis=1)
    whitener = (
        Whitener(own + zero, np.zeros_like(own), np.arange(len(own)))
        if separate
        else Whitener(own, zero, read_apart(m.directions, m.zero_group))
    )
    place, member = _places(m, cell)
    means = np.repeat((member[:, None] == np.arange(member.max() + 1))[:, None, :], 3, axis=1)
    y, x = np.zeros((len(own), 3)), np.zeros(means.shape)
    y[m.read], x[m.read] = whitener.apply(m.moved), whitener.apply(means.astype(np.float64))
    squares, freedom, price = 0.0, 0, whitener.logdet
    for rows in rows_by_label(place):
        for axes in _alike(m.read[rows]):
            seen = rows[m.read[rows, axes[0]]]
            q, r = np.linalg.qr(x[seen, axes[0]][:, np.unique(member[seen])])
            left = y[np.ix_(seen, axes)]
            squares += float(np.sum((left - q @ (q.T @ left)) ** 2))
            freedom += len(axes) * (len(seen) - q.shape[1])
            price += 2.0 * len(axes) * float(np.log(np.abs(np.diag(r))).sum())
    return squares, freedom, price


def _alike(read: Mask) -> list[list[int]]:
    """Axes of (n, 3) cells that were read in the same rows, together; none that was never read."""
    found: dict[bytes, list[int]] = {}
    for axis in np.flatnonzero(read.any(axis=0)):
        found.setdefault(read[:, axis].tobytes(), []).append(int(axis))
    return list(found.values())


def _places(m: Measurements, cell: Integers) -> tuple[Integers, Integers]:
    """(N,) number of the joint values of each row, and of its cell among those at its place."""
    place = np.unique(np.round(m.joints, 9), axis=0, return_inverse=True)[1]
    order = np.lexsort((cell, place))
    new = np.diff(cell[order], prepend=-1) != 0
    running = np.cumsum(new) - 1
    first = np.flatnonzero(np.diff(place[order], prepend=-1) != 0)
    counts = np.diff(np.append(first, len(order)))
    member = np.empty(len(order), dtype=np.int64)
    member[order] = running - np.repeat(running[first], counts)
    return place, member
