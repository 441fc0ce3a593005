"""From joint values to joint axes, levers and the columns of J, for a block of poses."""

from __future__ import annotations

import math

from sk120stiff.arrays import Array
from sk120stiff.stiffness.kernel import part
from sk120stiff.stiffness.lanes.folding import CONSTANT, NONE, Fold
from sk120stiff.stiffness.lanes.layout import (
    CHANGE,
    COSINE,
    LANES,
    POSITION,
    ROTATION,
    SINE,
    TURNED,
    VALUE,
    at,
)

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
    for k in range(LANES):
        angle = x[VALUE * LANES + k] + offset
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
        x[SINE * LANES + k] = first if quadrant < 2.0 else -first
        x[COSINE * LANES + k] = second if following < 2.0 else -second


@part
def place_joints(
    x: Array, fold: Fold, pose: int, axes: int, levers: int, moments: int, weighs: bool
) -> None:
    """Joint axes (rows `axes`), joint origins (rows `levers`), and the position of the point.

    Frames are chosen so that every joint turns or slides along its z, and the way to the next is a
    shift and a turn about x: only two columns of the rotation change at a time. Rows `moments`
    become mass times centre of what each joint carries.
    """
    m = fold.kind.shape[0]
    for i in range(9):
        entry = fold.start[i]
        for k in range(LANES):
            x[(ROTATION + i) * LANES + k] = entry
    for k in range(3 * LANES):
        x[POSITION * LANES + k] = 0.0
    for joint in range(m):
        value = fold.value[joint]
        for k in range(LANES):
            x[VALUE * LANES + k] = value
        for i in range(fold.pose_map.shape[1]):
            factor = fold.pose_map[joint, i]
            if factor != 0.0:
                a = at(pose + i)
                for k in range(LANES):
                    x[VALUE * LANES + k] += factor * x[a + k]
        tx, ty, tz = fold.shift[joint, 0], fold.shift[joint, 1], fold.shift[joint, 2]
        c, s, slides = fold.tilt[joint, 0], fold.tilt[joint, 1], fold.slides[joint]
        for i in range(3):
            w, o = at(axes + 3 * joint + i), at(levers + 3 * joint + i)
            for k in range(LANES):
                rx = x[(ROTATION + i) * LANES + k]
                ry = x[(ROTATION + 3 + i) * LANES + k]
                rz = x[(ROTATION + 6 + i) * LANES + k]
                along = c * rz - s * ry
                p = x[(POSITION + i) * LANES + k] + (rx * tx + ry * ty + rz * tz)
                p += slides * x[VALUE * LANES + k] * along
                x[(ROTATION + 3 + i) * LANES + k] = c * ry + s * rz
                x[(ROTATION + 6 + i) * LANES + k] = along
                x[(POSITION + i) * LANES + k] = p
                x[w + k] = along
                x[o + k] = p
        if fold.kind[joint] == CONSTANT:
            c, s = fold.constant[joint, 0], fold.constant[joint, 1]
            for k in range(LANES):
                x[COSINE * LANES + k] = c
                x[SINE * LANES + k] = s
        elif fold.kind[joint] != NONE:
            sine_cosine(x, fold.offset[joint])
        for i in range(3 if fold.kind[joint] != NONE else 0):
            for k in range(LANES):
                cq, sq = x[COSINE * LANES + k], x[SINE * LANES + k]
                rx, ry = x[(ROTATION + i) * LANES + k], x[(ROTATION + 3 + i) * LANES + k]
                x[(ROTATION + i) * LANES + k] = cq * rx + sq * ry
                x[(ROTATION + 3 + i) * LANES + k] = cq * ry - sq * rx
        if weighs:
            mass = fold.mass[joint]
            _go(x, fold.centre[joint, 0], fold.centre[joint, 1], fold.centre[joint, 2])
            to = at(moments + 3 * joint)
            for k in range(3 * LANES):
                x[to + k] = mass * x[TURNED * LANES + k]
    _go(x, fold.shift[m, 0], fold.shift[m, 1], fold.shift[m, 2])
    for k in range(3 * LANES):
        x[POSITION * LANES + k] = x[TURNED * LANES + k]


@part
def _go(x: Array, tx: float, ty: float, tz: float) -> None:
    """Rows TURNED = position + rotation · t."""
    for i in range(3):
        for k in range(LANES):
            rx, ry = x[(ROTATION + i) * LANES + k], x[(ROTATION + 3 + i) * LANES + k]
            moved = rx * tx + ry * ty + x[(ROTATION + 6 + i) * LANES + k] * tz
            x[(TURNED + i) * LANES + k] = x[(POSITION + i) * LANES + k] + moved


@part
def turn_levers(x: Array, fold: Fold, axes: int, levers: int) -> None:
    """Rows `levers` from joint origins to v_k = w_k × (point − origin_k); a slide has v = w."""
    for joint in range(fold.kind.shape[0]):
        w, o = at(axes + 3 * joint), at(levers + 3 * joint)
        slides = fold.slides[joint]
        turns = 1.0 - slides
        for k in range(LANES):
            wx, wy, wz = x[w + k], x[w + LANES + k], x[w + 2 * LANES + k]
            rx = x[POSITION * LANES + k] - x[o + k]
            ry = x[(POSITION + 1) * LANES + k] - x[o + LANES + k]
            rz = x[(POSITION + 2) * LANES + k] - x[o + 2 * LANES + k]
            x[o + k] = turns * (wy * rz - wz * ry) + slides * wx
            x[o + LANES + k] = turns * (wz * rx - wx * rz) + slides * wy
            x[o + 2 * LANES + k] = turns * (wx * ry - wy * rx) + slides * wz
            x[w + k], x[w + LANES + k], x[w + 2 * LANES + k] = turns * wx, turns * wy, turns * wz


@part
def bend_by_weight(
    x: Array, fold: Fold, pose: int, axes: int, levers: int, moments: int, torques: int, unbent: int
) -> float:
    """Move the soft coordinates to z₀ + C τ(z) with the weight's torques τ; the largest change.

    Rows `torques` are one per joint; rows `unbent` hold z₀.
    """
    gx, gy, gz = fold.gravity[0], fold.gravity[1], fold.gravity[2]
    for k in range(3 * LANES):
        x[TURNED * LANES + k] = 0.0
    total = 0.0
    for joint in range(fold.mass.shape[0] - 1, -1, -1):
        total += fold.mass[joint]
        w, o, own = at(axes + 3 * joint), at(levers + 3 * joint), at(moments + 3 * joint)
        to, slides = at(torques + joint), fold.slides[joint]
        for k in range(3 * LANES):
            x[TURNED * LANES + k] += x[own + k]
        for k in range(LANES):
            wx, wy, wz = x[w + k], x[w + LANES + k], x[w + 2 * LANES + k]
            rx = x[TURNED * LANES + k] - total * x[o + k]
            ry = x[(TURNED + 1) * LANES + k] - total * x[o + LANES + k]
            rz = x[(TURNED + 2) * LANES + k] - total * x[o + 2 * LANES + k]
            turned = gx * (wy * rz - wz * ry) + gy * (wz * rx - wx * rz) + gz * (wx * ry - wy * rx)
            pushed = total * (gx * wx + gy * wy + gz * wz)
            x[to + k] = turned + slides * (pushed - turned)
    s = fold.soft.shape[0]
    largest = 0.0
    for k in range(LANES):
        x[CHANGE * LANES + k] = 0.0
    for i in range(s):
        z, straight = at(pose + fold.soft[i]), at(unbent + fold.soft[i])
        for k in range(LANES):
            x[VALUE * LANES + k] = x[straight + k]
        for j in range(s):
            if fold.sag[i, j] == 0.0:
                continue
            for joint in range(fold.mass.shape[0]):
                factor = fold.sag[i, j] * fold.pose_map[joint, fold.soft[j]]
                if factor != 0.0:
                    tau = at(torques + joint)
                    for k in range(LANES):
                        x[VALUE * LANES + k] += factor * x[tau + k]
        for k in range(LANES):
            step = abs(x[VALUE * LANES + k] - x[z + k])
            x[CHANGE * LANES + k] = max(x[CHANGE * LANES + k], step)
            x[z + k] = x[VALUE * LANES + k]
    for k in range(LANES):
        largest = max(largest, x[CHANGE * LANES + k])
    return largest


@part
def columns_of_J(x: Array, fold: Fold, levers: int, columns: int) -> None:
    """Linear part of every column of J, 3 rows each."""
    start = at(columns)
    for k in range(3 * fold.rest.shape[0] * LANES):
        x[start + k] = 0.0
    for entry in range(fold.column_joint.shape[0]):
        v = at(levers + 3 * fold.column_joint[entry])
        column = at(columns + 3 * fold.column_coordinate[entry])
        factor = fold.column_factor[entry]
        for k in range(3 * LANES):
            x[column + k] += factor * x[v + k]
