"""A force sensor that is screwed on turned reads in axes of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from sk120stiff.measurements.settings import SettingsFile

FORCE, MOMENT = slice(3), slice(3, 6)  # of a wrench


def in_the_frame(wrench: Array, file: SettingsFile) -> Array:
    """Forces and moments (N, 6) of the sensor's own axes, turned into those of `force.frame`.

    Raises:
        InputError: The turn without its unit, the unit without a turn, or no unit of angles.
    """
    said = file.settings.force
    if said.rpy is None and said.rpy_unit is None:
        return wrench
    if said.rpy is None or said.rpy_unit is None:
        raise InputError(
            "the turn of the force's axes is a triple with its unit",
            where=file.place("force.rpy" if said.rpy is not None else "force.rpy_unit"),
            remedy="Write force: {frame: tool, rpy: [0, 0, 30], rpy_unit: deg}.",
        )
    rpy = units.to_si(said.rpy, said.rpy_unit, "angle", where=file.place("force.rpy_unit"))
    turn = Rotation.from_euler("xyz", rpy)
    return np.hstack([turn.apply(wrench[:, part]) for part in (FORCE, MOMENT)])
