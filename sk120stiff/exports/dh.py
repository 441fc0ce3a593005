"""Denavit and Hartenberg's numbers of a calibrated arm, standard and modified, from its axes.

With frames F_k that have their z on the axis of joint k + 1 when all joints stand at zero,

    F_{k-1}⁻¹ F_k = Rz(θ) Tz(d) · C,    C = Tx(a) Ty(b) Rx(α) Ry(β),

and the joint's value adds to θ (to d where it slides). Standard rows hold θ, d of a joint with the
C behind it, modified rows with the C before it: the same numbers.

Two axes that are not parallel have one common normal, so b = β = 0: Denavit and Hartenberg's four.
Where they are nearly parallel the normal runs off along them as 1 / angle, and d with it. Hayati's
four (1983) take its place: d = b = 0, with β the second tilt. Where they nearly coincide, θ is lost
too: θ = d = 0, and a and b are both shifts.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from sk120stiff.arrays import Array

COLUMNS = ("theta", "d", "a", "b", "alpha", "beta")
PARALLEL = 0.05  # rad between axes below which d of a common normal says nothing
COINCIDENT = 0.005  # m between parallel axes below which the direction of a says nothing
_LOCKED = 0.05  # cosine of α below which θ and β of a general turn cannot be told apart

NORMAL, HAYATI, COINCIDING, FREE = "DH", "Hayati", "coincident", "free"


@dataclass(frozen=True)
class Layout:
    """How each row is written; decided once on one geometry, kept for all that are near it.

    Attributes:
        forms: Of the transform behind each joint, one less than there are joints.
        signs: Direction of each common normal against w_k × w_{k+1} (or 1).
        angles: Between consecutive axes [rad].
    """

    forms: tuple[str, ...]
    signs: tuple[float, ...]
    angles: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Lines:
    """Joint axes of an arm at zero: (m, 3) points and unit directions, and (4, 4) the tool frame;
    base axes [m]."""

    points: Array
    directions: Array
    tool: Array


def layout_of(lines: Lines) -> Layout:
    """The forms that suit these axes."""
    forms, signs, angles = [], [], []
    x = _beside(np.eye(3)[0], lines.directions[0])
    for k in range(len(lines.points) - 1):
        w, v = lines.directions[k], lines.directions[k + 1]
        normal = np.cross(w, v)
        sine = float(np.linalg.norm(normal))
        angles.append(float(np.arctan2(sine, abs(w @ v))))
        if angles[-1] > PARALLEL:
            unit = normal / sine
            along = float(unit @ x)
            off = float(unit @ (lines.points[k + 1] - lines.points[k]))
            sign = np.sign(along) if abs(along) > 1e-3 else (-1.0 if off < 0.0 else 1.0)
            forms.append(NORMAL)
            signs.append(float(sign))
            x = unit * sign
            continue
        apart = _beside(lines.points[k + 1] - lines.points[k], w, unit=False)
        signs.append(1.0)
        if np.linalg.norm(apart) < COINCIDENT:
            forms.append(COINCIDING)
            x = _beside(x, v)
        else:
            away = apart / np.linalg.norm(apart)
            signs[-1] = -1.0 if away @ x < -1e-3 else 1.0
            forms.append(HAYATI)
            x = _beside(away * signs[-1], v)
    return Layout(tuple(forms), tuple(signs), tuple(angles))


def rows_of(lines: Lines, layout: Layout) -> Array:
    """(m + 2, 6) `COLUMNS` of base, joints and tool [rad, m]; the last joint's C is the identity.

    The frame behind the last joint stands on its axis, level with the tool; what is left is the
    tool's row.
    """
    F = np.eye(4)
    w = lines.directions[0]
    F[:3, :3] = _frame(_beside(np.eye(3)[0], w), w)
    F[:3, 3] = lines.points[0] - w * (w @ lines.points[0])
    rows = [_free(F)]
    for (k, form), sign in zip(enumerate(layout.forms), layout.signs, strict=True):
        inverse = np.linalg.inv(F)
        point = inverse[:3, :3] @ lines.points[k + 1] + inverse[:3, 3]
        direction = inverse[:3, :3] @ lines.directions[k + 1]
        rows.append(_FORMS[form](point, direction, sign))
        F = F @ transform(rows[-1])
    last = np.linalg.inv(F) @ lines.tool
    level = np.array([0.0, last[2, 3], 0.0, 0.0, 0.0, 0.0])
    rows.append(level)
    rows.append(_free(np.linalg.inv(transform(level)) @ last))
    return np.array(rows)


def transform(row: Array) -> Array:
    """(4, 4) of one row at joint value zero."""
    theta, d, a, b, alpha, beta = row
    (st, sa, sb), (ct, ca, cb) = np.sin([theta, alpha, beta]), np.cos([theta, alpha, beta])
    turn = np.array([[ct, -st, 0.0], [st, ct, 0.0], [0.0, 0.0, 1.0]])
    T = np.eye(4)
    T[:3, :3] = turn @ np.array([[cb, 0.0, sb], [sa * sb, ca, -sa * cb], [-ca * sb, sa, ca * cb]])
    T[:3, 3] = turn @ np.array([a, b, d])
    return T


def locked(row: Array) -> bool:
    """Are θ and β of a general turn hardly told apart?"""
    return bool(abs(np.cos(row[4])) < _LOCKED)


def lines_of(placements: Array, axes: Array) -> Lines:
    """Axes of a chain at zero.

    Args:
        placements: (m + 1, 4, 4) before each joint and to the tool.
        axes: (m, 3) in the joints' frames.
    """
    *joints, tool = accumulate(placements, np.matmul)
    directions = [T[:3, :3] @ axis for T, axis in zip(joints, axes, strict=True)]
    return Lines(np.array([T[:3, 3] for T in joints]), np.array(directions), tool)


def _normal(point: Array, w: Array, sign: float) -> Array:
    """Row to a line (point, direction) whose common normal with z is unique."""
    x = np.array([-w[1], w[0], 0.0]) * sign / np.hypot(w[0], w[1])  # ± z × w
    theta = np.arctan2(x[1], x[0])
    a = float(x @ point)
    y = np.array([-x[1], x[0], 0.0])
    alpha = np.arctan2(-(y @ w), w[2])
    # On the line, where the normal leaves it: p + t w has no part along y but that of the normal.
    t = -(y @ point) / (y @ w)
    return np.array([theta, point[2] + t * w[2], a, 0.0, alpha, 0.0])


def _hayati(point: Array, w: Array, sign: float) -> Array:
    """Row to a line nearly parallel to z: it meets the plane z = 0 at distance a."""
    meets = point - w * (point[2] / w[2])
    theta = np.arctan2(sign * meets[1], sign * meets[0])
    c, s = np.cos(theta), np.sin(theta)
    return _tilted(theta, sign * float(np.hypot(meets[0], meets[1])), 0.0, _turned(w, c, s))


def _coinciding(point: Array, w: Array, sign: float) -> Array:  # noqa: ARG001
    """Row to a line that all but coincides with z: it meets the plane z = 0 at (a, b)."""
    meets = point - w * (point[2] / w[2])
    return _tilted(0.0, float(meets[0]), float(meets[1]), w)


def _tilted(theta: float, a: float, b: float, w: Array) -> Array:
    """The row whose α and β turn z into w, which is seen from behind θ."""
    return np.array([theta, 0.0, a, b, np.arctan2(-w[1], w[2]), np.arcsin(w[0])])


def _turned(w: Array, c: float, s: float) -> Array:
    return np.array([c * w[0] + s * w[1], c * w[1] - s * w[0], w[2]])


def _free(T: Array) -> Array:
    """Row of any transform."""
    R = T[:3, :3]
    alpha = float(np.arctan2(R[2, 1], np.hypot(R[0, 1], R[1, 1])))
    if np.cos(alpha) < 1e-9:
        theta, beta = 0.0, float(np.arctan2(R[0, 2], R[0, 0]))
    else:
        theta = float(np.arctan2(-R[0, 1], R[1, 1]))
        beta = float(np.arctan2(-R[2, 0], R[2, 2]))
    x, y = _turned(T[:3, 3], np.cos(theta), np.sin(theta))[:2]
    return np.array([theta, T[2, 3], x, y, alpha, beta])


_FORMS = {NORMAL: _normal, HAYATI: _hayati, COINCIDING: _coinciding}


def _beside(vector: Array, axis: Array, *, unit: bool = True) -> Array:
    """What of a vector is square to an axis; another direction where nothing is."""
    flat = vector - axis * (axis @ vector)
    if not unit:
        return np.asarray(flat)
    if np.linalg.norm(flat) < 0.1:
        flat = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return np.asarray(flat / np.linalg.norm(flat))


def _frame(x: Array, z: Array) -> Array:
    return np.column_stack([x, np.cross(z, x), z])


def standard_to_modified(rows: Array) -> Array:
    """(m + 2, 6) the same numbers with each C in the row behind it: C first, then θ and d."""
    out = rows.copy()
    out[2:-1, 2:] = rows[1:-2, 2:]
    out[1, 2:] = 0.0
    return out


def forms_of(layout: Layout, *, modified: bool) -> tuple[str, ...]:
    """Form of every row, base to tool."""
    behind = [*layout.forms, NORMAL]
    before = [NORMAL, *layout.forms]
    return (FREE, *(before if modified else behind), FREE)


def near_parallel(layout: Layout, names: tuple[str, ...]) -> list[tuple[str, str, float]]:
    """Pairs of joints with nearly parallel axes, and the angle between them [rad]."""
    pairs = zip(pairwise(names), layout.forms, layout.angles, strict=True)
    return [(one, two, angle) for (one, two), form, angle in pairs if form != NORMAL]
