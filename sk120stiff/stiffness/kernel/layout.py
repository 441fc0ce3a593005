"""Which row of the scratch memory holds what."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel.compiled import part
from sk120stiff.stiffness.kernel.folding import Fold

BLOCK = 256
PAGE = 4096  # bytes on which the memory begins: numbers that straddle cache lines cost a fifth

ROTATION = 0  # 9 rows: columns of the rotation reached so far
POSITION = 9  # 3 rows: and the position; at the end that of the point
VALUE = 12  # value of the joint at hand
SINE = 13
COSINE = 14
LOAD = 15  # 6 rows: force and moment
TURNED = 21  # 6 rows: F × w and M × w of the joint at hand
TENSOR = 27  # 9 rows: a 3×3 matrix, compliance or J Jᵀ
EIGENVALUE = 36  # 3 rows
EIGENVECTOR = 39  # 9 rows
SAFE = 48  # how far K_θ − K_C is from losing definiteness
INVERSE = 49  # 1 / pivot
FACTOR = 50
CHANGE = 51  # of a coordinate in the last step
DEFLECTION = 52  # 3 rows
FREE = 55  # rows whose number depends on the robot begin here


@part
def at(row: int) -> int:
    """Where a row begins. The mask tells the compiler that this is never negative."""
    return (row * BLOCK) & 0x7FFFFFFF


class Scratch(NamedTuple):
    """Memory of one thread, and where its rows begin whose number depends on the robot.

    Attributes:
        x: All rows of a block.
        A, own, B: (s, s), (s, s) and (s, max(s, 4)) of one pose.
        axes, levers, carried: 3 rows for each joint.
        pose: A row for each coordinate, or for each joint where the motion is given.
        factors, bends: What is `Given`.
        bent: A row for each soft coordinate of an arm that weighs.
        columns: 3 rows for each column of J.
        springs, K_g, K_C, L: Lower triangles of matrices of the soft coordinates.
        skew: Strictly lower triangle of the skew part of K_C.
        y: 3 rows for each soft coordinate.
    """

    x: Array
    A: Array
    own: Array
    B: Array
    axes: int
    levers: int
    carried: int
    pose: int
    factors: int
    bends: int
    bent: int
    columns: int
    springs: int
    K_g: int
    K_C: int
    L: int
    skew: int
    y: int


def scratch(fold: Fold) -> Scratch:
    """Memory for poses of a fold."""
    m, n, s = len(fold.kind), fold.n, len(fold.soft)
    triangle, w, g = s * (s + 1) // 2, int(fold.weighs), int(fold.given)
    joints = (3 * m, 3 * m, 3 * m * w, fold.pose_map.shape[1])
    motion = (g * len(fold.column_joint), g * len(fold.bend), s * w, 3 * n)
    matrices = (triangle, triangle * w, triangle, triangle, triangle - s, 3 * s)
    begins = np.cumsum([FREE, *joints, *motion, *matrices]).tolist()
    return Scratch(
        _on_a_page(begins[-1] * BLOCK),
        np.empty((s, s)),
        np.empty((s, s)),
        np.empty((s, max(s, 4))),
        *begins[:-1],
    )


def _on_a_page(count: int) -> Array:
    """(count,) zeros that begin on a page."""
    memory = np.zeros(count + PAGE // 8)
    first = -memory.ctypes.data % PAGE // 8
    return memory[first : first + count]
