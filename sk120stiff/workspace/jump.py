"""Why no posture passes a path: a point out of reach, or the jump of a joint between two points.

Either the points lie too far from each other, which inverse kinematics in small steps shows, or the
branch ends: at a joint limit, at a singular pose.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.workspace.inverse import solve_inverse
from sk120stiff.workspace.judge import Judge, PathTask
from sk120stiff.workspace.reach import why_unreached

PIECES, FINE = 32, 1000  # of a move that is looked at again in small steps, and of the whole path


def refuse_jump(judge: Judge, starts: Array, placement: Array) -> None:
    """Name the points between which a joint jumps, if some posture passes but for that.

    Args:
        judge: By which no posture passes.
        starts, placement: (k, n) and (k, 6) of these postures.

    Raises:
        Refusal: Between which points, which joint, and whether more points would do.
    """
    free = replace(judge, largest_step=np.inf)(starts, placement)
    through = np.flatnonzero(np.isfinite(free.objective))
    path, arm = judge.path, judge.arm
    if not len(through) or path.count < 2:
        return
    moves = np.abs(np.diff(free.path[through], axis=1))  # (k, N - 1, n)
    best = moves[np.argmin(moves.max(axis=(1, 2)))]
    point, joint = (int(k) for k in np.unravel_index(np.argmax(best), best.shape))
    apart = 1e3 * np.linalg.norm(path.position[point + 1] - path.position[point])
    value, unit = (1e3, "mm") if arm.slides[joint] else (180.0 / np.pi, "deg")
    what = (
        f"between point {point + 1} and point {point + 2}, {apart:.0f} mm apart, "
        f"{arm.joints[joint]} jumps by {value * best[point, joint]:.0f} {unit} in the best of "
        f"{len(through)} postures that reach all {path.count} points"
    )
    pieces = min(PIECES, FINE // (path.count - 1))
    if pieces > 1:
        fine = replace(judge, path=finer(path, pieces))
        if np.isfinite(fine(free.path[through, 0], placement[through]).objective).any():
            raise Refusal(
                f"points lie too far from each other: {what}",
                remedy=f"Put points between them: with {pieces - 1} in every move it can be "
                "passed in one branch.",
            )
    raise Refusal(
        f"{what}: no branch goes on there",
        remedy="Turn the tool another way or leave its rotation free (--tool-axis), move or turn "
        "the part (--place), or divide the path there.",
    )


def refuse_unreached(judge: Judge, starts: Array, placement: Array) -> None:
    """Name the first point that no posture reaches, if there is one.

    Raises:
        Refusal: Which point, and whether reach or a joint's limit is what stands in the way.
    """
    turn, shift = judge.moves(placement)
    for point in range(judge.path.count):
        target = judge.task(point, turn, shift)
        if solve_inverse(judge.arm, target, starts).found.any():
            continue
        raise Refusal(
            f"point {point + 1} cannot be reached: "
            + why_unreached(judge.arm, target.rows(np.array([0]))),
            remedy="Move the point or the part (--place), leave the tool's rotation free "
            "(--tool-axis), or lower the margins.",
        )


def finer(path: PathTask, pieces: int) -> PathTask:
    """The same straight way with every move of `PathTask.each` in so many pieces."""
    N = path.count
    at = np.linspace(0.0, N - 1, pieces * (N - 1) + 1)
    here, there = np.floor(at).astype(int), np.ceil(at).astype(int)
    share = (at - here)[:, None]
    axis, rotation = path.axis, path.rotation
    if axis is not None:
        axis = axis[here] * (1.0 - share) + axis[there] * share
        axis = axis / np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-9)
    if rotation is not None:
        rotation = Slerp(np.arange(N), Rotation.from_matrix(rotation))(at).as_matrix()
    return replace(
        path,
        position=path.position[here] * (1.0 - share) + path.position[there] * share,
        axis=axis,
        rotation=rotation,
        wrench=path.wrench[there],
        direction=None if path.direction is None else path.direction[there],
    )
