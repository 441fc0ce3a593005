"""Poses and loads that could be measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.effects import Situation, situation_of_load
from sk120stiff.robot import Robot
from sk120stiff.robot.coupling import Array

REACH_OF_UNLIMITED = np.pi  # rad; a joint without limits is used over one turn
REACH_OF_UNLIMITED_SLIDE = 0.5  # m
SHARE_OF_RANGE = 0.9  # the ends of the range are left out


@dataclass(frozen=True, eq=False)
class Pool:
    """M candidate readings.

    Attributes
    ----------
    situation
        Their poses and loads.
    """

    situation: Situation

    @property
    def count(self) -> int:
        """Number of candidates M."""
        return self.situation.count


def random_pool(
    robot: Robot,
    *,
    poses: int,
    directions: int,
    force: float,
    point: Array,
    seed: int = 0,
) -> Pool:
    """Random poses within the joint limits, each under loads in random directions.

    Parameters
    ----------
    robot
        The robot; only joint limits restrict its poses.
    poses, directions
        Number of poses, and of load directions at each.
    force
        Size of the loads [N].
    point
        (3,) measured and loaded point in the tool frame [m].
    seed
        Of the draw.
    """
    rng = np.random.default_rng(seed)
    a = random_poses(robot, poses, rng)
    loads = np.zeros((poses * directions, 6))
    loads[:, :3] = rng.normal(size=(poses * directions, 3))
    loads[:, :3] *= force / np.linalg.norm(loads[:, :3], axis=1, keepdims=True)
    return Pool(situation_of_load(robot, np.repeat(a, directions, axis=0), loads, point=point))


def random_poses(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """(count, n) coordinates drawn evenly from the middle of the joint ranges."""
    reach = np.where(robot.prismatic, REACH_OF_UNLIMITED_SLIDE, REACH_OF_UNLIMITED)
    lower = np.where(np.isfinite(robot.lower), robot.lower, -reach)
    upper = np.where(np.isfinite(robot.upper), robot.upper, reach)
    middle, half = 0.5 * (lower + upper), 0.5 * SHARE_OF_RANGE * (upper - lower)
    return np.asarray(middle + half * rng.uniform(-1.0, 1.0, (count, robot.n)))
