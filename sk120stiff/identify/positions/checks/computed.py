"""Positions that no instrument took: a controller's own, computed from the joint angles."""

from __future__ import annotations

import numpy as np

from sk120stiff.errors import micro
from sk120stiff.identify.positions.calibrate import Calibration

# m per axis: no arm of some size repeats so well (5 µm and more by ISO 9283), and no instrument
# that follows it reads so well (10 µm and more)
TOO_GOOD = 4e-6
SPREAD = 0.1  # m, rms distance from their middle: over less than that a gauge may
REST = 2  # numbers for every value estimated, with fewer of which a small gap says nothing


def computed(found: Calibration) -> list[str]:
    """That positions follow a chain of joints more closely than any arm does."""
    problem = found.problem
    absolute = problem.measurements.absolute
    where = None if absolute is None else absolute.channels.position
    if where is None or found.exceeds:
        return []
    stood = where[problem.measurements.use]
    spread = float(np.sqrt(np.nansum(np.nanvar(stood, axis=0))))
    few = len(problem.rows) < REST * found.estimated
    if few or spread < SPREAD or found.rms > TOO_GOOD:
        return []
    return [
        f"These positions follow the model to {micro(found.rms)} µm rms: no arm repeats itself so "
        "well, and no instrument that follows one reads so well. They look computed, as a "
        "controller shows its own position from the joint angles, and not measured: then they "
        "tell what it believes of the arm, not where the arm stands. Give what a tracker, a "
        "camera or a gauge has read."
    ]
