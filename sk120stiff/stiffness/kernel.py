"""The compiled batch kernel: kinematics, K_C, compliance and principal values of many poses.

Poses are worked on in blocks of `LANES`. The scratch memory holds one row of `LANES` numbers per
scalar of the formulas, so every inner loop runs over the lanes of some rows and the compiler turns
it into vector instructions. Nothing is allocated per pose. What goes in is prepared in `folding`,
what comes out is described in `batch`. This is the only file that imports numba.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from sk120stiff.robot.coupling import Array

logger = logging.getLogger(__name__)

LANES = 32
# Rows with fixed places: rotation by columns, position, joint value, its sine and cosine, force and
# moment, F × w and M × w, a symmetric 3×3, its eigenvalues and vectors, a safety margin.
_R, _P, _Q, _SIN, _COS, _LOAD, _FW, _MW, _T, _VALUE, _VECTOR, _SAFE, _FREE = (
    0, 9, 12, 13, 14, 15, 21, 24, 27, 36, 39, 48, 49,
)  # fmt: skip

_PD, _PSD, _ND, _NSD, _ID = range(5)  # indices into `principal.CLASSES`
_ZERO = 1e-12  # share of the largest below which an eigenvalue counts as zero, as in `principal`

# π/2 in three parts, the first two short enough that n times them is exact.
_QUARTER_1, _QUARTER_2, _QUARTER_3 = (
    float.fromhex(part)
    for part in ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69")
)


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """numba.njit whose result is kept on disk wherever some folder for it can be written to."""
    options = {"nogil": True, "error_model": "numpy", "fastmath": {"contract", "nsz"}}
    try:
        return numba.njit(cache=True, **options)(function)  # type: ignore[no-any-return]
    except RuntimeError:
        logger.info(
            "Compiled code cannot be kept, so it is compiled anew in every process: no folder for "
            "it can be written to. Set NUMBA_CACHE_DIR to one that can."
        )
        return numba.njit(**options)(function)  # type: ignore[no-any-return]


@_compiled
def _at(row: int) -> int:
    """Where a row begins. The mask tells the compiler that it is never negative."""
    return (row * LANES) & 0x7FFFFFFF


@_compiled
def _sine_cosine(x: Array, offset: float) -> None:
    """Rows _SIN and _COS of the angles _Q + offset, to an ulp for |angle| ≤ 1e5.

    Chebyshev fits of (sin r − r)/r³ and (cos r − 1 + r²/2)/r⁴ in r² on |r| ≤ π/4.
    """
    for k in range(LANES):
        angle = x[_Q * LANES + k] + offset
        n = math.floor(angle * (2.0 / math.pi) + 0.5)
        r = ((angle - n * _QUARTER_1) - n * _QUARTER_2) - n * _QUARTER_3
        z = r * r
        s = -2.505112794596564e-08 + z * 1.591784866512194e-10
        s = -0.00019841269836722437 + z * (2.755731608382574e-06 + z * s)
        s = r + r * z * (-0.16666666666666666 + z * (0.008333333333330925 + z * s))
        c = 2.0876143829213935e-09 + z * -1.1382456865840483e-11
        c = 2.480158729874308e-05 + z * (-2.755731726001471e-07 + z * c)
        c = 0.041666666666666664 + z * (-0.0013888888888887382 + z * c)
        c = 1.0 - 0.5 * z + z * z * c
        quadrant = n - 4.0 * math.floor(0.25 * n)
        following = n + 1.0 - 4.0 * math.floor(0.25 * (n + 1.0))
        odd = n - 2.0 * math.floor(0.5 * n)
        first = s if odd == 0.0 else c
        second = c if odd == 0.0 else s
        x[_SIN * LANES + k] = first if quadrant < 2.0 else -first
        x[_COS * LANES + k] = second if following < 2.0 else -second


@_compiled
def _sweep(x: Array, fold: Any, pose: int, axes: int, levers: int) -> None:
    """Joint axes w_k (rows `axes`) and v_k = w_k × (point − origin_k) (rows `levers`).

    Frames are chosen so that every joint turns or slides along its z, and the way to the next is a
    shift and a turn about x: only two columns of the rotation change at a time.
    """
    m = fold.kind.shape[0]
    for i in range(9):
        for k in range(LANES):
            x[(_R + i) * LANES + k] = fold.start[i]
    for i in range(3):
        for k in range(LANES):
            x[(_P + i) * LANES + k] = 0.0
    for joint in range(m):
        b = fold.value[joint]
        for k in range(LANES):
            x[_Q * LANES + k] = b
        for i in range(fold.pose_map.shape[1]):
            factor = fold.pose_map[joint, i]
            if factor != 0.0:
                a = _at(pose + i)
                for k in range(LANES):
                    x[_Q * LANES + k] += factor * x[a + k]
        tx, ty, tz = fold.shift[joint, 0], fold.shift[joint, 1], fold.shift[joint, 2]
        c, s = fold.tilt[joint, 0], fold.tilt[joint, 1]
        slides = fold.slides[joint]
        w, o = _at(axes + 3 * joint), _at(levers + 3 * joint)
        for k in range(LANES):
            step = slides * x[_Q * LANES + k]
            for i in range(3):
                rx = x[(_R + i) * LANES + k]
                ry = x[(_R + 3 + i) * LANES + k]
                rz = x[(_R + 6 + i) * LANES + k]
                p = x[(_P + i) * LANES + k] + (rx * tx + ry * ty + rz * tz)
                y, z = c * ry + s * rz, c * rz - s * ry
                x[(_R + 3 + i) * LANES + k] = y
                x[(_R + 6 + i) * LANES + k] = z
                p += step * z
                x[(_P + i) * LANES + k] = p
                x[w + i * LANES + k] = z
                x[o + i * LANES + k] = p
        if fold.kind[joint] == 2:
            continue
        if fold.kind[joint] == 1:
            c, s = fold.constant[joint, 0], fold.constant[joint, 1]
            for k in range(LANES):
                x[_COS * LANES + k] = c
                x[_SIN * LANES + k] = s
        else:
            _sine_cosine(x, fold.offset[joint])
        for k in range(LANES):
            cq, sq = x[_COS * LANES + k], x[_SIN * LANES + k]
            for i in range(3):
                rx, ry = x[(_R + i) * LANES + k], x[(_R + 3 + i) * LANES + k]
                x[(_R + i) * LANES + k] = cq * rx + sq * ry
                x[(_R + 3 + i) * LANES + k] = cq * ry - sq * rx
    tx, ty, tz = fold.shift[m, 0], fold.shift[m, 1], fold.shift[m, 2]
    for k in range(LANES):
        for i in range(3):
            rx, ry = x[(_R + i) * LANES + k], x[(_R + 3 + i) * LANES + k]
            x[(_P + i) * LANES + k] += rx * tx + ry * ty + x[(_R + 6 + i) * LANES + k] * tz
    for joint in range(m):
        w, o = _at(axes + 3 * joint), _at(levers + 3 * joint)
        turns = 1.0 - fold.slides[joint]
        slides = fold.slides[joint]
        for k in range(LANES):
            wx, wy, wz = x[w + k], x[w + LANES + k], x[w + 2 * LANES + k]
            rx = x[_P * LANES + k] - x[o + k]
            ry = x[(_P + 1) * LANES + k] - x[o + LANES + k]
            rz = x[(_P + 2) * LANES + k] - x[o + 2 * LANES + k]
            x[o + k] = turns * (wy * rz - wz * ry) + slides * wx
            x[o + LANES + k] = turns * (wz * rx - wx * rz) + slides * wy
            x[o + 2 * LANES + k] = turns * (wx * ry - wy * rx) + slides * wz
            x[w + k], x[w + LANES + k], x[w + 2 * LANES + k] = turns * wx, turns * wy, turns * wz


@_compiled
def _columns(x: Array, fold: Any, n: int, levers: int, columns: int) -> None:
    """Linear part of every column of J, 3 rows each."""
    start = _at(columns)
    for k in range(3 * n * LANES):
        x[start + k] = 0.0
    for entry in range(fold.column_joint.shape[0]):
        v = _at(levers + 3 * fold.column_joint[entry])
        column = _at(columns + 3 * fold.column_coordinate[entry])
        factor = fold.column_factor[entry]
        for k in range(3 * LANES):
            x[column + k] += factor * x[v + k]


@_compiled
def _subtract_K_C(x: Array, fold: Any, axes: int, levers: int, K: int, skew: int, moment: bool) -> None:
    """Rows K (lower triangle) of K_θ − K_C, symmetric part, and the skew part of −K_C."""
    s = fold.soft.shape[0]
    for element in range(s * (s + 1) // 2):
        to, spring = _at(K + element), fold.springs[element]
        for k in range(LANES):
            x[to + k] = spring
    if moment:
        start = _at(skew)
        for k in range(s * (s - 1) // 2 * LANES):
            x[start + k] = 0.0
    add, last = 0, -1
    for pair in range(fold.pair.shape[0]):
        first, second = fold.pair[pair, 0], fold.pair[pair, 1]
        w1 = _at(axes + 3 * first)
        w2, v2 = _at(axes + 3 * second), _at(levers + 3 * second)
        if first != last:
            last = first
            for part in range(2 if moment else 1):
                f, fw = _at(_LOAD + 3 * part), _at(_FW + 3 * part)
                scale = 1.0 - 0.5 * part
                for k in range(LANES):
                    fx, fy, fz = x[f + k], x[f + LANES + k], x[f + 2 * LANES + k]
                    wx, wy, wz = x[w1 + k], x[w1 + LANES + k], x[w1 + 2 * LANES + k]
                    x[fw + k] = scale * (fy * wz - fz * wy)
                    x[fw + LANES + k] = scale * (fz * wx - fx * wz)
                    x[fw + 2 * LANES + k] = scale * (fx * wy - fy * wx)
        while add < fold.pair_end[pair]:
            to = _at(K + fold.row[add])
            factor = fold.factor[add]
            for k in range(LANES):
                x[to + k] -= factor * (
                    x[_FW * LANES + k] * x[v2 + k]
                    + x[(_FW + 1) * LANES + k] * x[v2 + LANES + k]
                    + x[(_FW + 2) * LANES + k] * x[v2 + 2 * LANES + k]
                )
            if moment and first != second:
                skewed = fold.skew_row[add]
                anti = _at(skew + max(skewed, 0))
                skew_factor = fold.skew_factor[add]
                for k in range(LANES):
                    half = (
                        x[_MW * LANES + k] * x[w2 + k]
                        + x[(_MW + 1) * LANES + k] * x[w2 + LANES + k]
                        + x[(_MW + 2) * LANES + k] * x[w2 + 2 * LANES + k]
                    )
                    x[to + k] -= factor * half
                    x[anti + k] -= skew_factor * half
            add += 1


@_compiled
def _factor(x: Array, s: int, K: int, L: int) -> None:
    """L D Lᵀ of the lower triangle K into rows L (D on the diagonal), without exchanges.

    Row _SAFE becomes Π d_k / K_kk, the determinant of K scaled to a unit diagonal, or -1 where a
    pivot is not positive: such lanes are done again with exchanges.
    """
    source, target = _at(K), _at(L)
    for k in range(s * (s + 1) // 2 * LANES):
        x[target + k] = x[source + k]
    for k in range(LANES):
        x[_SAFE * LANES + k] = 1.0
    for c in range(s):
        pivot = _at(L + c * (c + 1) // 2 + c)
        diagonal = _at(K + c * (c + 1) // 2 + c)
        for k in range(LANES):
            safe, d = x[_SAFE * LANES + k], x[pivot + k]
            good = (safe > 0.0) & (d > 0.0)
            x[_SAFE * LANES + k] = safe * (d / x[diagonal + k]) if good else -1.0
            x[_SIN * LANES + k] = 1.0 / d
        for i in range(s - 1, c, -1):  # downwards: A[j, c] is still unscaled for every j <= i
            row = L + i * (i + 1) // 2
            scaled = _at(row + c)
            for k in range(LANES):
                x[_COS * LANES + k] = x[scaled + k] * x[_SIN * LANES + k]
            for j in range(c + 1, i + 1):
                to, other = _at(row + j), _at(L + j * (j + 1) // 2 + c)
                for k in range(LANES):
                    x[to + k] -= x[_COS * LANES + k] * x[other + k]
            for k in range(LANES):
                x[scaled + k] = x[_COS * LANES + k]


@_compiled
def _compliance(x: Array, soft: Any, columns: int, L: int, y: int) -> None:
    """Rows _T of C = J K⁻¹ Jᵀ = Σ_k y_k y_kᵀ / d_k with L y = Jᵀ."""
    s = soft.shape[0]
    for k in range(_T * LANES, (_T + 9) * LANES):
        x[k] = 0.0
    for i in range(s):
        own, column = _at(y + 3 * i), _at(columns + 3 * soft[i])
        for k in range(3 * LANES):
            x[own + k] = x[column + k]
        for j in range(i):
            other, factor = _at(y + 3 * j), _at(L + i * (i + 1) // 2 + j)
            for k in range(LANES):
                f = x[factor + k]
                x[own + k] -= f * x[other + k]
                x[own + LANES + k] -= f * x[other + LANES + k]
                x[own + 2 * LANES + k] -= f * x[other + 2 * LANES + k]
        pivot = _at(L + i * (i + 1) // 2 + i)
        for k in range(LANES):
            d = 1.0 / x[pivot + k]
            a, b, c = x[own + k], x[own + LANES + k], x[own + 2 * LANES + k]
            x[_T * LANES + k] += d * a * a
            x[(_T + 1) * LANES + k] += d * a * b
            x[(_T + 2) * LANES + k] += d * a * c
            x[(_T + 4) * LANES + k] += d * b * b
            x[(_T + 5) * LANES + k] += d * b * c
            x[(_T + 8) * LANES + k] += d * c * c
    for k in range(LANES):
        x[(_T + 3) * LANES + k] = x[(_T + 1) * LANES + k]
        x[(_T + 6) * LANES + k] = x[(_T + 2) * LANES + k]
        x[(_T + 7) * LANES + k] = x[(_T + 5) * LANES + k]
