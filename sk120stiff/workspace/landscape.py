"""How good the postures around the best one are: a search on a grid over what the task leaves free.

The arm starts the path with its tool turned by every angle of a grid about the tool's own axis, or
with every orientation of a random set where that axis is free too, in every branch that random
starts find. It follows the path as the search for the best posture does; the worst point counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.workspace.inverse import Task, solve_inverse, starting_poses
from sk120stiff.workspace.posture import BestPosture


@dataclass(frozen=True, eq=False)
class Landscape:
    """Postures on a grid over an angle, and the one that was chosen.

    Attributes:
        tilt: Is the angle between the tool's z axis and straight down (base −z)? Else it is that of
            the tool's x axis about its z axis, from the base's x axis (its y axis where z is along
            x). At the first point of the path.
        angle: (k,) that angle [rad].
        objective: (k,) worst compliance [m/N] or deflection [m] along the path; several per angle:
            branches.
        chosen: Angle and objective of the posture that was chosen.
    """

    tilt: bool
    angle: Array
    objective: Array
    chosen: tuple[float, float]


def posture_landscape(found: BestPosture, *, angles: int = 120, starts: int = 16) -> Landscape:
    """Judge postures over the orientations that a path leaves free, the part where `found` puts it.

    Args:
        found: What `best_posture` answered.
        angles, starts: Angles over a whole turn (four times as many orientations where all are
            free), and starts of the inverse kinematics at each.

    Raises:
        InputError: The task fixes the tool's orientation: there is nothing to turn.
    """
    judge = found.judge
    if judge.path.rotation is not None:
        raise InputError(
            "the path fixes the orientation of the tool, so there is no turn to look at",
            remedy="Give a tool axis instead of an orientation.",
        )
    tool = judge.arm.kinematics(found.a[:1])
    z, x = tool.rotation[0, :, 2], tool.rotation[0, :, 0]
    across = _across(z)
    own = float(np.arctan2(x @ np.cross(z, across), x @ across))
    tilt = judge.path.axis is None
    if tilt:
        rotation = np.concatenate([_orientations(4 * angles), tool.rotation[:1]])
        grid = np.arccos(np.clip(-rotation[:, 2, 2], -1.0, 1.0))
        own = float(grid[-1])
    else:
        grid = np.append(np.linspace(-np.pi, np.pi, angles, endpoint=False), own)
        rotation = np.stack([_turned(z, across, turn) for turn in grid])
    seeds = starting_poses(judge.arm, starts, np.clip(found.a[0], judge.arm.lower, judge.arm.upper))
    task = Task(
        np.tile(tool.position[0], (len(grid) * len(seeds), 1)),
        rotation=np.repeat(rotation, len(seeds), axis=0),
    )
    reached = solve_inverse(judge.arm, task, np.tile(seeds, (len(grid), 1)))
    a = reached.a[reached.found]
    judged = judge(a, np.tile(found.placement, (len(a), 1))).objective
    passes = np.isfinite(judged)
    angle = np.repeat(grid, len(seeds))[reached.found]
    return Landscape(tilt, angle[passes], judged[passes], (own, found.objective))


def _orientations(count: int) -> Array:
    """(count, 3, 3) orientations, spread evenly at random."""
    from scipy.spatial.transform import Rotation

    drawn = np.random.default_rng(0).normal(size=(count, 4))
    return np.asarray(Rotation.from_quat(drawn).as_matrix(), dtype=float)


def _across(z: Array) -> Array:
    """Unit vector across z, as near to the base's x axis as can be, or to its y axis."""
    goal = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.99 else np.array([0.0, 1.0, 0.0])
    across = goal - (goal @ z) * z
    return np.asarray(across / np.linalg.norm(across), dtype=float)


def _turned(z: Array, across: Array, turn: float) -> Array:
    """(3, 3) orientation whose third axis is z and whose first is `across` turned about it."""
    x = np.cos(turn) * across + np.sin(turn) * np.cross(z, across)
    return np.stack([x, np.cross(z, x), z], axis=1)
