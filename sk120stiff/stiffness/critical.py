"""The load at which an arm loses stability."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.robot import Screws
from sk120stiff.stiffness.complementary import complementary_stiffness, symmetric_part

ZERO = 1e-12  # share of the largest below which an eigenvalue is rounding noise of either sign


def critical_load(screws: Screws, stiffness: Array, direction: ArrayLike) -> Array:
    """Factor on a wrench at which K_θ − λ K_C first loses positive definiteness.

    K_C is linear in the load, so λ is the smallest positive generalised eigenvalue of
    K_θ x = λ K_C x, i.e. one over the largest eigenvalue of K_θ^(-1/2) K_C K_θ^(-1/2).

    Parameters
    ----------
    screws
        Kinematics at the unloaded pose.
    stiffness
        (n,) springs of the coordinates [N·m/rad or N/m].
    direction
        (..., 6) wrench per unit λ; with a unit force λ is in newtons.

    Returns
    -------
    (...,) λ; infinite where no such load exists in this direction.
    """
    root = 1.0 / np.sqrt(stiffness)
    K_C = symmetric_part(complementary_stiffness(screws, direction))
    values = np.linalg.eigvalsh(root[..., :, None] * K_C * root[..., None, :])
    largest = values[..., -1]
    softens = largest > ZERO * np.abs(values).max(axis=-1)
    return np.where(softens, 1.0 / np.where(softens, largest, 1.0), np.inf)
