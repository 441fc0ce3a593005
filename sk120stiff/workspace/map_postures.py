"""The postures of a finished map over positions: elbows, and joints below the base."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff.robot import Robot
from sk120stiff.workspace.branch import elbow_sides, joint_heights
from sk120stiff.workspace.finished import open_map


@dataclass(frozen=True)
class MapPostures:
    """How an arm stands at the points of a map.

    Attributes:
        elbow_up, elbow_down: Numbers of points.
        lowest_joint, lowest: The joint that comes lowest, and how low, base frame [m].
        sunk: Number of points at which a joint lies below the base plane and the point itself.
    """

    elbow_up: int
    elbow_down: int
    lowest_joint: str
    lowest: float
    sunk: int


def map_postures(robot: Robot, store: Path) -> MapPostures | None:
    """The postures that a finished map over positions holds; None where no point was reached."""
    dataset = open_map(store)
    joints = np.asarray(dataset["joints"].values).reshape(-1, robot.n)
    order = [str(name) for name in dataset["joints"].dims[:-1]]
    z = np.asarray(dataset["z"].values)
    heights = np.moveaxis(
        np.broadcast_to(z, [*(dataset.sizes[n] for n in order if n != "z"), len(z)]),
        -1,
        order.index("z"),
    ).ravel()
    reached = np.isfinite(joints).all(axis=1)
    if not reached.any():
        return None
    sides = elbow_sides(robot, joints[reached])
    low = joint_heights(robot, joints[reached])
    deepest = low.min(axis=1)
    sunk = deepest < np.minimum(0.0, heights[reached]) - 1e-9
    column = int(np.unravel_index(int(np.argmin(low)), low.shape)[1])
    return MapPostures(
        elbow_up=int((sides > 0).sum()),
        elbow_down=int((sides < 0).sum()),
        lowest_joint=robot.mechanism().chain.names[1:][column],
        lowest=float(low.min()),
        sunk=int(sunk.sum()),
    )
