"""Positions and the joints they were read at, and the best placing of the rigid robot on them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array, Index, Mask, rms
from sk120stiff.errors import InputError
from sk120stiff.measurements.placing.laying import Clouds, Laid, lay
from sk120stiff.measurements.placing.registration import Registration, registration_of
from sk120stiff.robot import Robot

ROUNDS = 8  # of registering and leaving out what lies far off
FAR = 8.0  # times the median distance: a wild row
WILD = 0.2  # share of rows beyond which they are no outliers
LEAST = 2e-4  # m; no row is wild for less
LOOKED_AT = 150  # rows that slips are looked for in
FEWEST = 3  # positions that a frame can be registered from
AT_ONCE = 256  # ways that are placed together: more take room, and no less time


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

    @property
    def spread(self) -> float:
        """Distance of the positions from their middle, rms, of each station by itself [m]."""
        seen = [self.x[self.station == own] for own in np.unique(self.station)]
        return rms(np.concatenate([np.linalg.norm(x - x.mean(axis=0), axis=1) for x in seen]))

    def placed(self, *, fit_marker: bool, until: float = 0.0) -> tuple[Registration, Mask]:
        """The best placing, and the rows that it rests on (N,); `until`: see `lay`.

        Raises:
            InputError: A station has fewer than three positions.
        """
        if len(self.x) < FEWEST or np.bincount(self.station).min() < FEWEST:
            raise InputError("fewer than three positions", remedy="Measure more poses.")
        clouds = self._clouds(self.a[None])
        found, kept = self._laid(clouds, fit_marker=fit_marker, until=until)
        return registration_of(clouds, found, kept[0]), kept[0]

    def left_with(self, joints: Array, *, until: float) -> Array:
        """(B,) what is left after the best placing with joint values (B, N, n) instead [m]."""
        some = np.array_split(joints, -(-len(joints) // AT_ONCE))
        return np.concatenate(
            [self._laid(self._clouds(a), fit_marker=True, until=until)[0].rms for a in some]
        )

    def _clouds(self, joints: Array) -> Clouds:
        screws = self.robot.screws(joints)
        flange, rotation = screws.frame_position, screws.rotation
        return Clouds(self.x, flange, rotation, self.point, self.group, self.station)

    def _laid(self, clouds: Clouds, *, fit_marker: bool, until: float) -> tuple[Laid, Mask]:
        """The best placings, and the rows (B, N) that they rest on: what lies far off is none."""
        kept = np.ones(clouds.flange.shape[:2], dtype=bool)
        found = lay(clouds, kept, fit_marker=fit_marker, until=until)
        open_ones = np.arange(len(kept))
        for _ in range(ROUNDS - 1):
            left = found.distance[open_ones]
            again = left <= np.maximum(FAR * np.median(left, axis=1, keepdims=True), LEAST)
            again |= self._of_few(again)
            goes_on = (again != kept[open_ones]).any(axis=1) & (again.mean(axis=1) >= 1.0 - WILD)
            open_ones = open_ones[goes_on]
            if not len(open_ones):
                break
            kept[open_ones] = again[goes_on]
            some = clouds.picked(open_ones)
            found = found.with_some(
                open_ones, lay(some, kept[open_ones], fit_marker=fit_marker, until=until)
            )
        return found, kept

    def left(self, found: Registration) -> Array:
        """(N,) distance of every position from where the placed robot has the marker [m]."""
        screws = self.robot.screws(self.a)
        places = self.point + found.marker + found.apart[self.group]
        at = screws.frame_position + np.einsum("nij,nj->ni", screws.rotation, places)
        return np.asarray(np.linalg.norm(self.x - found.seen(at, self.station), axis=1))

    def _of_few(self, rows: Mask) -> Mask:
        """(B, N) rows of stations of which fewer than three of these (B, N) are left: none can be
        spared.
        """
        here = np.eye(int(self.station.max()) + 1)[self.station]
        return np.asarray((rows @ here < FEWEST)[:, self.station])

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
