"""Cartesian stiffness and compliance of a point, from joint stiffness and Jacobian.

Compliance comes first: C_X = J (K_θ − K_C)⁻¹ Jᵀ exists at singular poses and for any number of
joints, while K_X = J⁻ᵀ (K_θ − K_C) J⁻¹ needs a square and regular J. K_C tells how a constant load
stiffens or softens the joints because the Jacobian turns with the arm: Alici & Shirinzadeh 2005,
eq. (9), for every load of force and moment and any chain.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import Refusal
from sk120stiff.robot import Screws
from sk120stiff.robot.rotations import cross_product


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


def complementary_stiffness(screws: Screws, wrench: ArrayLike, rows: Index | None = None) -> Array:
    """∂(Jᵀ W)/∂z for a force and a moment that are constant in base axes.

    With v and w the linear and angular parts of the unit twists of the chain joints, in chain
    order::

        K_C[i, j] = F · (w_min(i,j) × v_max(i,j)) + M · (w_j × w_i) [j < i only]

    and, for coordinates z that the joints follow by q(z) with G = dq/dz and H = d²q/dz²::

        K_C,z = Gᵀ K_C G + Σ_k τ_k H_k.

    Args:
        screws: Kinematics at the loaded point, batch shape (...).
        wrench: (..., 6) force [N] and moment [N·m] at that point, base axes.
        rows: (r,) coordinates whose rows alone are wanted; all n without.

    Returns:
        (..., r, n) [N·m/rad]. The part of the force is symmetric, that of a moment is not: a moment
        about fixed axes has no potential. Symmetrise before any statement about definiteness.
    """
    load = np.asarray(wrench, dtype=float)
    if not load.any():
        n = screws.first.shape[-1]
        batch = np.broadcast_shapes(screws.position.shape[:-1], load.shape[:-1])
        return np.zeros((*batch, n if rows is None else len(rows), n))
    force, moment = load[..., None, :3], load[..., None, 3:]
    joints = _moved(screws.first, rows)
    w = screws.angular
    K_C = _symmetric_rows(cross_product(force, w), screws.linear, joints)  # (..., j, m)
    if moment.any():
        turned = w[..., joints, :] @ np.swapaxes(cross_product(moment, w), -1, -2)
        K_C = K_C + np.where(joints[:, None] > np.arange(w.shape[-2]), turned, 0.0)
    bent = None
    if screws.second is not None:
        bent = screws.second.contracted(screws.joint_torques(load), screws.first.shape[-1])
    return _in_coordinates(K_C, screws.first, joints, rows, bent)


def follower_stiffness(screws: Screws, wrench: ArrayLike, rows: Index | None = None) -> Array:
    """Jᵀ ∂W/∂z for a force and a moment that turn with the end frame.

    With v_i, w_i the parts of the Jacobian's columns, on top of `complementary_stiffness`::

        K_F[i, j] = v_i · (w_j × F) + w_i · (w_j × M)

    Args:
        screws: Kinematics at the loaded point, batch shape (...).
        wrench: (..., 6) force [N] and moment [N·m] at that point, base axes.
        rows: (r,) coordinates whose rows alone are wanted; all n without.

    Returns:
        (..., r, n) [N·m/rad]; not symmetric, as such a load has no potential.
    """
    load = np.asarray(wrench, dtype=float)
    J = np.swapaxes(screws.jacobian, -1, -2)  # (..., n, 6)
    w = J[..., 3:]
    turning = [cross_product(w, load[..., None, part]) for part in (slice(3), slice(3, 6))]
    near = J if rows is None else J[..., rows, :]
    return np.asarray(near @ np.swapaxes(np.concatenate(turning, axis=-1), -1, -2))


def gravity_stiffness(screws: Screws, gravity: ArrayLike, rows: Index | None = None) -> Array:
    """∂τ_g/∂z (..., r, n) [N·m/rad]: K_C of the arm's own weight, spread over its links.

    The formula of `complementary_stiffness` with v_max replaced by what the joint max(i,j) carries.

    Args:
        screws: Kinematics, batch shape (...), of an arm with masses; zero of one without.
        gravity: (3,) acceleration in base axes [m/s²].
        rows: (r,) coordinates whose rows alone are wanted; all n without.
    """
    if screws.carried is None:
        n = screws.first.shape[-1]
        return np.zeros((*screws.position.shape[:-1], n if rows is None else len(rows), n))
    joints = _moved(screws.first, rows)
    g = np.asarray(gravity, dtype=float)
    K_g = _symmetric_rows(cross_product(g, screws.angular), screws.carried, joints)
    bent = None
    if screws.second is not None:
        bent = screws.second.contracted(screws.carried @ g, screws.first.shape[-1])
    return _in_coordinates(K_g, screws.first, joints, rows, bent)


def symmetric_part(matrix: Array) -> Array:
    """(M + Mᵀ)/2, the part of a stiffness that leaves no work over on a closed path."""
    return 0.5 * (matrix + np.swapaxes(matrix, -1, -2))


def _moved(G: Array, rows: Index | None) -> Index:
    """The joints that some coordinates move, all of them without `rows`."""
    if rows is None:
        return np.arange(G.shape[-2])
    return np.flatnonzero(G[..., rows].any(axis=(*range(G.ndim - 2), -1)))


def _symmetric_rows(near: Array, far: Array, rows: Index) -> Array:
    """Rows (..., r, m) of the symmetric matrix whose upper triangle is near_i · far_j."""
    above = near[..., rows, :] @ np.swapaxes(far, -1, -2)
    if len(rows) == far.shape[-2]:
        below = np.swapaxes(above, -1, -2)
    else:
        below = far[..., rows, :] @ np.swapaxes(near, -1, -2)
    return np.where(rows[:, None] <= np.arange(far.shape[-2]), above, below)


def _in_coordinates(
    K: Array, G: Array, joints: Index, rows: Index | None, bent: Array | None
) -> Array:
    """Rows of Gᵀ K G (..., r, n) from rows K (..., j, m) of some joints, plus those of `bent`.

    Where joints only stand in another order than coordinates, that is done by index.
    """
    wanted = np.arange(G.shape[-1]) if rows is None else rows
    where = _order(G)
    if where is not None:
        at, by = where
        place = np.searchsorted(joints, at[wanted])
        out = K[..., place[:, None], at] * np.outer(by[wanted], by)
    else:
        left = np.swapaxes(G[..., joints, :][..., wanted], -1, -2)
        out = (left @ K) @ G
    return np.asarray(out if bent is None else out + bent[..., wanted, :])


def _order(G: Array) -> tuple[Index, Array] | None:
    """The joint that each coordinate moves, and how far; None where some move several."""
    if G.ndim != 2 or G.shape[0] != G.shape[1] or not len(G):
        return None
    there = G != 0.0
    if not ((there.sum(axis=0) == 1).all() and (there.sum(axis=1) == 1).all()):
        return None
    row = there.argmax(axis=0)
    return row, G[row, np.arange(len(row))]
