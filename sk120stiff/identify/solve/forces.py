"""What errors of the forces move, by a model of the arm; the law is in `noise/forces.py`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.effects import load_cases_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model

ALIKE = 0.1  # of what forces move, by which two models of an arm may differ
STEP = 0.01  # of the force, over which the displacement is taken for a line


def with_by_force(model: Model, measurements: Measurements) -> Measurements:
    """The readings with what each component of their force moves, were it off by the whole force.

    By central differences at exact equilibrium.

    Args:
        model: The arm; how soft it is counts, not what else it lacks.
        measurements: N readings under load.
    """
    cases = load_cases_of(model.robot, measurements)
    size = np.linalg.norm(cases.wrench[:, :3], axis=1)
    moved = np.zeros((cases.count, 3, 3))
    for axis in range(3):
        more = np.zeros((cases.count, 6))
        more[:, axis] = STEP * size
        ahead, behind = (
            model.predict(replace(cases, wrench=cases.wrench + way * more)) for way in (1.0, -1.0)
        )
        moved[:, :, axis] = (ahead - behind) / (2.0 * STEP)
    return replace(measurements, by_force=moved)


def moved_alike(one: Measurements, other: Measurements) -> bool:
    """Do forces move the point about as much, on average, by both?"""
    sizes = [rms(each.by_force) for each in (one, other) if each.by_force is not None]
    return len(sizes) < 2 or abs(sizes[0] - sizes[1]) <= ALIKE * sizes[1]
