"""Rotation matrices, vectors and angles, joint motions, and how small changes of them turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array

_SMALL = 1e-4  # rad, below which series replace the closed form


def crossed(vector: ArrayLike) -> Array:
    """(..., 3, 3) matrix of the cross product v × ."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def cross_product(a: Array, b: Array) -> Array:
    """(..., 3) cross products of vectors (..., 3), as `np.cross`, in a third of its time."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    np.subtract(y * w, z * v, out=out[..., 0])
    np.subtract(z * u, x * w, out=out[..., 1])
    np.subtract(x * v, y * u, out=out[..., 2])
    return out


def rotation_of(vector: Array) -> Array:
    """(..., 3, 3) of a rotation vector (..., 3) [rad]."""
    from scipy.spatial.transform import Rotation  # slow to import

    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def rotation_vector(rotation: Array) -> Array:
    """(..., 3) axis times angle of rotations (..., 3, 3) [rad], angle at most π."""
    skew = np.stack(
        [
            rotation[..., 2, 1] - rotation[..., 1, 2],
            rotation[..., 0, 2] - rotation[..., 2, 0],
            rotation[..., 1, 0] - rotation[..., 0, 1],
        ],
        axis=-1,
    )
    sine = 0.5 * np.linalg.norm(skew, axis=-1)
    cosine = 0.5 * (np.trace(rotation, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    # Near half a turn the skew part vanishes; R + I = 2 u uᵀ there, and its longest column is u.
    symmetric = rotation + np.swapaxes(rotation, -1, -2) + 2.0 * np.eye(3)
    longest = np.argmax(np.linalg.norm(symmetric, axis=-2), axis=-1)
    column = np.take_along_axis(symmetric, longest[..., None, None], axis=-1)[..., 0]
    column = column / np.maximum(np.linalg.norm(column, axis=-1, keepdims=True), 1e-300)
    column = np.where((column * skew).sum(-1, keepdims=True) < 0.0, -column, column)
    usual = skew / np.maximum(2.0 * sine, 1e-300)[..., None]
    near_half = (sine < 1e-6) & (cosine < 0.0)
    unit = np.where(near_half[..., None], column, usual)
    return np.where((angle < 1e-12)[..., None], 0.5 * skew, angle[..., None] * unit)


def rotation_from_rpy(rpy: Array) -> Array:
    """(3, 3) rotation for fixed-axis roll, pitch, yaw [rad]: R_z(yaw) R_y(pitch) R_x(roll)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_from_rotation(R: Array) -> Array:
    """(3,) roll, pitch, yaw [rad] with R = R_z(yaw) R_y(pitch) R_x(roll).

    Any yaw is followed by the roll and pitch that complete it, so gimbal lock costs no accuracy.
    """
    yaw = np.arctan2(R[1, 0], R[0, 0])
    s, c = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    pitch = np.arctan2(-R[2, 0], c * R[0, 0] + s * R[1, 0])
    return np.array([roll, pitch, yaw])


def frame_about(axis: Array) -> Array:
    """(3, 3) a rotation whose third column is the unit vector `axis` (3,)."""
    x = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def homogeneous(position: ArrayLike, rotation: ArrayLike | None = None) -> Array:
    """(4, 4) of a position (3,) and a rotation (3, 3)."""
    T = np.eye(4)
    T[:3, 3] = position
    if rotation is not None:
        T[:3, :3] = rotation
    return T


def joint_motion(axis: Array, revolute: bool, value: float) -> Array:
    """(4, 4) motion of a joint by `value` [rad or m] about or along `axis` (3,)."""
    T = np.eye(4)
    if revolute:
        cross = crossed(axis)
        T[:3, :3] += np.sin(value) * cross + (1.0 - np.cos(value)) * (cross @ cross)
    else:
        T[:3, 3] = value * axis
    return T


def left_jacobian(vector: Array) -> Array:
    """(3, 3) J_l with exp(r + dr) = exp(J_l dr) exp(r) (Chirikjian 2012, §10.6.1)."""
    angle = float(np.linalg.norm(vector))
    K = crossed(vector)
    if angle < _SMALL:
        return np.asarray(np.eye(3) + 0.5 * K + K @ K / 6.0)
    first = (1.0 - np.cos(angle)) / angle**2
    second = (angle - np.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + first * K + second * K @ K)
