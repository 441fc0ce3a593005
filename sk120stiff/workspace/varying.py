"""The quantities of `stiffness_batch` for a model whose compliance changes with the pose.

A rod of a linkage or a gravity compensator makes the springs another at every pose. The compiled
kernel does not follow that; here the same formulas run on NumPy arrays, some fifty times slower.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.effects import situation_of_load
from sk120stiff.errors import Refusal
from sk120stiff.model import Model
from sk120stiff.robot import Screws
from sk120stiff.robot.coupling import Array
from sk120stiff.stiffness import (
    StiffnessBatch,
    cartesian_compliance,
    complementary_stiffness,
    definiteness,
    principal_stiffness,
    symmetric_part,
)

Numbers = NDArray[Any]

BLOCK = 4096  # poses worked on together


def varying_batch(
    model: Model, a: Array, wrench: ArrayLike, want: Collection[str], point: Array
) -> StiffnessBatch:
    """`stiffness_batch` of a model at commanded coordinates (N, n), its compliance at each pose.

    Parameters
    ----------
    model
        Robot and elastic effects.
    a
        (N, n) [rad or m].
    wrench
        As in `stiffness_batch`.
    want
        As in `stiffness_batch`.
    point
        (3,) in the tool frame [m].
    """
    load = np.asarray(wrench, dtype=float)
    several, n_a = load.ndim == 3, model.robot.n
    loads = load if several else load.reshape(1, -1, load.shape[-1])
    if loads.shape[-1] == 3:
        loads = np.concatenate([loads, np.zeros_like(loads)], axis=-1)
    found: dict[str, list[list[Array]]] = {name: [] for name in want}
    soft: Numbers = np.zeros(0, dtype=np.int64)
    for begin in range(0, len(a), BLOCK):
        part = a[begin : begin + BLOCK]
        rest = model.solve(situation_of_load(model.robot, part, np.zeros(6), point=point)).rest
        soft = np.flatnonzero(rest.compliance.any(axis=(0, 1)))
        per_load = []
        for each in loads:
            own = each if len(each) == 1 else each[begin : begin + BLOCK]
            per_load.append(_quantities(rest.screws, rest.compliance, own, soft, want, n_a))
        for name in want:
            found[name].append([quantities[name] for quantities in per_load])
    joined: dict[str, Any] = {}
    for name, blocks in found.items():
        stacked = [np.concatenate(parts) for parts in zip(*blocks, strict=True)]
        by_load = name not in ("position", "rotation", "jacobian", "condition")
        joined[name] = np.stack(stacked) if by_load and several else stacked[0]
    return StiffnessBatch(soft=soft.astype(np.int64), **joined)


def _quantities(
    screws: Screws, compliance: Array, load: Array, soft: Numbers, want: Collection[str], n_a: int
) -> dict[str, Any]:
    """Everything that is wanted at some poses under one load each."""
    K_theta = np.asarray(np.linalg.inv(compliance[:, soft[:, None], soft]), dtype=float)
    K_C = complementary_stiffness(screws, load)[:, soft[:, None], soft]
    J = screws.linear_jacobian
    answers: dict[str, Any] = {
        "position": screws.position,
        "rotation": screws.rotation,
        "jacobian": screws.jacobian,
        "K_C": K_C,
    }
    if "condition" in want:
        singular = np.linalg.svd(J[..., :n_a], compute_uv=False)
        smallest = singular[:, 2] if n_a > 2 else np.zeros(len(J))
        answers["condition"] = smallest / singular[:, 0]
    if {"compliance", "values", "directions"} & set(want):
        answers["compliance"] = _compliance(J[..., soft], K_theta - K_C)
        principal = principal_stiffness(answers["compliance"])
        answers["values"], answers["directions"] = principal.values, principal.directions
    if "stiffness_class" in want:
        answers["stiffness_class"] = definiteness(K_theta - K_C).astype(np.uint8)
    if "complementary_class" in want:
        answers["complementary_class"] = definiteness(K_C).astype(np.uint8)
    if "critical" in want:
        inward = np.linalg.inv(np.linalg.cholesky(symmetric_part(K_theta)))
        scaled = inward @ symmetric_part(K_C) @ np.swapaxes(inward, -1, -2)
        values = np.linalg.eigvalsh(scaled)
        softens = values[:, -1] > 1e-12 * np.abs(values).max(axis=-1)
        answers["critical"] = np.where(softens, 1.0 / np.where(softens, values[:, -1], 1.0), np.inf)
    return answers


def _compliance(J: Array, stiffness: Array) -> Array:
    """J K⁻¹ Jᵀ, NaN where K is singular."""
    try:
        return cartesian_compliance(J, stiffness)
    except Refusal:
        regular = np.abs(np.linalg.det(stiffness)) > 0.0
        found = np.full((len(J), 3, 3), np.nan)
        found[regular] = cartesian_compliance(J[regular], stiffness[regular])
        return found
