"""K_C: how a constant load stiffens or softens the joints because the Jacobian turns with the arm.

Alici & Shirinzadeh 2005, eq. (9), for every load of force and moment and any chain.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.robot import Screws


def complementary_stiffness(screws: Screws, wrench: ArrayLike) -> Array:
    """∂(Jᵀ W)/∂z for a force and a moment that are constant in base axes.

    With v and w the linear and angular parts of the unit twists of the chain joints, in chain
    order::

        K_C[i, j] = F · (w_min(i,j) × v_max(i,j)) + M · (w_j × w_i) [j < i only]

    and, for coordinates z that the joints follow by q(z) with G = dq/dz and H = d²q/dz²::

        K_C,z = Gᵀ K_C G + Σ_k τ_k H_k.

    Args:
        screws: Kinematics at the loaded point, batch shape (...).
        wrench: (..., 6) force [N] and moment [N·m] at that point, base axes.

    Returns:
        (..., n, n) [N·m/rad]. The part of the force is symmetric, that of a moment is not: a moment
        about fixed axes has no potential. Symmetrise before any statement about definiteness.
    """
    load = np.asarray(wrench, dtype=float)
    if not load.any():
        n = screws.first.shape[-1]
        batch = np.broadcast_shapes(screws.position.shape[:-1], load.shape[:-1])
        return np.zeros((*batch, n, n))
    force, moment = load[..., None, :3], load[..., None, 3:]
    v, w = screws.linear, screws.angular
    upper = np.triu(np.cross(force, w) @ np.swapaxes(v, -1, -2))
    K_C = upper + np.swapaxes(np.triu(upper, 1), -1, -2)  # (..., m, m)
    if moment.any():
        turned = np.triu(np.cross(moment, w) @ np.swapaxes(w, -1, -2), 1)
        K_C = K_C + np.swapaxes(turned, -1, -2)
    G = screws.first
    K_Cz = _congruent(K_C, G)
    if screws.second is not None:
        torques = screws.joint_torques(load)
        K_Cz = K_Cz + screws.second.contracted(torques, G.shape[-1])
    return np.asarray(K_Cz)


def gravity_stiffness(screws: Screws, gravity: Array) -> Array:
    """∂τ_g/∂z (..., n, n) [N·m/rad]: K_C of the arm's own weight, spread over its links.

    The formula of `complementary_stiffness` with v_max replaced by what the joint max(i,j) carries.
    """
    if screws.carried is None:
        n = screws.first.shape[-1]
        return np.zeros((*screws.position.shape[:-1], n, n))
    upper = np.triu(np.cross(gravity, screws.angular) @ np.swapaxes(screws.carried, -1, -2))
    K_g = upper + np.swapaxes(np.triu(upper, 1), -1, -2)
    G = screws.first
    K_gz = _congruent(K_g, G)
    if screws.second is not None:
        K_gz = K_gz + screws.second.contracted(screws.carried @ gravity, G.shape[-1])
    return np.asarray(K_gz)


def symmetric_part(matrix: Array) -> Array:
    """(M + Mᵀ)/2, the part of a stiffness that leaves no work over on a closed path."""
    return 0.5 * (matrix + np.swapaxes(matrix, -1, -2))


def _congruent(K: Array, G: Array) -> Array:
    """Gᵀ K G (..., n, n); where joints only stand in another order than coordinates, by index."""
    if G.ndim == 2 and G.shape[0] == G.shape[1]:
        there = G != 0.0
        if (there.sum(axis=0) == 1).all() and (there.sum(axis=1) == 1).all():
            row = there.argmax(axis=0)
            by = G[row, np.arange(len(row))]
            return np.asarray(K[..., row[:, None], row] * np.outer(by, by))
    return np.asarray(np.swapaxes(G, -1, -2) @ K @ G)
