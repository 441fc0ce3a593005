"""Work of the load and energy in the springs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.robot import Mechanism, Screws
from sk120stiff.stiffness.cartesian import complementary_stiffness
from sk120stiff.stiffness.equilibrium import equilibrium, linear_springs


@dataclass(frozen=True, eq=False)
class PaperWork:
    """The second-order works of eq. (14) and (15), each (...,) [J].

    Attributes:
        cartesian: Fᵀ ΔX + ½ ΔXᵀ K_X ΔX with the enhanced K_X.
        joint_enhanced: Γᵀ Δθ + ½ Δθᵀ (K_θ − K_C) Δθ: equal to `cartesian` by congruence.
        joint_conventional: Γᵀ Δθ + ½ Δθᵀ K_θ Δθ: what the paper calls the conventional formulation.
    """

    cartesian: Array
    joint_enhanced: Array
    joint_conventional: Array


def paper_work(
    screws: Screws, stiffness: Array, force: ArrayLike, displacement: Array
) -> PaperWork:
    """Works of eq. (14) and (15) for a displacement of the point.

    Args:
        screws: Kinematics at the unloaded pose, n = 3 coordinates with springs.
        stiffness: (3,) springs [N·m/rad].
        force: (..., 3) force at the point, base axes [N].
        displacement: (..., 3) displacement of the point [m].
    """
    load = np.concatenate([np.asarray(force, dtype=float), np.zeros_like(force)], axis=-1)
    J = screws.linear_jacobian
    K_theta = np.diag(stiffness)
    K_C = complementary_stiffness(screws, load)
    inverse = np.linalg.inv(J)
    K_X = np.swapaxes(inverse, -1, -2) @ (K_theta - K_C) @ inverse
    d_theta = (inverse @ displacement[..., None])[..., 0]
    torques = screws.torques(load)
    linear = (load[..., :3] * displacement).sum(-1)
    turned = (torques * d_theta).sum(-1)
    return PaperWork(
        cartesian=linear + 0.5 * quadratic(K_X, displacement),
        joint_enhanced=turned + 0.5 * quadratic(K_theta - K_C, d_theta),
        joint_conventional=turned + 0.5 * quadratic(K_theta, d_theta),
    )


def loading_balance(
    mechanism: Mechanism,
    a: ArrayLike,
    wrench: ArrayLike,
    stiffness: ArrayLike,
    point: Array | None = None,
    *,
    steps: int = 24,
) -> tuple[Array, Array]:
    """Work of a slowly growing load along its path, and the energy stored at its end.

    The work ∫ F · dX is integrated over load factors by Gauss–Legendre quadrature at exact
    equilibrium; the energy is ½ Σ K (θ − θ_0)². They agree for any conservative load (pure forces),
    whatever its size.

    Returns:
        work, energy: (...,) each [J].
    """
    load = np.asarray(wrench, dtype=float)
    springs = np.asarray(stiffness, dtype=float)
    start = np.asarray(a, dtype=float)
    law = linear_springs(springs)
    nodes, weights = np.polynomial.legendre.leggauss(steps)
    work = np.zeros(np.broadcast_shapes(load.shape[:-1], start.shape[:-1]))
    identity = np.eye(len(springs))
    for node, weight in zip(0.5 * (nodes + 1.0), 0.5 * weights, strict=True):
        rest = equilibrium(mechanism, start, node * load, law, point=point)
        # dz/dλ from z = z_0 + C λ Jᵀ W, then W · J dz/dλ
        full = rest.screws.torques(load)
        rate = np.linalg.solve(
            identity - rest.compliance @ rest.K_C, (rest.compliance @ full[..., None])
        )[..., 0]
        work = work + weight * node * (full * rate).sum(-1)
    end = equilibrium(mechanism, start, load, law, point=point)
    soft = np.isfinite(springs)
    stretch = (end.z - start)[..., soft]
    return work, 0.5 * (springs[soft] * stretch**2).sum(-1)


def quadratic(matrix: Array, vector: Array) -> Array:
    """(...,) xᵀ M x."""
    return np.asarray(np.einsum("...i,...ij,...j->...", vector, matrix, vector))
