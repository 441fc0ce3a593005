"""Which row of the scratch memory holds what."""

from __future__ import annotations

from sk120stiff.stiffness.kernel.compiled import part

BLOCK = 256

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
