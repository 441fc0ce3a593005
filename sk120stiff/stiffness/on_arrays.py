"""The formulas of `under_load` on NumPy arrays: for every arm, every coupling, every quantity."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array, Index
from sk120stiff.robot import Screws
from sk120stiff.stiffness.cartesian import (
    complementary_stiffness,
    gravity_stiffness,
    symmetric_part,
)
from sk120stiff.stiffness.elastic import ZERO, Compliant
from sk120stiff.stiffness.equilibrium import equilibrium
from sk120stiff.stiffness.principal import definiteness, principal_stiffness

CLASSIFIED = {"stiffness_class", "complementary_class", "critical", "stiffening"}
LOADED = {"compliance", "compliance_enhanced", "values", "directions"}
AT_REST = {"deflection_equilibrium", "loaded_coordinates"}
BY_FORMULA = {"deflection_conventional", "deflection_enhanced", "deflection_second_order"}
PD = 0  # index of "positive definite" in `CLASSES`


def on_arrays(
    arm: Compliant, a: Array, wrench: Array, want: Collection[str]
) -> dict[str, NDArray[Any]]:
    """What is wanted of `UnderLoad`, for poses (..., n_a) and loads (..., 6)."""
    wanted = set(want)
    batch, rows = a.shape[:-1], a.reshape(-1, a.shape[-1])
    soft, weight = arm.soft, arm.weight_at(rows)
    z = hanging(arm, rows).reshape(*batch, -1)
    screws = arm.mechanism.screws(z, arm.point)
    C = arm.compliance_at(rows)
    if C.ndim > 2:
        C = C.reshape(*batch, *C.shape[-2:])
    block = (..., soft[:, None], soft)
    C = symmetric_part(C[block])
    whole = bool(wanted & {"jacobian", "compliance_conventional", "compliance_enhanced"})
    J = screws.jacobian if whole else screws.linear_jacobian
    J_soft = J[..., soft]
    K_C = complementary_stiffness(screws, wrench)[block]
    K_g = np.zeros((*batch, len(soft), len(soft)))
    if weight is not None:
        K_g = gravity_stiffness(screws, weight.gravity)[block]
    found: dict[str, NDArray[Any]] = {
        "coordinates": z,
        "position": screws.position,
        "rotation": screws.rotation,
        "K_gravity": K_g,
        "K_C": K_C,
    }
    if "jacobian" in wanted:
        found["jacobian"] = J
    if "condition" in wanted:
        found["condition"] = _condition(J[..., :3, : a.shape[-1]])
    if wanted & AT_REST:
        found |= _at_rest(arm, a, wrench, screws.position)
    deflects = wanted & BY_FORMULA
    if deflects or wanted & CLASSIFIED:
        found |= _stability(C, symmetric_part(K_C), K_g)
    if "compliance_conventional" in wanted:
        found["compliance_conventional"] = J_soft @ C @ np.swapaxes(J_soft, -1, -2)
    if not (deflects or wanted & LOADED):
        return {name: found[name] for name in want}
    inverse = _loaded_compliance(C, K_C + K_g)  # (K_θ − K_C − K_g)⁻¹
    seen = J_soft if "compliance_enhanced" in wanted else J_soft[..., :3, :]
    enhanced = seen @ inverse @ np.swapaxes(seen, -1, -2)
    found |= {"compliance_enhanced": enhanced, "compliance": enhanced[..., :3, :3]}
    if wanted & {"values", "directions"}:
        principal = principal_stiffness(found["compliance"])
        found |= {"values": principal.values, "directions": principal.directions}
    if deflects:
        torques = screws.torques(wrench)[..., soft, None]
        step = np.where((found["stiffness_class"] == PD)[..., None, None], inverse, np.nan)
        step = step @ torques  # (..., s, 1)
        found["deflection_conventional"] = (J_soft[..., :3, :] @ C @ torques)[..., 0]
        found["deflection_enhanced"] = (J_soft[..., :3, :] @ step)[..., 0]
        if "deflection_second_order" in wanted:
            curved = 0.5 * _path_curvature(screws, soft, step[..., 0])
            found["deflection_second_order"] = found["deflection_enhanced"] + curved
    return {name: found[name] for name in want}


def hanging(arm: Compliant, rows: Array) -> Array:
    """(N, n) coordinates before the load, bent by the arm's own weight."""
    z_0, weight = arm.start(rows), arm.weight_at(rows)
    if weight is None:
        return z_0
    rigid = np.zeros((z_0.shape[-1],) * 2)
    return equilibrium(
        arm.mechanism,
        z_0,
        np.zeros(6),
        lambda torques: (np.zeros_like(torques), rigid),
        soft=arm.soft,
        weight=weight,
    ).z


def _at_rest(arm: Compliant, a: Array, wrench: Array, before: Array) -> dict[str, NDArray[Any]]:
    """Exact equilibrium under the load; `before` (..., 3) is where the point was."""
    batch = np.broadcast_shapes(a.shape[:-1], wrench.shape[:-1])
    rows = np.broadcast_to(a, (*batch, a.shape[-1])).reshape(-1, a.shape[-1])
    loads = np.broadcast_to(wrench, (*batch, 6)).reshape(-1, 6)
    rest = equilibrium(
        arm.mechanism,
        arm.start(rows),
        loads,
        arm.law(rows, loads),
        point=arm.point,
        soft=arm.soft,
        weight=arm.weight_at(rows),
    )
    return {
        "deflection_equilibrium": rest.screws.position.reshape(*batch, 3) - before,
        "loaded_coordinates": rest.z.reshape(*batch, -1),
    }


def _condition(J: Array) -> Array:
    """(...,) smallest over largest singular value of J (..., 3, n_a)."""
    singular = np.linalg.svd(J, compute_uv=False)
    if singular.shape[-1] < 3:
        return np.zeros(J.shape[:-2])
    return np.asarray(singular[..., 2] / singular[..., 0])


def _loaded_compliance(C: Array, K: Array) -> Array:
    """(I − C K)⁻¹ C, which needs no inverse of C; NaN where the loads are critical."""
    newton = np.eye(C.shape[-1]) - C @ K
    regular = np.abs(np.linalg.det(newton)) > 0.0
    newton = np.where(regular[..., None, None], newton, np.nan)
    return np.asarray(np.linalg.solve(newton, np.broadcast_to(C, newton.shape)))


def _stability(C: Array, K_C: Array, K_g: Array) -> dict[str, NDArray[Any]]:
    """Classes, critical factors and shares, in the directions that yield at all.

    With c the principal compliances and V their directions, √c Vᵀ (K_θ − K_g) V √c = I − √c K_g √c
    is what a load has to overcome; in its own measure K_C has the shares that it takes or adds.
    """
    shape = np.broadcast_shapes(C.shape, K_C.shape)
    s = shape[-1]
    c, V = np.linalg.eigh(C)
    c = np.broadcast_to(c, shape[:-1]).reshape(-1, s)
    V, K_C, K_g = (np.broadcast_to(x, shape).reshape(-1, s, s) for x in (V, K_C, K_g))
    yields = np.abs(c) > ZERO * np.abs(c).max(axis=-1, keepdims=True, initial=0.0)
    of_K, of_K_C = (np.empty(len(c), dtype=np.uint8) for _ in range(2))
    critical, stiffening = np.zeros(len(c)), np.full(len(c), np.nan)
    for pattern in np.unique(yields, axis=0):
        here = np.flatnonzero((yields == pattern).all(axis=-1))
        some, across = c[here][:, pattern], V[here][..., pattern]
        load, own = (np.swapaxes(across, -1, -2) @ K[here] @ across for K in (K_C, K_g))
        of_K[here] = definiteness((1.0 / some)[..., None] * np.eye(some.shape[-1]) - own - load)
        of_K_C[here] = definiteness(load)
        root = np.sqrt(np.abs(some))
        scale = root[..., :, None] * root[..., None, :]
        held, turn = np.linalg.eigh(np.eye(some.shape[-1]) - scale * own)
        stands = (some > 0.0).all(axis=-1) & (held > ZERO).all(axis=-1)
        by = turn / np.sqrt(np.where(np.asarray(stands)[:, None], held, 1.0))[..., None, :]
        shares = np.linalg.eigvalsh(np.swapaxes(by, -1, -2) @ (scale * load) @ by)
        top, noise = shares[:, -1], ZERO * np.abs(shares).max(axis=-1, initial=0.0)
        factor = np.where(top > noise, 1.0 / np.where(top > noise, top, 1.0), np.inf)
        critical[here] = np.where(stands, factor, 0.0)
        stiffening[here] = np.where(stands, np.maximum(0.0, -shares[:, 0]), np.nan)
    batch = shape[:-2]
    return {
        "stiffness_class": of_K.reshape(batch),
        "complementary_class": of_K_C.reshape(batch),
        "critical": critical.reshape(batch),
        "stiffening": stiffening.reshape(batch),
    }


def _path_curvature(screws: Screws, soft: Index, step: Array) -> Array:
    """δᵀ (∂²x/∂z²) δ of the point for each axis: K_C of a unit force along it is that Hessian."""
    axes = []
    for axis in range(3):
        hessian = complementary_stiffness(screws, np.eye(6)[axis])[..., soft[:, None], soft]
        axes.append(np.einsum("...i,...ij,...j->...", step, hessian, step))
    return np.stack(axes, axis=-1)
