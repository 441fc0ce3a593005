"""What a model and a regression at every single pose leave of a whitened gap together."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.measurements.poses import rows_by_label

# Length of a unit column beyond the regression below which it tells nothing: what a parameter does
# within a pose beyond lines is of second order, and the lines have fixed the parameter long before.
IMITATED = 0.01
FAINT = 1e-9  # share of a column left beside the base below which it is rounding


def orthonormal(matrix: Array, keep: float = 1e-12) -> Array:
    """(R, rank) orthonormal basis of the column space; columns are scaled to one length first.

    Columns shorter than `keep` times the longest are dropped.
    """
    norms = np.linalg.norm(matrix, axis=0)
    kept = matrix[:, norms > keep * max(float(norms.max(initial=0.0)), 1e-300)]
    if not kept.shape[1]:
        return np.zeros((len(matrix), 0))
    U, singular, _ = np.linalg.svd(kept / np.linalg.norm(kept, axis=0), full_matrices=False)
    return np.asarray(U[:, singular > 1e-8 * singular[0]])


def beside(Q: Array, block: Array) -> Array:
    """(M, p) what orthonormal columns do not make up of others; zero where that is rounding."""
    before = np.linalg.norm(block, axis=0)
    for _ in range(2):
        block = block - Q @ (Q.T @ block)
    block[:, np.linalg.norm(block, axis=0) <= FAINT * before] = 0.0
    return block


def left_over(white: Array, inside: Array, local: Array, group: Index) -> tuple[float, int]:
    """Sum of squares that is left, and the rank of what was taken out.

    Args:
        white: (R,) whitened gap.
        inside: (R, k) orthonormal basis of what the model's parameters can do.
        local: (R, m) whitened columns that are free at every pose.
        group: (R,) pose of each row.
    """
    left, columns, rank = white.copy(), inside.copy(), 0
    for rows in rows_by_label(group):
        block = orthonormal(local[rows])
        left[rows] -= block @ (block.T @ left[rows])
        columns[rows] -= block @ (block.T @ columns[rows])
        rank += block.shape[1]
    own = orthonormal(columns[:, np.linalg.norm(columns, axis=0) > IMITATED])
    left -= own @ (own.T @ left)
    return float(left @ left), rank + own.shape[1]
