"""Are marker positions given in the robot's base axes, and in the unit that was told?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# A marker that sits off the assumed point turns and stretches the cloud a little; beyond these
# bounds a turned tracker or a wrong unit is likelier.
_TURNED = np.radians(15.0)
_STRETCHED = 20.0
_WIDE = 0.1  # the second extent of a cloud that shows a rotation, against the first


def registration_doubts(measured: Floats, reached: Floats) -> list[str]:
    """What speaks against positions in metres and base axes, in sentences; empty if nothing.

    Parameters
    ----------
    measured
        (P, 3) marker position at each pose [m].
    reached
        (P, 3) the same point by the rigid robot [m], base axes.

    Notes
    -----
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
