"""A force sensor that is screwed on turned reads in axes of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from sk120stiff.measurements.table.settings import SettingsFile

FORCE, MOMENT = slice(3), slice(3, 6)  # of a wrench

Rpy = tuple[float, float, float]  # roll, pitch, yaw of a sensor's axes [rad]


def axes_line(frame: str, turn: Rotation, stated: Rpy | None) -> str:
    """What to write where the axes are turned by `turn` beyond what was stated."""
    whole = turn * Rotation.from_euler("xyz", stated or (0.0, 0.0, 0.0))
    rpy = ", ".join(f"{v + 0.0:g}" for v in np.round(whole.as_euler("xyz", degrees=True), 1))
    return f"force: {{frame: {frame}, rpy: [{rpy}], rpy_unit: deg}}"


def stated_rpy(file: SettingsFile) -> Rpy | None:
    """The turn that the file states; None: none."""
    said = file.settings.force
    if said.rpy is None or said.rpy_unit is None:
        return None
    rpy = units.to_si(said.rpy, said.rpy_unit, "angle", where=file.place("force.rpy_unit"))
    return float(rpy[0]), float(rpy[1]), float(rpy[2])


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
    turn = Rotation.from_euler("xyz", stated_rpy(file))
    return np.hstack([turn.apply(wrench[:, part]) for part in (FORCE, MOMENT)])
