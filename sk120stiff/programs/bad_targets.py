"""Targets that no robot should be sent to, found before a program is written."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import Refusal
from sk120stiff.robot import Robot
from sk120stiff.workspace import Compensation, LoadedPath

SINGULAR = 0.005  # ratio of singular values: about a degree from a stretched wrist
SLACK = 1e-9  # rad or m
UNCORRECTED = 1e-6  # m
TURNS = (0, 180, 90, -90)  # deg; none first, then half and quarter turns


def dexterity(robot: Robot, a: Array, frame: str | None = None) -> Array:
    """(N,) smallest over largest singular value of the Jacobian, lengths by the longest lever.

    Zero where some motion of the tool needs infinite joint speeds. An arm with fewer than six
    joints is judged by those that it has.
    """
    J = robot.jacobian(a, frame)
    turns = ~np.asarray(robot.prismatic)
    lever = np.linalg.norm(J[:, :3], axis=1)
    longest = np.max(lever * turns, axis=1, initial=0.0)
    scaled = J.copy()
    scaled[:, :3] /= np.where(longest > 0.0, longest, 1.0)[:, None, None]
    values = np.linalg.svd(scaled, compute_uv=False)
    k = min(6, robot.n) - 1
    return np.asarray(values[:, k] / np.maximum(values[:, 0], 1e-300))


def turned_over(robot: Robot, a: Array) -> Mask:
    """(N, n) on the way to which points which joint must go back by most of a turn.

    Its limits do not let it go on; in a straight line no robot can do that.
    """
    moves = np.abs(np.diff(a, axis=0, prepend=a[:1]))
    return np.asarray((moves > np.pi) & ~np.asarray(robot.prismatic))


def least_turn(
    robot: Robot,
    turned: Callable[[float], LoadedPath],
    find: Callable[[LoadedPath], Array],
) -> tuple[int, LoadedPath, Array]:
    """The turn of the tool about its own axis that a path needs [deg], the path and its joints.

    The first at which the whole path is reached and no joint has to pass a limit, else the first at
    which it is reached.

    Args:
        turned: The path with the tool turned by so much [rad].
        find: Joints (N, n) of a path; refuses where a point cannot be reached.

    Raises:
        Refusal: A point cannot be reached, however the tool is turned.
    """
    found: tuple[int, LoadedPath, Array] | None = None
    refused: Refusal | None = None
    for each in TURNS:
        path = turned(np.radians(each))
        try:
            a = find(path)
        except Refusal as error:
            refused = refused or error
            continue
        if not turned_over(robot, a).any():
            return each, path, a
        found = found or (each, path, a)
    if found is None:
        raise refused or Refusal("the arm cannot reach this path")
    return found


def refuse_bad_targets(
    robot: Robot, path: LoadedPath, found: Compensation, frame: str | None, *, straight: bool
) -> None:
    """Stop at the first target that is beyond a limit, not corrected, or singular.

    Args:
        straight: The program moves in straight lines, which singular poses do not allow.

    Raises:
        Refusal: There is one; its line is named.
    """
    a = found.a
    beyond = (a < robot.lower - SLACK) | (a > robot.upper + SLACK)
    ratio = dexterity(robot, a, frame)
    round_about = turned_over(robot, a)
    for k in range(len(a)):
        where = f"{path.table.path}, line {path.table.lines[k]}"
        if beyond[k].any():
            j = int(np.argmax(beyond[k]))
            factor, unit = (1e3, "mm") if robot.prismatic[j] else (180.0 / np.pi, "deg")
            raise Refusal(
                f"{robot.actuated[j]} would stand at {factor * a[k, j]:.3f} {unit}, beyond its "
                f"limits {factor * robot.lower[j]:.3f} .. {factor * robot.upper[j]:.3f}",
                where=where,
                remedy="Move the part (--frame), or choose another branch with --start.",
            )
        if found.reasons[k] and not found.after.distance[k] <= UNCORRECTED:
            raise Refusal(
                f"this point cannot be corrected: {found.reasons[k]}",
                where=where,
                remedy="Move the part (--frame), choose another branch with --start, or write a "
                "CSV file, which holds what remains.",
            )
        if straight and round_about[k].any():
            j = int(np.argmax(round_about[k]))
            before, here = np.degrees(a[k - 1 : k + 1, j])
            raise Refusal(
                f"{robot.actuated[j]} would have to pass its limit on the way there: from "
                f"{before:.1f} to {here:.1f} deg it can only go back",
                where=where,
                remedy="Turn the tool about its axis (--tool-rpy), choose another branch with "
                "--start, or move by joints with --by-joints.",
            )
        if straight and ratio[k] < SINGULAR:
            raise Refusal(
                f"the arm is singular there (ratio {ratio[k]:.2g} of singular values, below "
                f"{SINGULAR}): a straight move would need endless joint speeds",
                where=where,
                remedy="Move the part (--frame), turn the tool (--tool-rpy), choose another branch "
                "with --start, or move by joints with --by-joints.",
            )
