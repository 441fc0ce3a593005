"""A file of gauges alone is one of displacements, whatever directions they read along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import in_columns
from sk120stiff.measurements.files.subtraction import as_written, jitter
from sk120stiff.measurements.poses import SAME_JOINT
from sk120stiff.measurements.table.branches import branches_of
from sk120stiff.measurements.table.rows import Rows


def as_displacements(measurements: Measurements) -> Measurements:
    """What gauges read of one point, and nothing else, as displacements along those directions.

    Other readings come back as they are.
    """
    said = measurements.absolute
    if said is None or not _gauges_alone(measurements, said):
        return measurements
    read, along = said.channels.shift, said.channels.along
    if read is None or along is None:
        raise ValueError("gauges without numbers or directions")
    known = np.isfinite(read)[:, None]
    directions = np.where(known, along, np.eye(3)[0])
    rows = Rows(
        pose=measurements.pose,
        pose_index=measurements.pose_index,
        joints=measurements.joints,
        wrench=measurements.wrench,
        loaded=np.any(measurements.wrench != 0.0, axis=1),
        measured=in_columns(directions, read),
        sigma=None,
        order=measurements.order,
        time=measurements.time,
        branch=measurements.branch,
        repeat=measurements.repeat,
        use=measurements.use,
    )
    found = as_written(rows, said.zero)
    branch, told = branches_of(rows.branch, rows.pose_index, rows.wrench, rows.clock)
    return replace(
        measurements,
        absolute=None,
        displacement=found.displacement,
        directions=directions,
        point=said.point[0],
        sigma=None,
        branch=branch,
        zero=found.zero,
        zero_group=found.group,
        zero_count=found.count,
        zero_order=found.order,
        zero_time=found.time,
        zero_joints=rows.joints if jitter(rows) > SAME_JOINT else None,
        use=found.use,
        notes=(*measurements.notes, *found.notes, *([told] if told else [])),
    )


def _gauges_alone(measurements: Measurements, said: Absolute) -> bool:
    """Did gauges read one known point under loads that are stated as such, and nothing else?"""
    if said.channels.present != ("shift",) or not measurements.wrench.any():
        return False
    placed = not said.fit_point and bool((said.point == said.point[0]).all())
    hung = said.fit_payload or bool(said.payload.any())
    return placed and not hung and said.frame == "base"
