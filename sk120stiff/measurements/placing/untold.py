"""A marker's place along directions that the positions do not tell: it stays where it is stated.

Where a tool hangs alike at all poses, how far the marker is along it trades against how far the
tracker is; least squares put both metres away then, and what is fitted after begins there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import listed
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.registration import Registration, register
from sk120stiff.robot.anatomy import arm_length

FAR = 2.0  # m; standard error of a marker's place that tells nothing: none is held so far away
ALONG = 0.05  # component of a unit direction below which it is not told


def with_told_place(
    cloud: Cloud, found: Registration, kept: Mask
) -> tuple[Registration, list[str]]:
    """The placing with the marker as stated along what is not told, and a sentence for each.

    The directions are those of the marker's covariance, so what is told of it does not change.

    Args:
        cloud, found: The positions, and their placing.
        kept: (N,) rows that it rests on.
    """
    ways = found.untold(min(FAR, arm_length(cloud.robot)))
    if not len(ways):
        return found, []
    marker = found.marker - ways.T @ (ways @ found.marker)
    point, screws = cloud.point + marker + found.apart[cloud.group], cloud.robot.screws(cloud.a)
    again = register(
        cloud.x[kept], screws.frame_position[kept], screws.rotation[kept], point[kept],
        fit_marker=False, station=cloud.station[kept],
    )  # fmt: skip
    if again is None:
        return found, []
    errors = np.sqrt(np.einsum("ki,ij,kj->k", ways, found.of_marker, ways))
    said = [
        f"These positions do not tell where the marker sits along {_way(way)} of the tool frame (± "
        f"{error:.2g} m): how far the tracker is trades against it, since the tool hangs alike at "
        "all poses. Its stated place is kept along it. State it where you know it, and tilt the "
        "tool at some poses."
        for way, error in zip(ways, errors, strict=True)
    ]
    return replace(again, marker=marker, marker_fitted=True, apart=found.apart), said


def _way(way: Array) -> str:
    """``z``, or ``0.8 x - 0.6 z``."""
    way = way * np.sign(way[np.argmax(np.abs(way))])
    parts = [(v, name) for v, name in zip(way, "xyz", strict=True) if abs(v) > ALONG]
    if len(parts) == 1:
        return parts[0][1]
    return listed([f"{v:.2g} {name}" for v, name in parts])
