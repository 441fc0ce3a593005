"""Where the instrument stands: marker positions laid onto those of the rigid robot."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.measurements.placing.laying import Clouds, Laid, lay

_TOLD = 1e-6  # the least singular value, of columns of length one, that determines a frame


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
        of_marker: (3, 3) covariance of the fitted marker, of the first of several [m²].
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
    of_marker: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def untold(self, limit: float) -> Array:
        """(k, 3) unit directions of the tool frame along which the marker's place is not told.

        Args:
            limit: Standard error beyond which it is not [m].
        """
        if not self.marker_fitted or not np.isfinite(self.of_marker).all():
            return np.zeros((0, 3))
        variances, ways = np.linalg.eigh(self.of_marker)
        return np.asarray(ways.T[variances > limit**2])

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
    group = np.zeros(count, dtype=np.intp) if group is None else group
    clouds = Clouds(measured, flange[None], rotation[None], point, group, station)
    kept = np.ones((1, count), dtype=bool)
    found = lay(clouds, kept, fit_marker=fit_marker, until=until)
    return registration_of(clouds, found, kept[0])


def registration_of(clouds: Clouds, found: Laid, kept: Mask) -> Registration:
    """All that the placing of one robot tells by the positions (P,) that were kept."""
    (marker,), (rms,), distance = found.marker, found.rms, found.distance[0, kept]
    worst, point = int(np.argmax(distance)), clouds.point
    fitted, frames = bool(found.fitted[0]), 6 * found.turns.shape[1]
    columns = clouds.columns(found.turns, found.marker)[0, np.repeat(kept, 3)]
    return Registration(
        float(rms),
        float(distance[worst]),
        worst,
        len(distance),
        marker[0] if point.ndim == 2 else point + marker[0],
        fitted,
        found.turns[0],
        found.shifts[0],
        distance,
        _covariances(columns[:, : None if fitted else frames], frames, float(rms) ** 2 / 3.0),
        marker - marker[0],
        _of_marker(columns, frames, float(rms) ** 2 / 3.0),
    )


def _of_marker(columns: Array, frames: int, variance: float) -> Array:
    """(3, 3) covariance of the first marker's place, frames and other markers fitted beside it."""
    own, others = columns[:, frames : frames + 3], np.delete(columns, np.s_[frames : frames + 3], 1)
    if not own.shape[1]:
        return np.zeros((3, 3))
    left = own - others @ np.linalg.lstsq(others, own, rcond=None)[0]
    values, ways = np.linalg.eigh(left.T @ left)
    floor = (_TOLD * np.linalg.norm(own, axis=0).max()) ** 2
    return np.asarray(variance * (ways / np.maximum(values, floor)) @ ways.T)


def _moved(turns: Array, shifts: Array, at: Array, station: Index) -> Array:
    return np.asarray(np.einsum("pij,pj->pi", turns[station], at) + shifts[station])


def _covariances(columns: Array, frames: int, variance: float) -> Array:
    """(S, 6, 6) of the unknowns of each frame; infinite where they are not determined."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    _, values, vt = np.linalg.svd(columns / size, full_matrices=False)
    if values[-1] < _TOLD * values[0]:
        return np.full((frames // 6, 6, 6), np.inf)
    root = ((vt.T / values)[:frames] / size[:frames, None]).reshape(-1, 6, len(size))
    return np.asarray(variance * root @ root.swapaxes(1, 2))
