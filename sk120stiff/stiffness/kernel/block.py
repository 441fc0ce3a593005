"""One compiled function that works through a stretch of poses, block by block."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel.compiled import entry, part
from sk120stiff.stiffness.kernel.compliance import (
    complementary,
    complementary_of_pose,
    compliance,
    deflect,
    factor_of,
    factorise,
    solve_pose,
    subtract_from_springs,
    torques_of_pose,
    whitener_of,
)
from sk120stiff.stiffness.kernel.eigen import PD, ZERO, classify, eigen, jacobi
from sk120stiff.stiffness.kernel.folding import Fold, Given
from sk120stiff.stiffness.kernel.layout import (
    BLOCK,
    CHANGE,
    DEFLECTION,
    EIGENVALUE,
    EIGENVECTOR,
    LOAD,
    POSITION,
    ROTATION,
    SAFE,
    TENSOR,
    Scratch,
    at,
)
from sk120stiff.stiffness.kernel.motion import (
    carry,
    columns_of_J,
    place_joints,
    sag,
    turn_levers,
)

# Above this determinant (of K scaled to a unit diagonal) the factorisation without exchanges is
# accurate, and definiteness is beyond doubt if the diagonal itself spans less than `SPAN`.
SURE, SPAN = 1e-6, 1e-4
BENDS, REST = 60, 1e-13  # steps of Newton under the weight, and where they end [rad or m]


class Outputs(NamedTuple):
    """Arrays to fill, for Q loads and N poses; one of size zero is left out.

    See `UnderLoad` for what they are: (N, …), and (Q, N, …) where the load matters.
    """

    position: Array
    rotation: Array
    jacobian: Array
    condition: Array
    K_gravity: Array
    compliance: Array
    values: Array
    directions: Array
    K_C: Array
    stiffness_class: NDArray[np.uint8]
    complementary_class: NDArray[np.uint8]
    critical: Array
    deflection_enhanced: Array


@entry
def work(
    fold: Fold,
    a: Array,
    more: Given,
    loads: Array,
    begin: int,
    end: int,
    out: Outputs,
    rows: Scratch,
) -> None:
    """Fill rows begin…end of the outputs.

    Args:
        fold: Constants of the mechanism.
        a: (N, n_a) coordinates, or (N, m) joint values where the motion is given.
        more: What is given.
        loads: (Q, 1, 6) loads at every pose, or (1, N, 6) one for each.
        rows: Memory that no other thread uses.
    """
    s, x, A, B = fold.soft.shape[0], rows.x, rows.A, rows.B
    deflects = out.deflection_enhanced.size > 0
    principal = out.values.size + out.directions.size > 0
    stiffness = principal or deflects or out.compliance.size + out.stiffness_class.size > 0
    stability = out.K_C.size + out.complementary_class.size + out.critical.size > 0
    for element in range(s * (s + 1) // 2):
        spring, row = fold.springs[element], at(rows.springs + element)
        for k in range(BLOCK):
            x[row + k] = spring
    for first in range(begin, end, BLOCK):
        count = min(BLOCK, end - first)
        _read(x, a, fold.inputs, rows.pose, first, count)
        if fold.given:
            _read(x, more.factors, fold.column_joint.shape[0], rows.factors, first, count)
            _read(x, more.bends, fold.bend.shape[0], rows.bends, first, count)
        if more.springs.size:
            _read(x, more.springs, more.springs.shape[1], rows.springs, first, count)
        if fold.weighs:
            _hang(fold, rows)
        else:
            place_joints(fold, rows)
        turn_levers(fold, rows)
        columns_of_J(fold, rows)
        _store_motion(fold, first, count, out, rows)
        for load in range(loads.shape[0]):
            force, moment = _load(x, loads, load, first, count)
            complementary(fold, rows, rows.levers, rows.K_C, force, moment)
            if stability:
                _store_complementary(fold, load, first, count, out, rows, more)
            if not stiffness:
                continue
            if fold.weighs:
                to, own = at(rows.K_C), at(rows.K_g)
                for k in range(s * (s + 1) // 2 * BLOCK):
                    x[to + k] += x[own + k]
            factorise(fold, rows, rows.K_C)
            compliance(fold, rows)
            if deflects:
                deflect(x)
            for k in range(count):
                if moment or not x[SAFE * BLOCK + k] > SURE:
                    complementary_of_pose(x, s, rows.K_C, rows.skew, k, A)
                    subtract_from_springs(rows, k, A)
                    torques_of_pose(fold, rows, k, B)
                    solve_pose(fold, rows, k, A, B)
            if principal:
                eigen(x)
            _store_stiffness(x, load, first, count, out)
            _store_definiteness(fold, load, first, count, out, rows)


@part
def _hang(fold: Fold, rows: Scratch) -> None:
    """Let the block's poses sag under their own weight; rows K_g become its stiffness there.

    Given poses hang already.

    Where the springs cannot hold it, or Newton does not settle, nothing is a number.
    """
    s, x = fold.soft.shape[0], rows.x
    for i in range(3):
        for k in range(BLOCK):
            x[(LOAD + i) * BLOCK + k] = fold.gravity[i]
    start = at(rows.pose + fold.actuated)
    for k in range(0 if fold.given else (fold.n - fold.actuated) * BLOCK):
        x[start + k] = 0.0
    start = at(rows.bent)
    for k in range(s * BLOCK):
        x[start + k] = 0.0
    for _ in range(BENDS):
        place_joints(fold, rows)
        carry(fold, rows)
        # neither is a literal, for which it would be compiled once more
        complementary(fold, rows, rows.carried, rows.K_g, fold.weighs, not fold.weighs)
        if fold.given:
            return
        factorise(fold, rows, rows.K_g)
        if sag(fold, rows) <= REST:
            break
    for k in range(BLOCK):
        if not x[CHANGE * BLOCK + k] <= REST or not x[SAFE * BLOCK + k] > 0.0:
            x[POSITION * BLOCK + k] = math.nan


@part
def _read(x: Array, source: Array, count: int, row: int, first: int, poses: int) -> None:
    """Columns of (N, count) into rows; what is beyond the last pose repeats it."""
    for i in range(count):
        to = at(row + i)
        for k in range(BLOCK):
            x[to + k] = source[first + min(k, poses - 1), i]


@part
def _load(x: Array, loads: Array, load: int, first: int, count: int) -> tuple[bool, bool]:
    """Rows LOAD; whether there is any force, and any moment."""
    each = loads.shape[1] > 1
    force, moment = False, False
    for k in range(BLOCK):
        at_pose = first + min(k, count - 1) if each else 0
        for i in range(3):
            f, t = loads[load, at_pose, i], loads[load, at_pose, 3 + i]
            x[(LOAD + i) * BLOCK + k] = f
            x[(LOAD + 3 + i) * BLOCK + k] = t
            force |= f != 0.0
            moment |= t != 0.0
    return force, moment


@part
def _store_motion(fold: Fold, first: int, count: int, out: Outputs, rows: Scratch) -> None:
    """Placement, Jacobian, how far that is from losing a direction, and K_C of the weight."""
    x, axes, levers, s = rows.x, rows.axes, rows.levers, fold.soft.shape[0]
    if out.position.size:
        for k in range(count):
            for i in range(3):
                out.position[first + k, i] = x[(POSITION + i) * BLOCK + k]
    if out.rotation.size:
        for k in range(count):
            for i in range(3):
                rx, ry = x[(ROTATION + i) * BLOCK + k], x[(ROTATION + 3 + i) * BLOCK + k]
                rz = x[(ROTATION + 6 + i) * BLOCK + k]
                for j in range(3):
                    turned = rx * fold.final[0, j] + ry * fold.final[1, j]
                    out.rotation[first + k, i, j] = turned + rz * fold.final[2, j]
    if out.jacobian.size:
        for k in range(count):
            for j in range(fold.column_joint.shape[0]):
                joint, z = fold.column_joint[j], fold.column_coordinate[j]
                factor = factor_of(fold, rows, j, k)
                for i in range(3):
                    v, w = x[at(levers + 3 * joint + i) + k], x[at(axes + 3 * joint + i) + k]
                    out.jacobian[first + k, i, z] += factor * v
                    out.jacobian[first + k, 3 + i, z] += factor * w
    if out.condition.size:
        for i in range(3):
            for j in range(3):
                row = (TENSOR + 3 * i + j) * BLOCK
                for k in range(BLOCK):
                    x[row + k] = 0.0
                for z in range(fold.actuated):
                    f, g = at(rows.columns + 3 * z + i), at(rows.columns + 3 * z + j)
                    for k in range(BLOCK):
                        x[row + k] += x[f + k] * x[g + k]
        eigen(x)
        for k in range(count):
            large, small = x[EIGENVALUE * BLOCK + k], x[(EIGENVALUE + 2) * BLOCK + k]
            out.condition[first + k] = math.sqrt(max(small, 0.0) / large) if large > 0.0 else 0.0
    if fold.weighs and out.K_gravity.size:
        for k in range(count):
            complementary_of_pose(x, s, rows.K_g, -1, k, rows.A)
            for i in range(s):
                for j in range(s):
                    out.K_gravity[first + k, i, j] = rows.A[i, j]


@part
def _store_stiffness(x: Array, load: int, first: int, count: int, out: Outputs) -> None:
    """Compliance, principal stiffness and its directions."""
    for k in range(count):
        if out.compliance.size:
            for i in range(3):
                for j in range(3):
                    out.compliance[load, first + k, i, j] = x[(TENSOR + 3 * i + j) * BLOCK + k]
        if out.values.size:
            size = 0.0
            for i in range(3):
                size = max(size, abs(x[(EIGENVALUE + i) * BLOCK + k]))
            for i in range(3):
                c = x[(EIGENVALUE + i) * BLOCK + k]
                out.values[load, first + k, i] = np.inf if abs(c) <= ZERO * size else 1.0 / c
        if out.directions.size:
            for i in range(3):
                for j in range(3):
                    row = (EIGENVECTOR + 3 * i + j) * BLOCK
                    out.directions[load, first + k, i, j] = x[row + k]


@part
def _store_definiteness(
    fold: Fold, load: int, first: int, count: int, out: Outputs, rows: Scratch
) -> None:
    """Class of K, and the deflection where the balance holds."""
    deflects = out.deflection_enhanced.size > 0
    for k in range(count if deflects or out.stiffness_class.size else 0):
        found = _class_of(fold, rows, k)
        if out.stiffness_class.size:
            out.stiffness_class[load, first + k] = found
        if deflects:
            for i in range(3):
                moved = rows.x[(DEFLECTION + i) * BLOCK + k]
                out.deflection_enhanced[load, first + k, i] = moved if found == PD else math.nan


@part
def _class_of(fold: Fold, rows: Scratch, pose: int) -> int:
    """Class of K at one pose of the block; rows K_C hold all that is taken from K_θ."""
    x, low, high, element = rows.x, np.inf, 0.0, -1
    for i in range(fold.soft.shape[0]):
        element += i + 1
        diagonal = x[at(rows.springs + element) + pose] - x[at(rows.K_C + element) + pose]
        low, high = min(low, diagonal), max(high, diagonal)
    if x[SAFE * BLOCK + pose] > SURE and low > SPAN * high:
        return PD
    complementary_of_pose(x, fold.soft.shape[0], rows.K_C, -1, pose, rows.A)
    subtract_from_springs(rows, pose, rows.A)
    return int(classify(rows.A))


@part
def _store_complementary(
    fold: Fold, load: int, first: int, count: int, out: Outputs, rows: Scratch, more: Given
) -> None:
    """K_C, its class, and the factor on the load at which stability is lost."""
    s, x, A, own = fold.soft.shape[0], rows.x, rows.A, rows.own
    for k in range(count):
        if out.K_C.size:
            complementary_of_pose(x, s, rows.K_C, rows.skew, k, A)
            for i in range(s):
                for j in range(s):
                    out.K_C[load, first + k, i, j] = A[i, j]
        complementary_of_pose(x, s, rows.K_C, -1, k, A)
        if out.critical.size:
            factor = 0.0
            if not fold.weighs and not more.springs.size:
                factor = _critical(fold.whitener, A, rows.B)
            else:
                for i in range(s * s):
                    own[i // s, i % s] = 0.0
                if fold.weighs:
                    complementary_of_pose(x, s, rows.K_g, -1, k, own)
                subtract_from_springs(rows, k, own)
                if whitener_of(own):
                    factor = _critical(own, A, rows.B)
            out.critical[load, first + k] = factor
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
    jacobi(B, s)
    largest, size = B[0, 0], 0.0
    for i in range(s):
        largest, size = max(largest, B[i, i]), max(size, abs(B[i, i]))
    return 1.0 / largest if largest > ZERO * size else np.inf
