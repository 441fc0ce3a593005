"""Cartesian stiffness and compliance of a point, from joint stiffness and Jacobian.

Compliance comes first: C_X = J (K_θ − K_C)⁻¹ Jᵀ exists at singular poses and for any number of
joints, while K_X = J⁻ᵀ (K_θ − K_C) J⁻¹ needs a square and regular J.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal


def cartesian_compliance(jacobian: Array, joint_stiffness: Array) -> Array:
    """C_X = J K⁻¹ Jᵀ.

    Args:
        jacobian: (..., d, n); d = 3 for a position, 6 for position and orientation.
        joint_stiffness: (..., n, n) K_θ (conventional) or K_θ − K_C (enhanced) [N·m/rad].

    Returns:
        (..., d, d) [m/N; rad/N; rad/(N·m)].

    Raises:
        Refusal: The joint stiffness is singular: the load is exactly critical.
    """
    turned = np.swapaxes(jacobian, -1, -2)
    shape = np.broadcast_shapes(joint_stiffness.shape[:-2], turned.shape[:-2])
    stiffness = np.broadcast_to(joint_stiffness, (*shape, *joint_stiffness.shape[-2:]))
    turned = np.broadcast_to(turned, (*shape, *turned.shape[-2:]))  # a stack of matrices
    try:
        return np.asarray(jacobian @ np.linalg.solve(stiffness, turned))
    except np.linalg.LinAlgError as error:
        raise Refusal(
            "K_θ − K_C is singular: this load is exactly critical and the deflection has no bound",
            remedy="Lower the load.",
        ) from error


def cartesian_stiffness(jacobian: Array, joint_stiffness: Array) -> Array:
    """K_X = J⁻ᵀ K J⁻¹, eq. (8) with K = K_θ and eq. (10) with K = K_θ − K_C.

    Args:
        jacobian: (..., n, n): as many task directions as coordinates.
        joint_stiffness: (..., n, n) [N·m/rad].

    Returns:
        (..., n, n) [N/m; N/rad; N·m/rad], filled with NaN where J is singular (no stiffness exists
        there: along the lost direction the arm is infinitely stiff).
    """
    rows, columns = jacobian.shape[-2:]
    if rows != columns:
        raise ValueError(f"K_X needs a square Jacobian, not {rows}×{columns}; use compliance")
    scale = np.linalg.norm(jacobian, axis=(-2, -1))
    smallest = np.linalg.svd(jacobian, compute_uv=False)[..., -1]
    regular = smallest > 1e-12 * np.maximum(scale, 1e-300)
    safe = np.where(regular[..., None, None], jacobian, np.eye(rows))
    inverse = np.linalg.inv(safe)
    K_X = np.swapaxes(inverse, -1, -2) @ joint_stiffness @ inverse
    return np.where(regular[..., None, None], K_X, np.nan)


def spring_matrix(stiffness: Array) -> Array:
    """(..., n, n) diagonal K_θ from (..., n) spring values [N·m/rad or N/m]."""
    return stiffness[..., :, None] * np.eye(stiffness.shape[-1])
