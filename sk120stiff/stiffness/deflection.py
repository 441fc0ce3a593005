"""Deflection of a loaded point by three formulas, from crude to exact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import Refusal
from sk120stiff.robot import Mechanism, Screws
from sk120stiff.stiffness.cartesian import cartesian_compliance, spring_matrix
from sk120stiff.stiffness.complementary import complementary_stiffness
from sk120stiff.stiffness.equilibrium import equilibrium, linear_springs
from sk120stiff.stiffness.principal import definiteness


@dataclass(frozen=True, eq=False)
class Deflection:
    """Displacement of the loaded point, (..., 3) each, base axes [m].

    Attributes
    ----------
    conventional
        J K_θ⁻¹ Jᵀ W, eq. (8).
    enhanced
        J (K_θ − K_C)⁻¹ Jᵀ W, eq. (10) and (11): the paper's formula. It lacks the curvature of the
        path, so it is not of second order. NaN where K_θ − K_C is not positive definite: there the
        formula points to a balance that does not hold.
    second_order
        The enhanced one with the path's curvature, + ½ δᵀ H δ; NaN where that one is.
    equilibrium
        The exact one, at the loaded equilibrium.
    """

    conventional: Array
    enhanced: Array
    second_order: Array
    equilibrium: Array


def deflection(
    mechanism: Mechanism,
    a: ArrayLike,
    wrench: ArrayLike,
    stiffness: ArrayLike,
    point: Array | None = None,
) -> Deflection:
    """Deflection of a point under a wrench by linear joint springs.

    Parameters
    ----------
    mechanism
        Chain and coupling to the frame of the point.
    a
        (..., n) unloaded coordinates.
    wrench
        (..., 6) force [N] and moment [N·m] at the point, base axes.
    stiffness
        (n,) springs [N·m/rad or N/m]; an infinite one is rigid.
    point
        (3,) in the end frame [m].

    Raises
    ------
    Refusal
        The load is exactly critical, or no equilibrium exists.
    """
    load = np.asarray(wrench, dtype=float)
    springs = np.asarray(stiffness, dtype=float)
    coordinates = np.asarray(a, dtype=float)
    start = mechanism.screws(coordinates, point)
    soft = np.isfinite(springs)
    J = start.jacobian[..., soft]
    K_theta = spring_matrix(springs[soft])
    K_C = complementary_stiffness(start, load)[..., soft, :][..., :, soft]
    conventional = (cartesian_compliance(J, K_theta) @ load[..., None])[..., :3, 0]
    torques = np.swapaxes(J, -1, -2) @ load[..., None]
    try:
        step = np.linalg.solve(K_theta - K_C, torques)  # (..., soft, 1)
    except np.linalg.LinAlgError as error:
        raise Refusal(
            "K_θ − K_C is singular: this load is exactly critical and the deflection has no bound",
            remedy="Lower the load.",
        ) from error
    holds = definiteness(K_theta - K_C) == 0
    enhanced = np.where(holds[..., None], (J[..., :3, :] @ step)[..., 0], np.nan)
    curvature = _path_curvature(start, soft, step[..., 0])
    at_rest = equilibrium(mechanism, coordinates, load, linear_springs(springs), point=point)
    return Deflection(
        conventional=conventional,
        enhanced=enhanced,
        second_order=enhanced + 0.5 * curvature,
        equilibrium=at_rest.screws.position - start.position,
    )


def _path_curvature(screws: Screws, soft: Mask, step: Array) -> Array:
    """δᵀ (∂²x/∂z²) δ of the point for each axis: K_C of a unit force along it is that Hessian."""
    delta = np.zeros((*step.shape[:-1], len(soft)))
    delta[..., soft] = step
    axes = []
    for axis in range(3):
        unit = np.zeros(6)
        unit[axis] = 1.0
        hessian = complementary_stiffness(screws, unit)
        axes.append(np.einsum("...i,...ij,...j->...", delta, hessian, delta))
    return np.stack(axes, axis=-1)
