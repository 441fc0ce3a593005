"""Of readings of the same poses in two files: was the tracker moved in between, or the arm bent?

A load bends the arm from pose to pose as its springs and its foundation yield; a tracker that was
moved shifts and turns all positions together.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Index, lengths_of
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import crossed

# Of the squares that springs leave: a move takes off more, or there was none. Of sag alone, with a
# payload 0.1 m aside and gears that harden, one in 200 looks moved at poses close together, where
# at one half 13 % do; of pushes of 1 mm beside sag of 0.7 mm all but 2 % are seen.
LESS = 0.35
SURELY = 8.0  # F of the six numbers of a move: noise reaches 4 once in a hundred times
LEAST = 5e-5  # m; a tracker drifts by that much where nobody moved it
SPARE = 12  # numbers more than unknowns that tell at all


def moved(
    draft: Draft, rows: Index, others: Index, poses: Array, robot: Robot, found: Registration
) -> float | None:
    """By how much positions were moved as a whole between two files [m]; 0 where a load explains
    as much, and None where they share too few poses to tell.

    Args:
        draft: The readings.
        rows, others: (A,) and (B,) rows of the one file and of the other.
        poses: (N,) number of the pose of every row.
        robot: The arm that was read.
        found: It laid onto all positions in one frame.
    """
    shared = np.intersect1d(poses[rows], poses[others])
    if not len(shared):
        return None
    first = np.array([rows[poses[rows] == pose][0] for pose in shared])
    apart = np.array([
        np.median(draft.measured[others[poses[others] == pose]], axis=0)
        - np.median(draft.measured[rows[poses[rows] == pose]], axis=0)
        for pose in shared
    ])  # fmt: skip
    apart = apart @ found.turns[0]  # in axes of the base
    bent, shifted = _columns(robot, draft.joints.values[first], found.marker)
    spare = apart.size - bent.shape[1] - shifted.shape[1]
    if spare < SPARE:
        return None
    by_load = _left(bent, apart.ravel())[0]
    by_both, solved = _left(np.hstack([bent, shifted]), apart.ravel())
    move = (shifted @ solved[bent.shape[1] :]).reshape(-1, 3)
    size = float(np.sqrt((move**2).sum(axis=1).mean()))
    sure = by_load - by_both > SURELY * 6.0 * by_both / spare
    return size if size > LEAST and by_both < LESS * by_load and sure else 0.0


def _columns(robot: Robot, q: Array, marker: Array) -> tuple[Array, Array]:
    """(3P, n + 2) how a weight at the marker moves it by each joint's spring and by the rocking of
    the foundation, and (3P, 6) how a move of the tracker does; of unit size, or zero.
    """
    screws = robot.screws(q, point=marker)
    J, at = screws.jacobian[:, :3], screws.position
    down = robot.gravity_in_base / np.linalg.norm(robot.gravity_in_base)
    springs = J * np.einsum("pik,i->pk", J, down)[:, None, :]
    tilt = -crossed(at)  # (P, 3, 3) how a turn about each axis of the base moves the marker
    side = np.linalg.svd(down[None])[2][1:].T  # (3, 2) level axes
    rocking = np.einsum("pij,jk->pik", tilt, side)
    rocking = rocking * np.einsum("pik,i->pk", rocking, down)[:, None, :]
    bent = np.concatenate([springs, rocking], axis=2).reshape(3 * len(q), -1)
    moves = np.concatenate([tilt, np.tile(np.eye(3), (len(q), 1, 1))], axis=2)
    return _of_unit_size(bent), _of_unit_size(moves.reshape(3 * len(q), -1))


def _of_unit_size(columns: Array) -> Array:
    size = lengths_of(columns)
    return np.asarray(columns / np.where(size > 0.0, size, 1.0))


def _left(columns: Array, values: Array) -> tuple[float, Array]:
    solved = np.asarray(np.linalg.lstsq(columns, values, rcond=1e-9)[0], dtype=np.float64)
    return float(((values - columns @ solved) ** 2).sum()), solved
