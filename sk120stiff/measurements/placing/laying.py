"""One cloud of positions laid onto the clouds of many robots at once, or of one by many columns."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot.rotations import crossed

MARKER_POSES = 5  # from here on the marker's place is fitted too
_STEPS = 100  # of Gauss and Newton
_STILL = 1e-10  # m; a marker that moves by less is found
_SPANNED = 1e-13  # squared length of what a column adds to others, beyond which it is rounding


@dataclass(frozen=True, eq=False)
class Clouds:
    """Positions and where B robots have the tool at each of them.

    Attributes:
        measured: (P, 3) positions of markers [m], in any axes.
        flange, rotation: (B, P, 3) and (B, P, 3, 3) of the tool frame, base axes [m].
        point: (3,) or (P, 3) where the marker is said to be in the tool frame [m].
        group, station: (P,) number of the marker that was read, and of the place of the instrument,
            from 0 on.
    """

    measured: Array
    flange: Array
    rotation: Array
    point: Array
    group: Index
    station: Index

    def picked(self, some: Index | Mask) -> Clouds:
        """Those of some of the robots."""
        flange, rotation = self.flange[some], self.rotation[some]
        return Clouds(self.measured, flange, rotation, self.point, self.group, self.station)

    @property
    def of_station(self) -> Array:
        """(P, S) 1 for the station of a row."""
        return np.eye(int(self.station.max()) + 1)[self.station]

    @property
    def of_marker(self) -> Array:
        """(P, G) 1 for the marker of a row."""
        return np.eye(int(self.group.max()) + 1)[self.group]

    def reached(self, marker: Array) -> Array:
        """(B, P, 3) where the robots have markers (B, G, 3) off their stated places [m]."""
        places = self.point + marker[:, self.group]
        return np.asarray(self.flange + (self.rotation @ places[..., None])[..., 0])

    def columns(self, turns: Array, marker: Array) -> Array:
        """(B, 3P, 6 S + 3 G) derivative by the turns and shifts of S stations and the G markers."""
        turn = turns[:, self.station]
        seen = (turn @ self.reached(marker)[..., None])[..., 0]
        shift = np.broadcast_to(np.eye(3), (*seen.shape, 3))
        frame = np.concatenate([-crossed(seen), shift], axis=-1)[:, :, :, None]
        own = (turn @ self.rotation)[:, :, :, None]
        shape = (len(seen), 3 * len(self.measured), -1)
        here, mine = self.of_station[:, None, :, None], self.of_marker[:, None, :, None]
        return np.concatenate([(frame * here).reshape(shape), (own * mine).reshape(shape)], axis=2)


@dataclass(frozen=True, eq=False)
class Laid:
    """Where the instrument stands for each of B robots.

    Attributes:
        turns, shifts: (B, S, 3, 3) and (B, S, 3) base axes as it sees them from its stations.
        marker: (B, G, 3) markers off their stated places, tool axes [m].
        fitted: (B,) were they fitted?
        distance: (B, P) what remains at each position [m].
        rms: (B,) what remains per pose of those that count [m].
    """

    turns: Array
    shifts: Array
    marker: Array
    fitted: Mask
    distance: Array
    rms: Array

    def with_some(self, some: Index, others: Laid) -> Laid:
        """With the placings of some of the robots in the place of theirs."""
        parts = {each.name: getattr(self, each.name).copy() for each in fields(self)}
        for name, part in parts.items():
            part[some] = getattr(others, name)
        return Laid(**parts)


def lay(clouds: Clouds, kept: Mask, *, fit_marker: bool = True, until: float = 0.0) -> Laid:
    """Fit x = R (p + Q m) + t: the tracker's frames R, t and the markers m of each robot.

    The turns are those of least squares (Kabsch, Acta Cryst. A32, 1976, p. 922) to begin with; then
    all unknowns are fitted together by Gauss and Newton.

    Args:
        clouds: What is laid onto what.
        kept: (B, P) positions that count.
        fit_marker: False leaves the markers where they are said to be.
        until: A marker is found where it moves by less than this share of what is left.
    """
    stations, markers = clouds.of_station.shape[1], clouds.of_marker.shape[1]
    count = kept.sum(axis=1)
    fitted = fit_marker & (count >= MARKER_POSES + markers - 1 + 2 * (stations - 1))
    marker = np.zeros((len(kept), markers, 3))
    turns, shifts = each_laid(clouds, clouds.reached(marker), kept)
    moving = np.flatnonzero(fitted)
    for _ in range(_STEPS):
        if not len(moving):
            break
        some, counts = clouds.picked(moving), kept[moving]
        own, at, place = marker[moving], turns[moving], shifts[moving]
        left = _left(some, some.reached(own), at, place) * counts[..., None]
        step = _step(some.columns(at, own), left, counts, 6 * stations)
        marker[moving] = own = own + step
        # The best turns and shifts for that marker: no step of theirs can then lead astray.
        turns[moving], shifts[moving] = each_laid(some, some.reached(own), counts)
        rms = np.sqrt((left**2).sum(axis=(1, 2)) / (3 * count[moving]))
        moving = moving[np.abs(step).max(axis=(1, 2)) >= np.maximum(_STILL, until * rms)]
    distance = np.linalg.norm(_left(clouds, clouds.reached(marker), turns, shifts), axis=-1)
    spare = 3 * count - 6 * stations - 3 * markers * fitted
    rms = np.sqrt((distance**2 * kept).sum(axis=1) * 3.0 / spare)
    return Laid(turns, shifts, marker, fitted, distance, rms)


def each_laid(clouds: Clouds, reached: Array, kept: Mask) -> tuple[Array, Array]:
    """(B, S, 3, 3) and (B, S, 3): the clouds of every station laid onto one another."""
    weight = kept[..., None] * clouds.of_station  # (B, P, S)
    every = weight.sum(axis=1)[..., None]
    along = weight.swapaxes(1, 2)
    middle, goal = along @ reached / every, along @ clouds.measured / every
    off = clouds.measured - goal[:, clouds.station]
    parts = weight[..., None] * off[:, :, None]  # (B, P, S, 3)
    tall = parts.reshape(*parts.shape[:2], -1).swapaxes(1, 2)
    cross = tall @ (reached - middle[:, clouds.station])
    turns = nearest_turn(cross.reshape(*every.shape[:2], 3, 3))
    return turns, goal - (turns @ middle[..., None])[..., 0]


def kabsch(reached: Array, measured: Array) -> tuple[Array, Array]:
    """Turn (3, 3) and shift (3,) that bring one cloud (P, 3) nearest to the other."""
    middle, goal = reached.mean(axis=0), measured.mean(axis=0)
    turn = nearest_turn((measured - goal).T @ (reached - middle))
    return turn, goal - turn @ middle


def nearest_turn(cross: Array) -> Array:
    """(..., 3, 3) the turns by which Σ measured reachedᵀ (..., 3, 3) is along both most."""
    u, _, vt = np.linalg.svd(cross)
    proper = np.ones(u.shape[:-1])
    proper[..., 2] = np.where(np.linalg.det(u @ vt) < 0.0, -1.0, 1.0)
    return np.asarray((u * proper[..., None, :]) @ vt)


def _left(clouds: Clouds, reached: Array, turns: Array, shifts: Array) -> Array:
    """(B, P, 3) measured less where the instrument sees what was reached."""
    seen = (turns[:, clouds.station] @ reached[..., None])[..., 0] + shifts[:, clouds.station]
    return np.asarray(clouds.measured - seen)


def _step(columns: Array, left: Array, kept: Mask, frames: int) -> Array:
    """(B, G, 3) step of the markers; none along what the positions do not tell."""
    columns = columns * np.repeat(kept, 3, axis=1)[..., None]
    size = np.linalg.norm(columns, axis=1)
    size[size == 0.0] = 1.0  # of a marker whose positions are all set aside
    columns = columns / size[:, None]
    across = columns.swapaxes(1, 2)
    values, ways = np.linalg.eigh(across @ columns)
    told = values > _SPANNED * values[:, -1:]
    along = (ways.swapaxes(1, 2) @ (across @ left.reshape(len(left), -1, 1)))[..., 0]
    step = (ways @ np.where(told, along / np.where(told, values, 1.0), 0.0)[..., None])[..., 0]
    return np.asarray((step / size)[:, frames:].reshape(len(left), -1, 3))
