"""Finite rotations and rigid placements as plain arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def skew(v: Array) -> Array:
    """Matrix (3, 3) with skew(v) @ u = v x u."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def turn(axis: Array, angle: Array) -> Array:
    """Rotations (N, 3, 3) about one unit axis (3,) by the angles (N,) [rad] (Rodrigues)."""
    angle = np.atleast_1d(angle)
    k = skew(axis)
    half = np.sin(0.5 * angle)
    # 1 - cos written as 2 sin^2 keeps full precision for the tiny angles of elastic hinges
    return (
        np.eye(3) + np.sin(angle)[:, None, None] * k + (2.0 * half * half)[:, None, None] * (k @ k)
    )


def exponential(vector: Array) -> Array:
    """Rotation (3, 3) of one rotation vector (3,) [rad]."""
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        return np.eye(3)
    return turn(np.asarray(vector, float) / size, np.array([size]))[0]


def from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """URDF's fixed-axis roll, pitch, yaw as a rotation (3, 3)."""
    about_x, about_y, about_z = np.eye(3)
    return (
        turn(about_z, np.array([yaw]))[0]
        @ turn(about_y, np.array([pitch]))[0]
        @ turn(about_x, np.array([roll]))[0]
    )


def to_rpy(rotation: Array) -> tuple[float, float, float]:
    """Inverse of `from_rpy` away from pitch = 90 deg."""
    pitch = -np.arcsin(np.clip(rotation[2, 0], -1.0, 1.0))
    roll = np.arctan2(rotation[2, 1], rotation[2, 2])
    yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    return float(roll), float(pitch), float(yaw)


def placement(xyz: Array | tuple[float, float, float], rotation: Array | None = None) -> Array:
    """Homogeneous transform (4, 4)."""
    out = np.eye(4)
    out[:3, 3] = xyz
    if rotation is not None:
        out[:3, :3] = rotation
    return out


def normals(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors normal to `axis` and to each other, along coordinate axes if possible."""
    order = np.argsort(np.abs(axis))
    first = np.eye(3)[order[0]] if axis[order[0]] == 0.0 else np.cross(axis, np.eye(3)[order[0]])
    first = first / np.linalg.norm(first)
    second = np.cross(axis, first)
    return first, second / np.linalg.norm(second)
