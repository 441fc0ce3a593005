"""One compiled function that works through a stretch of poses, block by block."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel import entry, part
from sk120stiff.stiffness.lanes.compliance import (
    complementary,
    complementary_of_lane,
    compliance,
    factorise,
    solve_lane,
    subtract_from_springs,
)
from sk120stiff.stiffness.lanes.eigen import PD, ZERO, classify, eigen, jacobi
from sk120stiff.stiffness.lanes.folding import Fold
from sk120stiff.stiffness.lanes.layout import (
    CHANGE,
    EIGENVALUE,
    EIGENVECTOR,
    FREE,
    LANES,
    LOAD,
    POSITION,
    ROTATION,
    SAFE,
    TENSOR,
    at,
)
from sk120stiff.stiffness.lanes.motion import (
    bend_by_weight,
    columns_of_J,
    place_joints,
    turn_levers,
)

# Above this determinant (of K scaled to a unit diagonal) the factorisation without exchanges is
# accurate, and definiteness is beyond doubt if the diagonal itself spans less than `SPAN`.
SURE, SPAN = 1e-6, 1e-4
BENDS, REST = 60, 1e-14  # steps towards rest under the weight, and where they end [rad or m]


class Outputs(NamedTuple):
    """Arrays to fill, for Q loads and N poses; one of size zero is left out.

    position (N, 3), rotation (N, 3, 3), jacobian (N, 6, n), condition (N,); compliance
    (Q, N, 3, 3),
    values (Q, N, 3), directions (Q, N, 3, 3), K_C (Q, N, s, s); stiffness_class,
    complementary_class and critical (Q, N).
    """

    position: Array
    rotation: Array
    jacobian: Array
    condition: Array
    compliance: Array
    values: Array
    directions: Array
    K_C: Array
    stiffness_class: NDArray[np.uint8]
    complementary_class: NDArray[np.uint8]
    critical: Array


@entry
def work(fold: Fold, a: Array, loads: Array, begin: int, end: int, out: Outputs) -> None:
    """Fill rows begin…end of the outputs.

    Parameters
    ----------
    fold
        Constants of the mechanism.
    a
        (N, n_a) coordinates.
    loads
        (Q, 1, 6) loads at every pose, or (1, N, 6) one for each.
    """
    m, n, s = fold.kind.shape[0], fold.rest.shape[0], fold.soft.shape[0]
    weighs = fold.mass.max() > 0.0
    axes, levers, moments, torques = FREE, FREE + 3 * m, FREE + 6 * m, FREE + 9 * m
    pose = torques + m
    unbent = pose + n
    columns = unbent + n
    K_C = columns + 3 * n
    skew = K_C + s * (s + 1) // 2
    L = skew + s * (s - 1) // 2
    y = L + s * (s + 1) // 2
    x = np.zeros((y + 3 * s) * LANES)
    A, B = np.empty((s, s)), np.empty((s, max(s, 3)))
    principal = out.values.size + out.directions.size > 0
    stiffness = principal or out.compliance.size + out.stiffness_class.size > 0
    stability = out.K_C.size + out.complementary_class.size + out.critical.size > 0
    for first in range(begin, end, LANES):
        count = min(LANES, end - first)
        for i in range(n):
            row, straight = at(pose + i), at(unbent + i)
            for k in range(LANES):
                z = a[first + min(k, count - 1), i] if i < fold.actuated else fold.rest[i]
                x[row + k] = x[straight + k] = z
        place_joints(x, fold, pose, axes, levers, moments, weighs)
        if weighs:
            for _ in range(BENDS):
                change = bend_by_weight(x, fold, pose, axes, levers, moments, torques, unbent)
                place_joints(x, fold, pose, axes, levers, moments, weighs)
                if change <= REST:
                    break
            for k in range(LANES):
                if not x[CHANGE * LANES + k] <= REST:  # the springs cannot hold the weight
                    x[POSITION * LANES + k] = np.nan
        turn_levers(x, fold, axes, levers)
        columns_of_J(x, fold, levers, columns)
        _store_motion(x, fold, first, count, axes, levers, columns, out)
        for load in range(loads.shape[0]):
            force, moment = _load(x, loads, load, first, count)
            complementary(x, fold, axes, levers, K_C, skew, force, moment)
            if stiffness:
                factorise(x, fold, K_C, L)
                compliance(x, fold.soft, columns, L, y)
                for k in range(count):
                    if moment or not x[SAFE * LANES + k] > SURE:
                        complementary_of_lane(x, s, K_C, skew, k, A)
                        subtract_from_springs(fold, A)
                        solve_lane(x, fold.soft, columns, k, A, B)
                if principal:
                    eigen(x)
                _store_stiffness(x, load, first, count, out)
                _store_definiteness(x, fold, load, first, count, K_C, A, out)
            if stability:
                _store_complementary(x, fold, load, first, count, K_C, skew, A, B, out)


@part
def _load(x: Array, loads: Array, load: int, first: int, count: int) -> tuple[bool, bool]:
    """Rows LOAD; whether there is any force, and any moment."""
    each = loads.shape[1] > 1
    force, moment = False, False
    for k in range(LANES):
        at_pose = first + min(k, count - 1) if each else 0
        for i in range(3):
            f, t = loads[load, at_pose, i], loads[load, at_pose, 3 + i]
            x[(LOAD + i) * LANES + k] = f
            x[(LOAD + 3 + i) * LANES + k] = t
            force |= f != 0.0
            moment |= t != 0.0
    return force, moment


@part
def _store_motion(
    x: Array, fold: Fold, first: int, count: int, axes: int, levers: int, columns: int, out: Outputs
) -> None:
    """Placement, Jacobian, and how far the position Jacobian is from losing a direction."""
    if out.position.size:
        for k in range(count):
            for i in range(3):
                out.position[first + k, i] = x[(POSITION + i) * LANES + k]
    if out.rotation.size:
        for k in range(count):
            for i in range(3):
                rx, ry = x[(ROTATION + i) * LANES + k], x[(ROTATION + 3 + i) * LANES + k]
                rz = x[(ROTATION + 6 + i) * LANES + k]
                for j in range(3):
                    turned = rx * fold.final[0, j] + ry * fold.final[1, j]
                    out.rotation[first + k, i, j] = turned + rz * fold.final[2, j]
    if out.jacobian.size:
        for k in range(count):
            for j in range(fold.column_joint.shape[0]):
                joint, z = fold.column_joint[j], fold.column_coordinate[j]
                for i in range(3):
                    v, w = x[at(levers + 3 * joint + i) + k], x[at(axes + 3 * joint + i) + k]
                    out.jacobian[first + k, i, z] += fold.column_factor[j] * v
                    out.jacobian[first + k, 3 + i, z] += fold.column_factor[j] * w
    if out.condition.size:
        for i in range(3):
            for j in range(3):
                row = (TENSOR + 3 * i + j) * LANES
                for k in range(LANES):
                    x[row + k] = 0.0
                for z in range(fold.actuated):
                    f, g = at(columns + 3 * z + i), at(columns + 3 * z + j)
                    for k in range(LANES):
                        x[row + k] += x[f + k] * x[g + k]
        eigen(x)
        for k in range(count):
            large, small = x[EIGENVALUE * LANES + k], x[(EIGENVALUE + 2) * LANES + k]
            out.condition[first + k] = math.sqrt(max(small, 0.0) / large) if large > 0.0 else 0.0


@part
def _store_stiffness(x: Array, load: int, first: int, count: int, out: Outputs) -> None:
    """Compliance, principal stiffness and its directions."""
    for k in range(count):
        if out.compliance.size:
            for i in range(3):
                for j in range(3):
                    out.compliance[load, first + k, i, j] = x[(TENSOR + 3 * i + j) * LANES + k]
        if out.values.size:
            size = 0.0
            for i in range(3):
                size = max(size, abs(x[(EIGENVALUE + i) * LANES + k]))
            for i in range(3):
                c = x[(EIGENVALUE + i) * LANES + k]
                out.values[load, first + k, i] = np.inf if abs(c) <= ZERO * size else 1.0 / c
        if out.directions.size:
            for i in range(3):
                for j in range(3):
                    row = (EIGENVECTOR + 3 * i + j) * LANES
                    out.directions[load, first + k, i, j] = x[row + k]


@part
def _store_definiteness(
    x: Array, fold: Fold, load: int, first: int, count: int, K_C: int, A: Array, out: Outputs
) -> None:
    """Class of K_θ − K_C."""
    s = fold.soft.shape[0]
    for k in range(count if out.stiffness_class.size else 0):
        low, high, element = np.inf, 0.0, -1
        for i in range(s):
            element += i + 1
            diagonal = fold.springs[element] - x[at(K_C + element) + k]
            low, high = min(low, diagonal), max(high, diagonal)
        if x[SAFE * LANES + k] > SURE and low > SPAN * high:
            out.stiffness_class[load, first + k] = PD
        else:
            complementary_of_lane(x, s, K_C, -1, k, A)
            subtract_from_springs(fold, A)
            out.stiffness_class[load, first + k] = classify(A)


@part
def _store_complementary(
    x: Array,
    fold: Fold,
    load: int,
    first: int,
    count: int,
    K_C: int,
    skew: int,
    A: Array,
    B: Array,
    out: Outputs,
) -> None:
    """K_C, its class, and the factor on the load at which stability is lost."""
    s = fold.soft.shape[0]
    for k in range(count):
        if out.K_C.size:
            complementary_of_lane(x, s, K_C, skew, k, A)
            out.K_C[load, first + k] = A
        if out.complementary_class.size or out.critical.size:
            complementary_of_lane(x, s, K_C, -1, k, A)
            if out.critical.size:
                out.critical[load, first + k] = _critical(fold.whitener, A, B[:, :s])
            if out.complementary_class.size:
                out.complementary_class[load, first + k] = classify(A)


@part
def _critical(whitener: Array, K_C: Array, B: Array) -> float:
    """1 / (largest eigenvalue of L⁻¹ K_C L⁻ᵀ) with L Lᵀ = K_θ; infinite if it is not positive."""
    s = K_C.shape[0]
    for i in range(s):
        for j in range(i + 1):
            total = 0.0
            for p in range(i + 1):
                inner = 0.0
                for q in range(j + 1):
                    inner += K_C[p, q] * whitener[j, q]
                total += whitener[i, p] * inner
            B[i, j] = B[j, i] = total
    jacobi(B)
    largest, size = B[0, 0], 0.0
    for i in range(s):
        largest, size = max(largest, B[i, i]), max(size, abs(B[i, i]))
    return 1.0 / largest if largest > ZERO * size else np.inf
