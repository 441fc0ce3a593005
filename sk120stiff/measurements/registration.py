"""Are marker positions those of this robot, in its base axes, and in the unit that was told?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.robot.rotations import crossed

# A marker that sits off the assumed point turns and stretches the cloud a little; beyond these
# bounds a turned tracker or a wrong unit is likelier.
_TURNED = np.radians(15.0)
_STRETCHED = 20.0
_WIDE = 0.1  # the second extent of a cloud that shows a rotation, against the first


MARKER_POSES = 5  # from here on the marker's place is fitted too
_STEPS = 100  # of Gauss and Newton


@dataclass(frozen=True, eq=False)
class Registration:
    """How far measured positions are off a robot's, moved and turned as a whole to fit best.

    Attributes:
        rms, largest: Distance that remains, root mean square per pose and at the worst pose [m].
        worst: Which pose that is.
        poses: Number of poses.
        marker: (3,) the marker in the tool frame, fitted from `MARKER_POSES` poses on [m].
        marker_fitted: Was it?
        turn, shift: (3, 3) and (3,) base axes as the instrument sees them, x = turn · X + shift
            [m].
        distance: (P,) what remains at each pose [m].
    """

    rms: float
    largest: float
    worst: int
    poses: int
    marker: Array
    marker_fitted: bool
    turn: Array
    shift: Array
    distance: Array


def register(
    measured: Array,
    flange: Array,
    rotation: Array,
    point: Array,
    *,
    fit_marker: bool = True,
) -> Registration | None:
    """Fit x = R (p + Q m) + t to positions: the tracker's frame R, t and the marker m.

    The turn is that of least squares (Kabsch, Acta Cryst. A32, 1976, p. 922) to begin with; then
    all nine unknowns are fitted together by Gauss and Newton.

    Args:
        measured: (P, 3) marker position at each pose [m], in any axes.
        flange, rotation: (P, 3) and (P, 3, 3) of the tool frame by the rigid robot, base axes [m].
        point: (3,) where the marker is said to be in the tool frame [m]; the start of the fit. Also
            (P, 3), where it differs from pose to pose: then what is fitted is a common shift of it.
        fit_marker: False leaves the marker where it is said to be.

    Returns:
        None with fewer than three poses: two positions fit any robot nearly.
    """
    count = len(measured)
    if count < 3:
        return None
    stated = flange + np.einsum("pij,pj->pi", rotation, np.broadcast_to(point, flange.shape))
    marker = np.zeros(3)
    fit_marker = fit_marker and count >= MARKER_POSES
    turn, shift = _kabsch(stated, measured)
    for _ in range(_STEPS if fit_marker else 0):
        arm = stated + rotation @ marker
        left = measured - arm @ turn.T - shift
        columns = np.concatenate(
            [-crossed(arm @ turn.T), np.tile(np.eye(3), (count, 1, 1)), turn @ rotation], axis=2
        )
        step = np.linalg.lstsq(columns.reshape(-1, 9), left.ravel(), rcond=1e-9)[0]
        marker = marker + step[6:]
        # The best turn and shift for that marker: no step of theirs can then lead astray.
        turn, shift = _kabsch(stated + rotation @ marker, measured)
        if np.abs(step[6:]).max() < 1e-10:
            break
    left = measured - (stated + rotation @ marker) @ turn.T - shift
    distance = np.linalg.norm(left, axis=1)
    spare = 3 * count - (9 if fit_marker else 6)
    rms = float(np.sqrt((distance**2).sum() * 3.0 / spare))
    worst = int(np.argmax(distance))
    return Registration(
        rms,
        float(distance[worst]),
        worst,
        count,
        marker if point.ndim == 2 else point + marker,
        fit_marker,
        turn,
        shift,
        distance,
    )


def _kabsch(reached: Array, measured: Array) -> tuple[Array, Array]:
    """Turn (3, 3) and shift (3,) that bring one cloud (P, 3) nearest to the other."""
    middle, goal = reached.mean(axis=0), measured.mean(axis=0)
    u, _, vt = np.linalg.svd((measured - goal).T @ (reached - middle))
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt)) or 1.0]) @ vt
    return turn, goal - turn @ middle


def registration_doubts(measured: Array, reached: Array) -> list[str]:
    """What speaks against positions in metres and base axes, in sentences; empty if nothing.

    Args:
        measured: (P, 3) marker position at each pose [m].
        reached: (P, 3) the same point by the rigid robot [m], base axes.

    Notes:
        The rotation between the two clouds is that of least squares (Kabsch, Acta Cryst. A32, 1976,
        p. 922); shifts do not matter, since displacements are differences.
    """
    clouds = [points - points.mean(axis=0) for points in (reached, measured)]
    spread = [float(np.linalg.norm(cloud)) for cloud in clouds]
    if len(measured) < 2 or min(spread) == 0.0:
        return []
    ratio = spread[1] / spread[0]
    if not 1.0 / _STRETCHED < ratio < _STRETCHED:
        return [
            f"The marker moves {ratio:.3g} times as far between the poses as the robot does. "
            "Check the units of positions and joints."
        ]
    u, extent, vt = np.linalg.svd(clouds[1].T @ clouds[0])
    if extent[1] < _WIDE**2 * extent[0]:
        return []  # points on a line show no rotation about it
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    angle = float(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0)))
    if angle < _TURNED:
        return []
    return [
        f"The positions seem to be turned by about {np.degrees(angle):.0f} deg against the base "
        "frame. Turn them into its axes first, or check joints and units; displacements in other "
        "axes give wrong springs."
    ]
