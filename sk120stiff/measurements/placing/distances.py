"""Where the instrument stands, told by distances alone: a ball bar, a laser to fixed points.

Each fixed point is found in base axes by trilateration: |p - b|² = l² is linear in b and |b|². Then
all of them and the marker are fitted together; three or more points that are not in line tell the
instrument's axes. About one point, or the line through two, distances say nothing of a turn, and
nothing that is predicted depends on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.placing.laying import kabsch
from sk120stiff.robot import Robot

EACH = 6  # distances to a fixed point from which its place is found, with some to spare
FITS = 0.03  # of the spread of the marker: what no calibrated arm leaves
BETTER = 0.2  # of what is left, by which a slip of the pen must explain it
STEPS = 50  # of one fit: from trilateration it takes a few
FAR, LEAST, ROUNDS, WILD = 8.0, 2e-4, 8, 0.2  # rows that are wild, as for positions


@dataclass(frozen=True, eq=False)
class Ranged:
    """Distances placed.

    Attributes:
        shift, turn: (3,) [m] and (3, 3) base axes as the instrument sees them.
        marker: (3,) how far it is off its stated place, tool axes [m].
        fixed: (F, 3) fixed points as stated [m].
        rms, left: What is left, wild rows set aside, and (K,) at every distance [m].
        kept: (K,) rows that are not wild.
        off: Rms that is left if base axes are those of the fixed points [m].
        spread: Of the marker [m].
    """

    shift: Array
    turn: Array
    marker: Array
    fixed: Array
    rms: float
    left: Array
    kept: Mask
    off: float
    spread: float

    @property
    def told(self) -> bool:
        """Do the fixed points tell all six of the frame: three that are not in line?"""
        away = self.fixed - self.fixed.mean(axis=0)
        return bool(np.linalg.matrix_rank(away, tol=0.01) >= 2)


@dataclass(frozen=True, eq=False)
class _Bar:
    """K distances (K,) [m] to fixed points (F, 3), which one (K,), flange (K, 3) and axes (K, 3, 3)
    of the tool, stated marker (K, 3).
    """

    length: Array
    fixed: Array
    which: Index
    flange: Array
    axes: Array
    point: Array
    fit_marker: bool

    def solved(self, rounds: int = ROUNDS) -> Ranged:
        """Fixed points in base axes, marker and instrument, without rows far off all others."""
        kept = np.ones(len(self.length), dtype=bool)
        for _ in range(rounds):
            b, marker = self._trilaterated(kept)
            turn, shift = kabsch(b, self.fixed)
            seen = (self.fixed - shift) @ turn  # where the stated points are, base axes
            left = self._left(seen, marker)
            again = np.abs(left) <= max(FAR * float(np.median(np.abs(left))), LEAST)
            size = rms(left[kept])
            if (again == kept).all() or again.mean() < 1.0 - WILD:
                break
            kept = again
        off = rms(self._left(self.fixed, marker)[kept])
        spread = float(self.flange.std(axis=0).max())
        return Ranged(shift, turn, marker, self.fixed, size, left, kept, off, spread)

    def _trilaterated(self, kept: Mask) -> tuple[Array, Array]:
        at = self.flange + np.einsum("kij,kj->ki", self.axes, self.point)
        start = np.zeros((len(self.fixed), 3))
        for f in range(len(start)):
            own = kept & (self.which == f)
            A = np.column_stack([-2.0 * at[own], np.ones(own.sum())])
            square = self.length[own] ** 2 - (at[own] ** 2).sum(axis=1)
            start[f] = np.linalg.lstsq(A, square, rcond=None)[0][:3]
        size = start.size

        def gap(x: Array) -> Array:
            return self._left(x[:size].reshape(-1, 3), x[size:] if self.fit_marker else None)[kept]

        x = np.concatenate([start.ravel(), np.zeros(3 if self.fit_marker else 0)])
        x = least_squares(gap, x, x_scale="jac", loss="soft_l1", f_scale=1e-3, max_nfev=STEPS).x
        return x[:size].reshape(-1, 3), x[size:] if self.fit_marker else np.zeros(3)

    def _left(self, b: Array, marker: Array | None) -> Array:
        place = self.point if marker is None else self.point + marker
        at = self.flange + np.einsum("kij,kj->ki", self.axes, place)
        return np.asarray(self.length - np.linalg.norm(at - b[self.which], axis=1))


def place_distances(robot: Robot, readings: Measurements) -> Ranged | None:
    """Lay the robot onto distances; None where there are too few to tell anything.

    Raises:
        InputError: No such arm and fixed points gave these distances.
    """
    said = readings.absolute
    if said is None or said.channels.distance is None or said.channels.anchor is None:
        return None
    rows = np.flatnonzero(np.isfinite(said.channels.distance) & readings.use)
    fixed, which = np.unique(np.round(said.channels.anchor[rows], 9), axis=0, return_inverse=True)
    which = which.ravel()
    if not len(rows) or np.bincount(which).min() < EACH:
        return None
    a = readings.joints[rows]
    screws = robot.screws(a)
    bar = _Bar(
        said.channels.distance[rows], fixed, which, screws.frame_position, screws.rotation,
        said.point[rows], said.fit_point,
    )  # fmt: skip
    found = bar.solved()
    if found.rms > FITS * found.spread:
        where = readings.place
        told = (
            f"these are not distances of this robot's marker from fixed points: "
            f"{1e3 * found.rms:.4g} mm are left after the best placing of the points"
        )
        tried = min(_slips(bar, robot, a), key=lambda item: item[0])
        if tried[0] < BETTER * found.rms:
            raise InputError(f"{told}. {tried[1]}", where=where, remedy=tried[2])
        worst = rows[np.argsort(-np.abs(found.left))[:3]]
        raise InputError(
            told,
            where=f"{where}, worst in lines {', '.join(str(readings.line[k]) for k in worst)}",
            remedy="Check that rows of joints and distances belong together, the places ax, ay, az "
            "of the fixed points, and units and signs of the joint columns.",
        )
    return found


def _slips(bar: _Bar, robot: Robot, a: Array) -> Iterator[tuple[float, str, str]]:
    """What is left with one slip mended [m], what it is, and the remedy."""
    for factor, was, unit in (
        (np.pi / 180.0, "degrees, not radians", "deg"),
        (180.0 / np.pi, "radians, not degrees", "rad"),
    ):
        screws = robot.screws(np.where(np.array(robot.prismatic), a, a * factor))
        moved = replace(bar, flange=screws.frame_position, axes=screws.rotation)
        said = f"The joint angles look like {was}."
        yield moved.solved(1).rms, said, f"Write [{unit}] in their headers."
    for factor, unit in ((1e-3, "mm"), (1e3, "m")):
        much = "1000 times too " + ("small" if factor > 1 else "large")
        rms = replace(bar, length=bar.length * factor).solved(1).rms
        yield rms / factor, f"The distances look {much}.", f"Check the unit of l: {unit}?"
        rms = replace(bar, fixed=bar.fixed * factor).solved(1).rms
        said = f"The places of the fixed points look {much}."
        yield rms, said, f"Check the unit of ax, ay, az: {unit}?"
