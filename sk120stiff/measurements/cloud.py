"""Positions and the joints they were read at, and the best placing of the rigid robot on them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.registration import Registration, register
from sk120stiff.robot import Robot

ROUNDS = 8  # of registering and leaving out what lies far off
FAR = 8.0  # times the median distance: a wild row
WILD = 0.2  # share of rows beyond which they are no outliers
LEAST = 2e-4  # m; no row is wild for less
LOOKED_AT = 150  # rows that slips are looked for in


@dataclass(frozen=True, eq=False)
class Cloud:
    """Positions (N, 3) [m], joint values (N, n), stated markers (N, 3), their names (N,), and which
    of them have a place of their own (N,).
    """

    robot: Robot
    a: Array
    x: Array
    point: Array
    marker: NDArray[np.str_]
    group: Index

    def placed(self, *, fit_marker: bool, until: float = 0.0) -> tuple[Registration, Mask]:
        """The best placing, and the rows that it rests on (N,); `until`: see `register`."""
        screws = self.robot.screws(self.a)
        flange, rotation = screws.frame_position, screws.rotation
        kept = np.ones(len(self.x), dtype=bool)
        for _ in range(ROUNDS):
            found = register(
                self.x[kept], flange[kept], rotation[kept], self.point[kept],
                fit_marker=fit_marker, group=self.group[kept], until=until,
            )  # fmt: skip
            if found is None:
                raise InputError("fewer than three positions", remedy="Measure more poses.")
            left = self._off(found, flange, rotation)
            best = found
            again = left <= max(FAR * float(np.median(left)), LEAST)
            if (again == kept).all() or again.mean() < 1.0 - WILD:
                break
            kept = again
        return best, kept

    def left(self, found: Registration) -> Array:
        """(N,) distance of every position from where the placed robot has the marker [m]."""
        screws = self.robot.screws(self.a)
        return self._off(found, screws.frame_position, screws.rotation)

    def _off(self, found: Registration, flange: Array, rotation: Array) -> Array:
        places = self.point + found.marker + found.apart[self.group]
        at = flange + np.einsum("nij,nj->ni", rotation, places)
        return np.asarray(np.linalg.norm(self.x - at @ found.turn.T - found.shift, axis=1))

    def some(self, most: int = LOOKED_AT) -> Cloud:
        """A part of the rows, spread over all."""
        pick = np.unique(np.linspace(0, len(self.x) - 1, most).astype(int))
        return replace(
            self, a=self.a[pick], x=self.x[pick], point=self.point[pick], marker=self.marker[pick],
            group=self.group[pick],
        )  # fmt: skip
