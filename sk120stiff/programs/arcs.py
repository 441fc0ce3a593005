"""Points on an arc or helix, close enough that its chords keep a tolerance."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array

WIDEST = np.pi / 2  # of one chord, however coarse the tolerance
UNEQUAL, UNEQUAL_SHARE = 5e-6, 1e-3  # m and of the radius: ends that differ by more share no arc
FAR = 5e-4  # m: ends that differ by more share none either (the rule of LinuxCNC)
WHOLE = 1e-9  # rad: a smaller sweep means a whole turn


def arc_points(
    start: Array,
    end: Array,
    centre: Array,
    normal: Array,
    *,
    turns: int,
    chord: float,
    most: int,
) -> Array | str:
    """(k, 3) points after `start` up to and with `end`, or why there are none.

    The way is right-handed about `normal` (3,); where the ends differ along it the way is a helix.
    A chord over the angle φ is off its arc by r (1 − cos(φ/2)), so φ = 2 acos(1 − chord/r).

    Args:
        centre: (3,) any point of the axis [m].
        turns: How often the end's direction is passed, the last time included.
        chord: Largest distance between arc and chord [m].
        most: Number of points that may not be passed.
    """
    n = normal / np.linalg.norm(normal)
    out, back = start - centre, end - centre
    rise = float((end - start) @ n)
    out, back = out - (out @ n) * n, back - (back @ n) * n
    r, r_end = float(np.linalg.norm(out)), float(np.linalg.norm(back))
    if min(r, r_end) < 1e-9:
        return "the arc has no radius"
    if abs(r - r_end) > FAR or (
        abs(r - r_end) > UNEQUAL and abs(r - r_end) > UNEQUAL_SHARE * max(r, r_end)
    ):
        return (
            f"the arc begins {1e3 * r:.4f} mm from its centre and ends {1e3 * r_end:.4f} mm from it"
        )
    u = out / r
    v = np.cross(n, u)
    sweep = float(np.arctan2(back @ v, back @ u)) % (2.0 * np.pi)
    if sweep < WHOLE or 2.0 * np.pi - sweep < WHOLE:
        sweep = 2.0 * np.pi
    sweep += 2.0 * np.pi * (turns - 1)
    widest = min(WIDEST, 2.0 * float(np.arccos(max(1.0 - chord / r, -1.0))))
    if sweep > most * widest:
        return f"the arc needs more than {most} points for a chord tolerance of {1e6 * chord:g} µm"
    count = max(1, int(np.ceil(sweep / widest - 1e-9)))
    share = np.arange(1, count + 1)[:, None] / count
    radius = r + share * (r_end - r)
    around = np.cos(share * sweep) * u + np.sin(share * sweep) * v
    foot = centre + ((start - centre) @ n) * n
    points = foot + radius * around + share * rise * n
    points[-1] = end
    return np.asarray(points)
