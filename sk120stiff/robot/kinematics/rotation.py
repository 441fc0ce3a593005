"""Rotation vectors, rotation matrices, and how small changes of the one turn the other."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array

_SMALL = 1e-4  # rad, below which series replace the closed form


def rotation_of(vector: Array) -> Array:
    """(..., 3, 3) of a rotation vector (..., 3) [rad]."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def vector_of(matrix: Array) -> Array:
    """(..., 3) rotation vector [rad] of a rotation matrix."""
    return np.asarray(Rotation.from_matrix(matrix).as_rotvec())


def crossed(vector: Array) -> Array:
    """(..., 3, 3) matrix of the cross product v × ."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def left_jacobian(vector: Array) -> Array:
    """(3, 3) J_l with exp(r + dr) = exp(J_l dr) exp(r) (Chirikjian 2012, §10.6.1)."""
    angle = float(np.linalg.norm(vector))
    K = crossed(vector)
    if angle < _SMALL:
        return np.asarray(np.eye(3) + 0.5 * K + K @ K / 6.0)
    first = (1.0 - np.cos(angle)) / angle**2
    second = (angle - np.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + first * K + second * K @ K)
