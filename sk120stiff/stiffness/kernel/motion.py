"""From joint values to joint axes, levers and the columns of J, for a block of poses."""

from __future__ import annotations

import math

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel.compiled import part
from sk120stiff.stiffness.kernel.folding import CONSTANT, NONE, Fold
from sk120stiff.stiffness.kernel.layout import (
    BLOCK,
    CHANGE,
    COSINE,
    POSITION,
    ROTATION,
    SAFE,
    SINE,
    TURNED,
    VALUE,
    Scratch,
    at,
)

LONGEST_STEP = 0.5  # rad or m of a sagging arm: beyond it Newton cannot be trusted
# π/2 in three parts, the first two short enough that n times them is exact.
_QUARTER_1, _QUARTER_2, _QUARTER_3 = (
    float.fromhex(digits)
    for digits in ("0x1.921fb54400000p+0", "0x1.0b4611a600000p-34", "0x1.3198a2e037073p-69")
)


@part
def sine_cosine(x: Array, offset: float) -> None:
    """Rows SINE and COSINE of the angles VALUE + offset, to an ulp for |angle| ≤ 1e5.

    Chebyshev fits of (sin r − r)/r³ and (cos r − 1 + r²/2)/r⁴ in r² on |r| ≤ π/4.
    """
    for k in range(BLOCK):
        angle = x[VALUE * BLOCK + k] + offset
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
        x[SINE * BLOCK + k] = first if quadrant < 2.0 else -first
        x[COSINE * BLOCK + k] = second if following < 2.0 else -second


@part
def place_joints(fold: Fold, rows: Scratch) -> None:
    """Joint axes (rows `axes`), joint origins (rows `levers`), and the position of the point.

    A joint that slides has no angular axis: its direction stands in rows `levers` at once.

    Frames are chosen so that every joint turns or slides along its z, and the way to the next is a
    shift and a turn about x: only two columns of the rotation change at a time. Rows `carried`
    become mass times centre of what each joint carries.
    """
    m, x, pose, axes, levers = fold.kind.shape[0], rows.x, rows.pose, rows.axes, rows.levers
    for i in range(9):
        entry = fold.start[i]
        for k in range(BLOCK):
            x[(ROTATION + i) * BLOCK + k] = entry
    for k in range(3 * BLOCK):
        x[POSITION * BLOCK + k] = 0.0
    for joint in range(m):
        value = fold.value[joint]
        for k in range(BLOCK):
            x[VALUE * BLOCK + k] = value
        for i in range(fold.pose_map.shape[1] if fold.weighs else fold.inputs):
            factor = fold.pose_map[joint, i]
            if factor != 0.0:
                a = at(pose + i)
                for k in range(BLOCK):
                    x[VALUE * BLOCK + k] += factor * x[a + k]
        tx, ty, tz = fold.shift[joint, 0], fold.shift[joint, 1], fold.shift[joint, 2]
        c, s, slides = fold.tilt[joint, 0], fold.tilt[joint, 1], fold.slides[joint]
        for i in range(3):
            w, o = at(axes + 3 * joint + i), at(levers + 3 * joint + i)
            for k in range(BLOCK):
                rx = x[(ROTATION + i) * BLOCK + k]
                ry = x[(ROTATION + 3 + i) * BLOCK + k]
                rz = x[(ROTATION + 6 + i) * BLOCK + k]
                along = c * rz - s * ry
                p = x[(POSITION + i) * BLOCK + k] + (rx * tx + ry * ty + rz * tz)
                p += slides * x[VALUE * BLOCK + k] * along
                x[(ROTATION + 3 + i) * BLOCK + k] = c * ry + s * rz
                x[(ROTATION + 6 + i) * BLOCK + k] = along
                x[(POSITION + i) * BLOCK + k] = p
                x[w + k] = along
                x[o + k] = p
        if fold.kind[joint] == CONSTANT:
            c, s = fold.constant[joint, 0], fold.constant[joint, 1]
            for k in range(BLOCK):
                x[COSINE * BLOCK + k] = c
                x[SINE * BLOCK + k] = s
        elif fold.kind[joint] != NONE:
            sine_cosine(x, fold.offset[joint])
        for i in range(3 if fold.kind[joint] != NONE else 0):
            for k in range(BLOCK):
                cq, sq = x[COSINE * BLOCK + k], x[SINE * BLOCK + k]
                rx, ry = x[(ROTATION + i) * BLOCK + k], x[(ROTATION + 3 + i) * BLOCK + k]
                x[(ROTATION + i) * BLOCK + k] = cq * rx + sq * ry
                x[(ROTATION + 3 + i) * BLOCK + k] = cq * ry - sq * rx
        if slides:
            w, o = at(axes + 3 * joint), at(levers + 3 * joint)
            for k in range(3 * BLOCK):
                x[o + k] = x[w + k]
                x[w + k] = 0.0
        if fold.weighs:
            mass = fold.mass[joint]
            _go(x, fold.centre[joint, 0], fold.centre[joint, 1], fold.centre[joint, 2])
            to = at(rows.carried + 3 * joint)
            for k in range(3 * BLOCK):
                x[to + k] = mass * x[TURNED * BLOCK + k]
    _go(x, fold.shift[m, 0], fold.shift[m, 1], fold.shift[m, 2])
    for k in range(3 * BLOCK):
        x[POSITION * BLOCK + k] = x[TURNED * BLOCK + k]


@part
def _go(x: Array, tx: float, ty: float, tz: float) -> None:
    """Rows TURNED = position + rotation · t."""
    for i in range(3):
        for k in range(BLOCK):
            rx, ry = x[(ROTATION + i) * BLOCK + k], x[(ROTATION + 3 + i) * BLOCK + k]
            moved = rx * tx + ry * ty + x[(ROTATION + 6 + i) * BLOCK + k] * tz
            x[(TURNED + i) * BLOCK + k] = x[(POSITION + i) * BLOCK + k] + moved


@part
def turn_levers(fold: Fold, rows: Scratch) -> None:
    """Rows `levers` from joint origins to v_k = w_k × (point − origin_k)."""
    x, axes, levers = rows.x, rows.axes, rows.levers
    for joint in range(fold.kind.shape[0]):
        if fold.slides[joint]:
            continue
        w, o = at(axes + 3 * joint), at(levers + 3 * joint)
        for k in range(BLOCK):
            wx, wy, wz = x[w + k], x[w + BLOCK + k], x[w + 2 * BLOCK + k]
            rx = x[POSITION * BLOCK + k] - x[o + k]
            ry = x[(POSITION + 1) * BLOCK + k] - x[o + BLOCK + k]
            rz = x[(POSITION + 2) * BLOCK + k] - x[o + 2 * BLOCK + k]
            x[o + k] = wy * rz - wz * ry
            x[o + BLOCK + k] = wz * rx - wx * rz
            x[o + 2 * BLOCK + k] = wx * ry - wy * rx


@part
def carry(fold: Fold, rows: Scratch) -> None:
    """Rows `carried`: w × Σ m (c − o) of all that the joint carries, or axis · Σ m for a slide."""
    x, axes, levers = rows.x, rows.axes, rows.levers
    for k in range(3 * BLOCK):
        x[TURNED * BLOCK + k] = 0.0
    total = 0.0
    for joint in range(fold.mass.shape[0] - 1, -1, -1):
        total += fold.mass[joint]
        w, o, own = at(axes + 3 * joint), at(levers + 3 * joint), at(rows.carried + 3 * joint)
        for k in range(3 * BLOCK):
            x[TURNED * BLOCK + k] += x[own + k]
        if fold.slides[joint]:
            for k in range(3 * BLOCK):
                x[own + k] = total * x[o + k]
            continue
        for k in range(BLOCK):
            wx, wy, wz = x[w + k], x[w + BLOCK + k], x[w + 2 * BLOCK + k]
            rx = x[TURNED * BLOCK + k] - total * x[o + k]
            ry = x[(TURNED + 1) * BLOCK + k] - total * x[o + BLOCK + k]
            rz = x[(TURNED + 2) * BLOCK + k] - total * x[o + 2 * BLOCK + k]
            x[own + k] = wy * rz - wz * ry
            x[own + BLOCK + k] = wz * rx - wx * rz
            x[own + 2 * BLOCK + k] = wx * ry - wy * rx


@part
def sag(fold: Fold, rows: Scratch) -> float:
    """One step of Newton towards rest under the weight, K_θ δ = τ_g(z₀ + δ); the largest change.

    Rows `bent` hold δ, rows L the factors of K_θ − K_g, rows `carried` what the joints carry. Where
    K_θ − K_g is not positive definite the arm falls, and its coordinates become NaN.
    """
    gx, gy, gz = fold.gravity[0], fold.gravity[1], fold.gravity[2]
    s, x, carried, bent, L, y = (
        fold.soft.shape[0],
        rows.x,
        rows.carried,
        rows.bent,
        rows.L,
        rows.y,
    )
    for i in range(s):
        to = at(y + i)
        for k in range(BLOCK):
            x[to + k] = 0.0
        for joint in range(fold.mass.shape[0]):
            factor = fold.pose_map[joint, fold.soft[i]]
            if factor != 0.0:
                own = at(carried + 3 * joint)
                for k in range(BLOCK):
                    along = gx * x[own + k] + gy * x[own + BLOCK + k] + gz * x[own + 2 * BLOCK + k]
                    x[to + k] += factor * along
        for j in range(s):
            spring = fold.springs[max(i, j) * (max(i, j) + 1) // 2 + min(i, j)]
            if spring != 0.0:
                other = at(bent + j)
                for k in range(BLOCK):
                    x[to + k] -= spring * x[other + k]
        for j in range(i):
            other, factor_row = at(y + j), at(L + i * (i + 1) // 2 + j)
            for k in range(BLOCK):
                x[to + k] -= x[factor_row + k] * x[other + k]
    for k in range(BLOCK):
        x[CHANGE * BLOCK + k] = 0.0
    for i in range(s - 1, -1, -1):
        to, pivot = at(y + i), at(L + i * (i + 1) // 2 + i)
        for k in range(BLOCK):
            x[to + k] /= x[pivot + k]
        for j in range(i + 1, s):
            other, factor_row = at(y + j), at(L + j * (j + 1) // 2 + i)
            for k in range(BLOCK):
                x[to + k] -= x[factor_row + k] * x[other + k]
        for k in range(BLOCK):
            x[CHANGE * BLOCK + k] = max(x[CHANGE * BLOCK + k], abs(x[to + k]))
    for i in range(s):
        z, own, step = at(rows.pose + fold.soft[i]), at(bent + i), at(y + i)
        for k in range(BLOCK):
            change = x[step + k] * min(1.0, LONGEST_STEP / max(x[CHANGE * BLOCK + k], 1e-300))
            change = change if x[SAFE * BLOCK + k] > 0.0 else math.nan
            x[own + k] += change
            x[z + k] += change
    largest = 0.0
    for k in range(BLOCK):
        if not x[SAFE * BLOCK + k] > 0.0:
            x[CHANGE * BLOCK + k] = 0.0
        largest = max(largest, x[CHANGE * BLOCK + k])
    return largest


@part
def columns_of_J(fold: Fold, rows: Scratch) -> None:
    """Linear part of every column of J, 3 rows each."""
    x, levers, columns = rows.x, rows.levers, rows.columns
    start = at(columns)
    for k in range(3 * fold.n * BLOCK):
        x[start + k] = 0.0
    for entry in range(fold.column_joint.shape[0]):
        v = at(levers + 3 * fold.column_joint[entry])
        column = at(columns + 3 * fold.column_coordinate[entry])
        if fold.given:
            g = at(rows.factors + entry)
            for i in range(0, 3 * BLOCK, BLOCK):
                for k in range(BLOCK):
                    x[column + i + k] += x[g + k] * x[v + i + k]
            continue
        factor = fold.column_factor[entry]
        for k in range(3 * BLOCK):
            x[column + k] += factor * x[v + k]
