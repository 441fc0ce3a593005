"""Where the instrument stands: marker positions laid onto those of the rigid robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.robot.rotations import crossed

_TOLD = 1e-6  # the least singular value, of columns of length one, that determines a frame

MARKER_POSES = 5  # from here on the marker's place is fitted too
_STEPS = 100  # of Gauss and Newton
_STILL = 1e-10  # m; a marker that moves by less is found


@dataclass(frozen=True, eq=False)
class Registration:
    """How far measured positions are off a robot's, moved and turned as a whole to fit best.

    Attributes:
        rms, largest: Distance that remains, root mean square per pose and at the worst pose [m].
        worst: Which pose that is.
        poses: Number of poses.
        marker: (3,) the marker in the tool frame, fitted from `MARKER_POSES` poses on [m].
        marker_fitted: Was it?
        turns, shifts: (S, 3, 3) and (S, 3) base axes as the instrument sees them from each of its
            stations, x = turn · X + shift [m].
        distance: (P,) what remains at each pose [m].
        covariances: (S, 6, 6) of a small turn of the base about its origin, axes of the instrument
            [rad], and of the shift [m], as far as what remains is independent noise; infinite where
            the positions do not tell the frame.
        apart: (G, 3) how much farther than the first each marker is off its stated place [m].
    """

    rms: float
    largest: float
    worst: int
    poses: int
    marker: Array
    marker_fitted: bool
    turns: Array
    shifts: Array
    distance: Array
    covariances: Array
    apart: Array

    @property
    def std(self) -> Array:
        """(S, 6) standard errors of turns [rad] and shifts [m]."""
        return np.asarray(np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2)))

    def seen(self, at: Array, station: Index) -> Array:
        """(P, 3) positions in base axes as the instrument sees them from its stations (P,)."""
        return _moved(self.turns, self.shifts, at, station)

    def in_base(self, measured: Array, station: Index) -> Array:
        """(P, 3) positions of the instrument, which stood at `station` (P,), in base axes."""
        return np.asarray(
            np.einsum("pji,pj->pi", self.turns[station], measured - self.shifts[station])
        )


def register(
    measured: Array,
    flange: Array,
    rotation: Array,
    point: Array,
    *,
    fit_marker: bool = True,
    group: Index | None = None,
    station: Index | None = None,
    until: float = 0.0,
) -> Registration | None:
    """Fit x = R (p + Q m) + t to positions: the tracker's frames R, t and the marker m.

    The turns are those of least squares (Kabsch, Acta Cryst. A32, 1976, p. 922) to begin with; then
    all unknowns are fitted together by Gauss and Newton.

    Args:
        measured: (P, 3) marker position at each pose [m], in any axes.
        flange, rotation: (P, 3) and (P, 3, 3) of the tool frame by the rigid robot, base axes [m].
        point: (3,) where the marker is said to be in the tool frame [m]; the start of the fit. Also
            (P, 3), where it differs from pose to pose: then what is fitted is a common shift of it.
        fit_marker: False leaves the marker where it is said to be.
        group: (P,) number of the marker that was read, from 0 on, where several have places of
            their own; None: one.
        station: (P,) number of the place that the instrument stood at, from 0 on; None: one.
        until: The marker is found where it moves by less than this share of what is left.

    Returns:
        None with fewer than three poses at a station: two positions fit any robot nearly.
    """
    count = len(measured)
    station = np.zeros(count, dtype=np.intp) if station is None else station
    if count < 3 or np.bincount(station).min() < 3:
        return None
    stated = flange + np.einsum("pij,pj->pi", rotation, np.broadcast_to(point, flange.shape))
    group = np.zeros(count, dtype=np.intp) if group is None else group
    marker = np.zeros((int(group.max()) + 1, 3))
    here = np.eye(int(station.max()) + 1)[station]
    frames = 6 * here.shape[1]
    fit_marker = fit_marker and count >= MARKER_POSES + len(marker) - 1 + 2 * (here.shape[1] - 1)
    turns, shifts = _each_laid(stated, measured, station)

    def columns() -> Array:
        """(3P, 6 S + 3 G) derivative by the turns and shifts of S stations and the G markers."""
        turn = turns[station]
        seen = np.einsum("pij,pj->pi", turn, reached())
        frame = np.concatenate([-crossed(seen), np.tile(np.eye(3), (count, 1, 1))], axis=2)
        own = np.einsum("pij,pg->pigj", turn @ rotation, np.eye(len(marker))[group])
        parts = [np.einsum("pij,ps->pisj", frame, here), own]
        return np.concatenate([part.reshape(3 * count, -1) for part in parts], axis=1)

    def reached() -> Array:
        return np.asarray(stated + np.einsum("pij,pj->pi", rotation, marker[group]))

    for _ in range(_STEPS if fit_marker else 0):
        left = measured - _moved(turns, shifts, reached(), station)
        step = np.linalg.lstsq(columns(), left.ravel(), rcond=1e-9)[0]
        marker = marker + step[frames:].reshape(-1, 3)
        # The best turns and shifts for that marker: no step of theirs can then lead astray.
        turns, shifts = _each_laid(reached(), measured, station)
        if np.abs(step[frames:]).max() < max(_STILL, until * float(np.sqrt(np.mean(left**2)))):
            break
    left = measured - _moved(turns, shifts, reached(), station)
    distance = np.linalg.norm(left, axis=1)
    spare = 3 * count - frames - (marker.size if fit_marker else 0)
    rms = float(np.sqrt((distance**2).sum() * 3.0 / spare))
    worst = int(np.argmax(distance))
    return Registration(
        rms,
        float(distance[worst]),
        worst,
        count,
        marker[0] if point.ndim == 2 else point + marker[0],
        fit_marker,
        turns,
        shifts,
        distance,
        _covariances(columns()[:, : None if fit_marker else frames], frames, rms**2 / 3.0),
        marker - marker[0],
    )


def _moved(turns: Array, shifts: Array, at: Array, station: Index) -> Array:
    return np.asarray(np.einsum("pij,pj->pi", turns[station], at) + shifts[station])


def _each_laid(reached: Array, measured: Array, station: Index) -> tuple[Array, Array]:
    """(S, 3, 3) and (S, 3): the clouds of every station laid onto one another."""
    rows = [station == k for k in range(int(station.max()) + 1)]
    laid = [kabsch(reached[own], measured[own]) for own in rows]
    return np.stack([turn for turn, _ in laid]), np.stack([shift for _, shift in laid])


def _covariances(columns: Array, frames: int, variance: float) -> Array:
    """(S, 6, 6) of the unknowns of each frame; infinite where they are not determined."""
    size = np.linalg.norm(columns, axis=0)
    _, values, vt = np.linalg.svd(columns / size, full_matrices=False)
    if values[-1] < _TOLD * values[0]:
        return np.full((frames // 6, 6, 6), np.inf)
    root = ((vt.T / values)[:frames] / size[:frames, None]).reshape(-1, 6, len(size))
    return np.asarray(variance * root @ root.swapaxes(1, 2))


def kabsch(reached: Array, measured: Array) -> tuple[Array, Array]:
    """Turn (3, 3) and shift (3,) that bring one cloud (P, 3) nearest to the other."""
    middle, goal = reached.mean(axis=0), measured.mean(axis=0)
    u, _, vt = np.linalg.svd((measured - goal).T @ (reached - middle))
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt)) or 1.0]) @ vt
    return turn, goal - turn @ middle
