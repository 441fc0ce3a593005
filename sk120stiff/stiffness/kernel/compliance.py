"""From axes and levers to K_θ − K_C and the compliance of the point, for a block of poses."""

from __future__ import annotations

import math

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel.compiled import part
from sk120stiff.stiffness.kernel.folding import Fold
from sk120stiff.stiffness.kernel.layout import (
    BLOCK,
    DEFLECTION,
    FACTOR,
    INVERSE,
    LOAD,
    SAFE,
    TENSOR,
    TURNED,
    Scratch,
    at,
)


@part
def complementary(
    fold: Fold, rows: Scratch, levers: int, K_C: int, force: bool, moment: bool
) -> None:
    """Rows of K_C: the lower triangle of its symmetric part, and the strictly lower skew part.

    Each pair of joints, the first nearer to the base, has F·(w_1 × v_2) in both of its elements of
    K_C and M·(w_1 × w_2) in the lower one, half of which is symmetric.
    """
    s, x, axes, skew = fold.soft.shape[0], rows.x, rows.axes, rows.skew
    start, skew_start = at(K_C), at(skew)
    for k in range(s * (s + 1) // 2 * BLOCK):
        x[start + k] = 0.0
    for k in range(s * (s - 1) // 2 * BLOCK):
        x[skew_start + k] = 0.0
    add, last = 0, -1
    for pair in range(fold.pair.shape[0] if force or moment else 0):
        first, second = fold.pair[pair, 0], fold.pair[pair, 1]
        w2, v2 = at(axes + 3 * second), at(levers + 3 * second)
        if first != last:
            last = first
            _turn(x, 0, 1.0, at(axes + 3 * first))
            if moment:
                _turn(x, 3, 0.5, at(axes + 3 * first))
        while add < fold.pair_end[pair]:
            to, factor = at(K_C + fold.row[add, 0]), fold.factor[add, 0]
            anti, sign = at(skew + max(fold.row[add, 1], 0)), fold.factor[add, 1]
            if fold.given:
                g1, g2 = at(rows.factors + fold.row[add, 2]), at(rows.factors + fold.row[add, 3])
                for k in range(BLOCK):
                    by = x[g1 + k] * x[g2 + k]
                    x[to + k] += factor * by * _dot(x, TURNED * BLOCK, v2, k)
                    if moment and first != second:
                        half = by * _dot(x, (TURNED + 3) * BLOCK, w2, k)
                        x[to + k] += factor * half
                        x[anti + k] += sign * half
                add += 1
                continue
            for k in range(BLOCK):
                x[to + k] += factor * _dot(x, TURNED * BLOCK, v2, k)
            for k in range(BLOCK if moment and first != second else 0):
                half = _dot(x, (TURNED + 3) * BLOCK, w2, k)
                x[to + k] += factor * half
                x[anti + k] += sign * half
            add += 1
    for bend in range(fold.bend.shape[0] if force or moment else 0):
        joint, to = fold.bend[bend, 0], at(K_C + fold.bend[bend, 1])
        w, v, by = at(axes + 3 * joint), at(levers + 3 * joint), at(rows.bends + bend)
        for i in range(3):
            f, g = (LOAD + i) * BLOCK, (LOAD + 3 + i) * BLOCK
            for k in range(BLOCK):
                torque = x[f + k] * x[v + i * BLOCK + k]
                if moment:
                    torque += x[g + k] * x[w + i * BLOCK + k]
                x[to + k] += x[by + k] * torque


@part
def _dot(x: Array, a: int, b: int, k: int) -> float:
    """Scalar product of two vectors of 3 rows at one pose."""
    product = x[a + k] * x[b + k] + x[a + BLOCK + k] * x[b + BLOCK + k]
    return float(product + x[a + 2 * BLOCK + k] * x[b + 2 * BLOCK + k])


@part
def _turn(x: Array, which: int, scale: float, w: int) -> None:
    """scale · F × w (which = 0) or scale · M × w (which = 3) into TURNED."""
    f, to = at(LOAD + which), at(TURNED + which)
    for k in range(BLOCK):
        fx, fy, fz = x[f + k], x[f + BLOCK + k], x[f + 2 * BLOCK + k]
        wx, wy, wz = x[w + k], x[w + BLOCK + k], x[w + 2 * BLOCK + k]
        x[to + k] = scale * (fy * wz - fz * wy)
        x[to + BLOCK + k] = scale * (fz * wx - fx * wz)
        x[to + 2 * BLOCK + k] = scale * (fx * wy - fy * wx)


@part
def factorise(fold: Fold, rows: Scratch, K_C: int) -> None:
    """L D Lᵀ = K_θ − K_C (symmetric part) in rows L, D on the diagonal, without exchanges.

    Row SAFE becomes Π d_k / K_kk, the determinant of K_θ − K_C scaled to a unit diagonal, or -1
    where a pivot is not positive: such poses are solved again with exchanges.
    """
    s, x, L = fold.soft.shape[0], rows.x, rows.L
    for element in range(s * (s + 1) // 2):
        source, target, row = at(K_C + element), at(L + element), at(rows.springs + element)
        spring = fold.springs[element]
        for k in range(BLOCK):
            x[target + k] = (x[row + k] if fold.given else spring) - x[source + k]
    for k in range(BLOCK):
        x[SAFE * BLOCK + k] = 1.0
    for c in range(s):
        element = c * (c + 1) // 2 + c
        pivot, own, row = at(L + element), at(K_C + element), at(rows.springs + element)
        spring = fold.springs[element]
        for k in range(BLOCK):
            safe, d = x[SAFE * BLOCK + k], x[pivot + k]
            by, size = 1.0 / d, x[row + k] if fold.given else spring
            good = (safe > 0.0) & (d > 0.0)
            x[SAFE * BLOCK + k] = safe * d / (size - x[own + k]) if good else -1.0
            x[INVERSE * BLOCK + k] = by
        for i in range(s - 1, c, -1):  # downwards: element (j, c) is still unscaled for j <= i
            row = L + i * (i + 1) // 2
            scaled = at(row + c)
            for k in range(BLOCK):
                x[FACTOR * BLOCK + k] = x[scaled + k] * x[INVERSE * BLOCK + k]
            for j in range(c + 1, i + 1):
                to, other = at(row + j), at(L + j * (j + 1) // 2 + c)
                for k in range(BLOCK):
                    x[to + k] -= x[FACTOR * BLOCK + k] * x[other + k]
            for k in range(BLOCK):
                x[scaled + k] = x[FACTOR * BLOCK + k]


@part
def compliance(fold: Fold, rows: Scratch) -> None:
    """Rows TENSOR of C = J K⁻¹ Jᵀ = Σ_k y_k y_kᵀ / d_k with L y = Jᵀ."""
    s, x, L, y = fold.soft.shape[0], rows.x, rows.L, rows.y
    for k in range(TENSOR * BLOCK, (TENSOR + 9) * BLOCK):
        x[k] = 0.0
    for i in range(s):
        own, column = at(y + 3 * i), at(rows.columns + 3 * fold.soft[i])
        for k in range(3 * BLOCK):
            x[own + k] = x[column + k]
        for j in range(i):
            other, factor = at(y + 3 * j), at(L + i * (i + 1) // 2 + j)
            for k in range(BLOCK):
                f = x[factor + k]
                x[own + k] -= f * x[other + k]
                x[own + BLOCK + k] -= f * x[other + BLOCK + k]
                x[own + 2 * BLOCK + k] -= f * x[other + 2 * BLOCK + k]
        pivot = at(L + i * (i + 1) // 2 + i)
        for k in range(BLOCK):
            d = 1.0 / x[pivot + k]
            a, b, c = x[own + k], x[own + BLOCK + k], x[own + 2 * BLOCK + k]
            x[TENSOR * BLOCK + k] += d * a * a
            x[(TENSOR + 1) * BLOCK + k] += d * a * b
            x[(TENSOR + 2) * BLOCK + k] += d * a * c
            x[(TENSOR + 4) * BLOCK + k] += d * b * b
            x[(TENSOR + 5) * BLOCK + k] += d * b * c
            x[(TENSOR + 8) * BLOCK + k] += d * c * c
    for k in range(BLOCK):
        x[(TENSOR + 3) * BLOCK + k] = x[(TENSOR + 1) * BLOCK + k]
        x[(TENSOR + 6) * BLOCK + k] = x[(TENSOR + 2) * BLOCK + k]
        x[(TENSOR + 7) * BLOCK + k] = x[(TENSOR + 5) * BLOCK + k]


@part
def complementary_of_pose(x: Array, s: int, K_C: int, skew: int, pose: int, A: Array) -> None:
    """K_C of one pose as a full matrix A (s, s); its symmetric part if `skew` is negative."""
    for i in range(s):
        for j in range(i + 1):
            A[i, j] = A[j, i] = x[at(K_C + i * (i + 1) // 2 + j) + pose]
            if skew >= 0 and j < i:
                half = x[at(skew + i * (i - 1) // 2 + j) + pose]
                A[i, j] += half
                A[j, i] -= half


@part
def subtract_from_springs(rows: Scratch, pose: int, A: Array) -> None:
    """A ← K_θ − A at one pose."""
    for i in range(A.shape[0]):
        for j in range(i + 1):
            spring = rows.x[at(rows.springs + i * (i + 1) // 2 + j) + pose]
            A[i, j] = spring - A[i, j]
            if j < i:
                A[j, i] = spring - A[j, i]


@part
def whitener_of(A: Array) -> bool:
    """A (s, s) ← L⁻¹ with L Lᵀ = A; false where A is not positive definite."""
    s = A.shape[0]
    for j in range(s):
        for i in range(j, s):
            total = A[i, j]
            for k in range(j):
                total -= A[i, k] * A[j, k]
            if i == j:
                if not total > 0.0:
                    return False
                A[j, j] = math.sqrt(total)
            else:
                A[i, j] = total / A[j, j]
    for j in range(s):
        A[j, j] = 1.0 / A[j, j]
        for i in range(j + 1, s):
            total = 0.0
            for k in range(j, i):
                total += A[i, k] * A[k, j]
            A[i, j] = -total / A[i, i]
            A[j, i] = 0.0
    return True


@part
def deflect(x: Array) -> None:
    """Rows DEFLECTION of a force alone: C F."""
    for i in range(3):
        c, to = (TENSOR + 3 * i) * BLOCK, (DEFLECTION + i) * BLOCK
        for k in range(BLOCK):
            near = x[c + k] * x[LOAD * BLOCK + k] + x[c + BLOCK + k] * x[(LOAD + 1) * BLOCK + k]
            x[to + k] = near + x[c + 2 * BLOCK + k] * x[(LOAD + 2) * BLOCK + k]


@part
def torques_of_pose(fold: Fold, rows: Scratch, pose: int, b: Array) -> None:
    """Last column of b (s, 4): torques of the load on the soft coordinates, Jᵀ W."""
    x, axes, levers = rows.x, rows.axes, rows.levers
    for i in range(fold.soft.shape[0]):
        b[i, 3] = 0.0
    for entry in range(fold.column_joint.shape[0]):
        joint, i = fold.column_joint[entry], fold.column_soft[entry]
        if i < 0:
            continue
        torque = 0.0
        for c in range(3):
            v, w = x[at(levers + 3 * joint + c) + pose], x[at(axes + 3 * joint + c) + pose]
            force, moment = x[(LOAD + c) * BLOCK + pose], x[(LOAD + 3 + c) * BLOCK + pose]
            torque += v * force + w * moment
        b[i, 3] += factor_of(fold, rows, entry, pose) * torque


@part
def factor_of(fold: Fold, rows: Scratch, entry: int, pose: int) -> float:
    """An entry of the map from coordinates to joints at one pose."""
    if fold.given:
        return float(rows.x[at(rows.factors + entry) + pose])
    return float(fold.column_factor[entry])


@part
def solve_pose(fold: Fold, rows: Scratch, pose: int, A: Array, b: Array) -> None:
    """Rows TENSOR and DEFLECTION of one pose by Gaussian elimination with exchanges.

    A is K and b (s, 4) holds the torques of the load in its last column; NaN where A is singular.
    """
    s, x = fold.soft.shape[0], rows.x
    for i in range(s):
        for c in range(3):
            b[i, c] = x[at(rows.columns + 3 * fold.soft[i] + c) + pose]
    for c in range(s):
        best = c
        for i in range(c + 1, s):
            if abs(A[i, c]) > abs(A[best, c]):
                best = i
        if A[best, c] == 0.0:
            for i in range(9):
                x[(TENSOR + i) * BLOCK + pose] = np.nan
            for i in range(3):
                x[(DEFLECTION + i) * BLOCK + pose] = np.nan
            return
        if best != c:
            for j in range(s):
                A[c, j], A[best, j] = A[best, j], A[c, j]
            for j in range(4):
                b[c, j], b[best, j] = b[best, j], b[c, j]
        for i in range(c + 1, s):
            f = A[i, c] / A[c, c]
            for j in range(c + 1, s):
                A[i, j] -= f * A[c, j]
            for j in range(4):
                b[i, j] -= f * b[c, j]
    for i in range(s - 1, -1, -1):
        for c in range(4):
            value = b[i, c]
            for j in range(i + 1, s):
                value -= A[i, j] * b[j, c]
            b[i, c] = value / A[i, i]
    for r in range(3):
        for c in range(4):
            value = 0.0
            for i in range(s):
                value += x[at(rows.columns + 3 * fold.soft[i] + r) + pose] * b[i, c]
            row = TENSOR + 3 * r + c if c < 3 else DEFLECTION + r
            x[row * BLOCK + pose] = value
