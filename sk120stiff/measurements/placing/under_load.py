"""Positions under load beside those that the rigid robot was placed by: too far for any bending."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Index, rms
from sk120stiff.errors import InputError, short
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.placing.cloud import WILD, Cloud
from sk120stiff.measurements.placing.from_a_row_on import refuse_from_a_row_on
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.robot.anatomy import arm_length

BENT = 0.1  # of its stretched length: no arm that measures anything bends by as much
EXPLAINED = 0.1  # of what is left, by which a slip must leave less


def refuse_far_under_load(
    cloud: Cloud, found: Registration, readings: Measurements, rows: Index
) -> None:
    """Refuse rows of which many lie where no load can have moved the tool.

    Args:
        cloud: All positions, whatever their load, of these `rows` of the readings.
        found: Where the rows under the least load place the robot.
        readings, rows: Where they come from.

    Raises:
        InputError: Joints and positions of many rows are not of one reading.
    """
    left = cloud.left(found)
    far = left > BENT * arm_length(cloud.robot)
    if far.mean() < WILD:  # else single rows, which are set aside
        return
    told = (
        f"{int(far.sum())} of {len(rows)} rows lie up to {short(float(left.max()))} m from where "
        "the robot has the marker, placed by those under the least load of their pose"
    )
    least = EXPLAINED * rms(left)
    refuse_from_a_row_on(cloud, told, least, readings, rows)
    raise InputError(
        f"{told}, the first in line {readings.line[rows[np.flatnonzero(far)[0]]]}; no load bends "
        "an arm by so much",
        where=readings.place,
        remedy="Check that joints, load and position of a row are of one reading.",
    )
