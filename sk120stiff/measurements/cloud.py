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
FEWEST = 3  # positions that a frame can be registered from


@dataclass(frozen=True, eq=False)
class Cloud:
    """Positions (N, 3) [m], joint values (N, n), stated markers (N, 3), their names (N,), which of
    them have a place of their own (N,), and which station they were read from (N,).
    """

    robot: Robot
    a: Array
    x: Array
    point: Array
    marker: NDArray[np.str_]
    group: Index
    station: Index

    def placed(self, *, fit_marker: bool, until: float = 0.0) -> tuple[Registration, Mask]:
        """The best placing, and the rows that it rests on (N,); `until`: see `register`."""
        screws = self.robot.screws(self.a)
        flange, rotation = screws.frame_position, screws.rotation
        kept = np.ones(len(self.x), dtype=bool)
        for _ in range(ROUNDS):
            found = register(
                self.x[kept], flange[kept], rotation[kept], self.point[kept],
                fit_marker=fit_marker, group=self.group[kept], station=self.station[kept],
                until=until,
            )  # fmt: skip
            if found is None:
                raise InputError("fewer than three positions", remedy="Measure more poses.")
            left = self._off(found, flange, rotation)
            best = found
            again = left <= max(FAR * float(np.median(left)), LEAST)
            again |= self._of_few(again)
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
        return np.asarray(np.linalg.norm(self.x - found.seen(at, self.station), axis=1))

    def _of_few(self, rows: Mask) -> Mask:
        """(N,) rows of stations of which fewer than three of these are left: none can be spared."""
        left = np.bincount(self.station[rows], minlength=int(self.station.max()) + 1)
        return np.asarray((left < FEWEST)[self.station])

    def some(self, most: int = LOOKED_AT) -> Cloud:
        """A part of the rows, spread over all; of stations that keep too few of them, none."""
        pick = np.unique(np.linspace(0, len(self.x) - 1, most).astype(int))
        enough = np.bincount(self.station[pick], minlength=int(self.station.max()) + 1) >= FEWEST
        pick = pick[enough[self.station[pick]]] if enough.any() else np.arange(len(self.x))
        station = np.unique(self.station[pick], return_inverse=True)[1]
        return replace(
            self, a=self.a[pick], x=self.x[pick], point=self.point[pick], marker=self.marker[pick],
            group=self.group[pick], station=station,
        )  # fmt: skip
