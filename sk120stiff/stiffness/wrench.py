"""Loads as callers give them, force and moment or a force alone, and as other axes have them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError


def rotate(rotation: Array, wrench: Array) -> Array:
    """(..., 6) wrenches with force and moment turned by (..., 3, 3)."""
    force = np.einsum("...ij,...j->...i", rotation, wrench[..., :3])
    moment = np.einsum("...ij,...j->...i", rotation, wrench[..., 3:])
    return np.concatenate([force, moment], axis=-1)


def wrenches(wrench: ArrayLike, count: int) -> Array:
    """(count, 6) forces [N] and moments [N·m] of one wrench for all poses, or one for each.

    Three numbers are a force without a moment.

    Raises:
        InputError: Another shape, or a number that is not finite.
    """
    load = np.asarray(wrench, dtype=float)
    if load.ndim and load.shape[-1] == 3:
        load = np.concatenate([load, np.zeros_like(load)], axis=-1)
    if load.shape not in ((6,), (1, 6), (count, 6)):
        raise InputError(
            f"{count} poses with wrenches of shape {np.shape(wrench)}",
            remedy="Give force [N] and moment [N·m], six numbers, or a force alone, three, for all "
            "poses or for each.",
        )
    if not np.isfinite(load).all():
        raise InputError("a load (wrench) holds a number that is not finite")
    return np.broadcast_to(load, (count, 6))
