"""In which posture an arm runs along a path: elbow up or down, how low, how smoothly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot import Robot

JUMP = 0.5  # rad or m between neighbouring points; a path is not meant to do that
BLOCK = 4096  # points looked at together
BENT = 1e-3  # of the way from shoulder to wrist; nearer to it an elbow is neither up nor down


@dataclass(frozen=True, eq=False)
class Branch:
    """The posture of an arm along a path of N points.

    Attributes:
        first: (n,) joint coordinates at the first point [rad or m].
        elbow: Joint that lies farthest from the line between shoulder and wrist at the first point;
            None for chains without one, and for stretched arms.
        elbow_height: Its height there, base frame [m].
        elbow_up: Does it lie above that line?
        lowest: Smallest height of any joint of the arm along the path, base frame [m].
        lowest_joint, lowest_point: Which joint, and at which point of the path.
        below: Number of points at which some joint lies below the floor.
        floor: That height [m].
        jumps: Points after which a joint moves by more than `JUMP` to the next one.
    """

    first: Array
    elbow: str | None
    elbow_height: float
    elbow_up: bool
    lowest: float
    lowest_joint: str
    lowest_point: int
    below: int
    floor: float
    jumps: tuple[int, ...]


def joint_heights(robot: Robot, a: Array) -> Array:
    """(N, m − 1) height of the joints from the second one on, base frame [m]."""
    parts = [
        robot.screws(a[k : k + BLOCK]).origins[:, 1:, 2] for k in range(0, max(len(a), 1), BLOCK)
    ]
    return np.concatenate(parts)


def stays_above(robot: Robot, a: Array, floor: float) -> Mask:
    """(N,) poses (N, n) at which no joint lies below the floor [m]."""
    return np.asarray((joint_heights(robot, a) >= floor - 1e-9).all(axis=1), dtype=bool)


def lowest_floor(robot: Robot, a: Array | None, heights: Array | None) -> float:
    """What counts as the floor where none was given [m]: the base plane, or the path if lower.

    The tool goes along the path, given by joint coordinates (N, n) or by heights (N,) [m], so the
    floor is no higher than that.
    """
    if heights is None:
        heights = np.zeros(0) if a is None else robot.placement(a)[:, 2, 3]
    return float(np.min(heights, initial=0.0))


def branch_of(robot: Robot, a: Array, floor: float) -> Branch:
    """Describe the posture along joint coordinates (N, n), N ≥ 1, above a floor [m]."""
    names = robot.mechanism().chain.names
    heights = joint_heights(robot, a)
    where = np.unravel_index(int(np.argmin(heights)), heights.shape) if heights.size else (0, 0)
    name, height, up = _elbow(robot, a[0])
    moves = np.abs(np.diff(a, axis=0)).max(axis=1, initial=0.0)
    return Branch(
        first=a[0],
        elbow=name,
        elbow_height=height,
        elbow_up=up,
        lowest=float(heights.min()) if heights.size else float("nan"),
        lowest_joint=names[int(where[1]) + 1] if heights.size else names[0],
        lowest_point=int(where[0]),
        below=int((~stays_above(robot, a, floor)).sum()),
        floor=floor,
        jumps=tuple(int(k) for k in np.flatnonzero(moves > JUMP)),
    )


def elbow_sides(robot: Robot, a: Array) -> NDArray[np.int8]:
    """(N,) 1 where the elbow is up at poses (N, n), -1 where it is down, 0 where there is none."""
    parts = [_elbows(robot, a[k : k + BLOCK])[1] for k in range(0, max(len(a), 1), BLOCK)]
    return np.sign(np.concatenate(parts)).astype(np.int8)


def _elbow(robot: Robot, a: Array) -> tuple[str | None, float, bool]:
    origins, above = robot.screws(a).origins[1:], _elbows(robot, a[None])
    k, height = int(above[0][0]), float(above[1][0])
    if height == 0.0:
        return None, float("nan"), False
    return robot.mechanism().chain.names[1:][k], float(origins[k, 2]), height > 0.0


def _elbows(robot: Robot, a: Array) -> tuple[Index, Array]:
    """(N,) which joint after the first is the elbow, and how far it lies above the way [m].

    Above the line from shoulder to wrist, in their upright plane: a shoulder set to the side is no
    elbow. Zero where the arm is stretched, stands upright, or is too short to have one.
    """
    origins = robot.screws(a).origins[:, 1:]  # shoulder, …, wrist
    count, m = origins.shape[:2]
    if m < 3:
        return np.zeros(count, dtype=np.intp), np.zeros(count)
    way = origins[:, -1] - origins[:, 0]
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
    along = way / length
    up = np.array([0.0, 0.0, 1.0]) - along[:, 2:] * along
    flat = np.linalg.norm(up, axis=1)
    normal = up / np.maximum(flat, 1e-300)[:, None]
    above = ((origins - origins[:, :1]) * normal[:, None]).sum(axis=-1)
    k = np.argmax(np.abs(above), axis=1)
    height = above[np.arange(count), k]
    none = (np.abs(height) < BENT * length[:, 0]) | (flat < 1e-9)
    return k, np.where(none, 0.0, height)
