"""What people do without a design: random poses, or poses spread well over the joints' ranges.

The paper's twenty poses were "well-spaced configurations ... determined heuristically to cover the
range of motion of all the active joints", loaded along orthogonal axes.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.plan.pool import Pool, usable_range


def random_choice(pool: Pool, count: int, rng: np.random.Generator) -> list[int]:
    """Candidates drawn without preference."""
    return [int(k) for k in rng.choice(pool.count, count, replace=False)]


def well_spread(pool: Pool, count: int, rng: np.random.Generator) -> list[int]:
    """Candidates whose poses lie far apart in the joints' ranges, loaded along x, y, z in turn.

    The first pose is random, each further one is the farthest from those before (Gonzalez 1985);
    of its loads the one nearest to the axis whose turn it is counts.
    """
    load_cases = pool.load_cases
    lower, upper = usable_range(load_cases.robot)
    place = (load_cases.a - lower) / np.where(upper > lower, upper - lower, 1.0)
    along = _directions(load_cases.wrench)
    distance = np.full(pool.count, np.inf)
    pick = int(rng.integers(pool.count))
    rows: list[int] = []
    for k in range(count):
        same = np.flatnonzero((load_cases.a == load_cases.a[pick]).all(axis=1))
        row = int(same[np.argmax(np.abs(along[same, k % 3]))])
        rows.append(row)
        distance = np.minimum(distance, np.linalg.norm(place - place[pick], axis=1))
        pick = int(np.argmax(distance))
    return rows


def _directions(wrench: Array) -> Array:
    force = wrench[:, :3]
    length = np.linalg.norm(force, axis=1, keepdims=True)
    return np.asarray(force / np.where(length > 0.0, length, 1.0))
