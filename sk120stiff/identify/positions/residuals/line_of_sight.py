"""What is left of positions along the instrument's line of sight, against across it."""

from __future__ import annotations

import numpy as np
from scipy import stats

from sk120stiff.identify.positions.calibrate import Calibration

FEWEST = 20  # whole positions that tell it
TIMES = 2.0  # as large one way as the other: less, and weighing by it gains little
CHANCE = 1e-6  # that noise alike along all axes does as much


def by_line_of_sight(found: Calibration) -> list[str]:
    """A sentence where the gap is larger along the line of sight, or across it; else nothing.

    Of positions in the instrument's own axes, at whose origin it stands, of which nobody stated
    that they are surer one way.
    """
    problem = found.problem
    said, channels = problem.said, problem.channels
    own = channels.rays is not None or channels.sigma_of_rows is not None
    position = channels.position
    if said.frame != "unknown" or own or position is None or "position" not in channels.present:
        return []
    part = channels.kinds[channels.present.index("position")]
    gap = np.full(position.shape, np.nan)
    gap[channels.held("position")] = problem.channel_gap(found.model.values)[0][part]
    whole = np.isfinite(gap).all(axis=1)
    count, far = int(whole.sum()), np.linalg.norm(position[whole], axis=1)
    if count < FEWEST or not (far > 0.0).all():
        return []
    ray = position[whole] / far[:, None]
    onto = (gap[whole] * ray).sum(axis=1)
    along = float(np.mean(onto**2))
    across = float(np.mean((gap[whole] ** 2).sum(axis=1) - onto**2) / 2.0)
    share = max(1.0 - found.estimated / max(len(problem.rows), 1), 1.0 / count)  # left free
    ratio = along / across if across > 0.0 else np.inf
    chance = stats.f.sf(max(ratio, 1.0 / ratio), share * count, 2.0 * share * count)
    if not (max(ratio, 1.0 / ratio) > TIMES**2 and chance < CHANCE):
        return []
    a, b = 1e6 * np.sqrt(along), 1e6 * np.sqrt(across)
    times, way, other = (a / b, "along", "across") if a > b else (b / a, "across", "along")
    entry = f"{{unit: um, instrument: {{along: {_plain(a)}, across: {_plain(b)}}}}}"
    return [
        f"The gap is {_plain(times)} times as large {way} the line of sight from the origin of "
        f"these axes as {other} it ({max(a, b):.3g} against {min(a, b):.3g} µm rms). If an "
        "instrument stands there that is so, as a camera is, write its uncertainties in the place "
        f"of sigma, about noise: {entry}: readings then count for what they are worth."
    ]


def _plain(value: float) -> str:
    """Two significant digits, without an exponent."""
    return f"{float(f'{value:.2g}'):g}"
