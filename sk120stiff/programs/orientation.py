"""Orientations as controllers state them, each from and to rotation matrices (N, 3, 3).

Every name is a convention of `scipy.spatial.transform.Rotation`: capital letters turn about the
axes as they come, small ones about the axes that stay.
"""

from __future__ import annotations

import warnings

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array


def fixed_xyz(rotation: Array) -> Array:
    """(N, 3) angles [deg] about the fixed x, y and z: R = R_z R_y R_x.

    FANUC's W P R (R-30iA/iB Operator's Manual: "W, P, R rotate about X, Y, Z of the frame") and
    Yaskawa's Rx Ry Rz (DX100 manual HW0482494 §4.3: "by rotating the coordinate system in the order
    of Rz, Ry and Rx").
    """
    return _angles(rotation, "xyz")


def from_fixed_xyz(angles: Array) -> Array:
    """The inverse of `fixed_xyz`."""
    return np.asarray(Rotation.from_euler("xyz", angles, degrees=True).as_matrix())


def kuka_abc(rotation: Array) -> Array:
    """(N, 3) A, B, C [deg]: about z, then the new y, then the new x: R = R_z(A) R_y(B) R_x(C).

    KUKA System Software 8.3, Operating and Programming Instructions, "Coordinate systems".
    """
    return _angles(rotation, "ZYX")


def from_kuka_abc(angles: Array) -> Array:
    """The inverse of `kuka_abc`."""
    return np.asarray(Rotation.from_euler("ZYX", angles, degrees=True).as_matrix())


def quaternion(rotation: Array) -> Array:
    """(N, 4) q1 (the real part) to q4, q1 ≥ 0: ABB's `orient`, RAPID reference 3HAC16581-1."""
    q = np.roll(Rotation.from_matrix(rotation).as_quat(), 1, axis=1)
    return np.asarray(np.where(q[:, :1] < 0.0, -q, q))


def from_quaternion(q: Array) -> Array:
    """The inverse of `quaternion`."""
    return np.asarray(Rotation.from_quat(np.roll(q, -1, axis=1)).as_matrix())


def _angles(rotation: Array, order: str) -> Array:
    with warnings.catch_warnings():  # at a middle angle of 90° one of the others is free: zero
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(Rotation.from_matrix(rotation).as_euler(order, degrees=True))
