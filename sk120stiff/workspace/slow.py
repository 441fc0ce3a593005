"""The quantities of `stiffness_batch` for a model that the compiled kernel does not follow.

A rod of a linkage or a gravity compensator makes the springs another at every pose, and a closed
loop that is no parallelogram couples joints in a way that is not linear. Here the same formulas run
on NumPy arrays, some fifty times slower.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.arrays import Array
from sk120stiff.effects import situation_of_load
from sk120stiff.model import Model
from sk120stiff.robot import Screws
from sk120stiff.stiffness import (
    StiffnessBatch,
    complementary_stiffness,
    definiteness,
    principal_stiffness,
    spring_matrix,
    symmetric_part,
)

Numbers = NDArray[Any]

ZERO = 1e-12  # share of the largest below which a compliance or an eigenvalue counts as zero
BLOCK = 4096  # poses worked on together


def slow_batch(
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
    C = symmetric_part(compliance[:, soft[:, None], soft])
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
        answers["compliance"] = _compliance(J[..., soft], C, K_C)
        principal = principal_stiffness(answers["compliance"])
        answers["values"], answers["directions"] = principal.values, principal.directions
    if {"stiffness_class", "complementary_class", "critical"} & set(want):
        answers |= _stability(C, symmetric_part(K_C))
    return answers


def _compliance(J: Array, C: Array, K_C: Array) -> Array:
    """J (I − C K_C)⁻¹ C Jᵀ, which needs no inverse of C; NaN where the load is critical."""
    newton = np.eye(C.shape[-1]) - C @ K_C
    regular = np.abs(np.linalg.det(newton)) > 0.0
    newton = np.where(regular[:, None, None], newton, np.nan)
    return np.asarray(J @ np.linalg.solve(newton, C @ np.swapaxes(J, -1, -2)))


def _stability(C: Array, K_C: Array) -> dict[str, Any]:
    """Classes and critical factors, in the directions that yield at all."""
    compliances, directions = np.linalg.eigh(C)
    size = np.abs(compliances).max(axis=-1, keepdims=True)
    yields = np.abs(compliances) > ZERO * size
    of_K = np.empty(len(C), dtype=np.uint8)
    of_K_C, critical = np.empty(len(C), dtype=np.uint8), np.full(len(C), np.inf)
    for pattern in np.unique(yields, axis=0):
        here = np.flatnonzero((yields == pattern).all(axis=-1))
        V = directions[here][..., pattern]
        c = compliances[here][:, pattern]
        within = np.swapaxes(V, -1, -2) @ K_C[here] @ V
        of_K[here] = definiteness(spring_matrix(1.0 / c) - within)
        of_K_C[here] = definiteness(within)
        # A negative spring is unstable before any load comes: its factor is zero.
        root = np.sqrt(np.abs(c))
        values = np.linalg.eigvalsh(root[..., :, None] * within * root[..., None, :])
        softens = values[:, -1] > ZERO * np.abs(values).max(axis=-1)
        factor = np.where(softens, 1.0 / np.where(softens, values[:, -1], 1.0), np.inf)
        critical[here] = np.where((c > 0.0).all(axis=-1), factor, 0.0)
    return {"stiffness_class": of_K, "complementary_class": of_K_C, "critical": critical}
