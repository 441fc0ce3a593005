"""Displacement against load at every single pose, without any model of the robot.

At one pose every elastic cause, known or not, displaces the point in proportion to the load (to
first order). So columns in proportion to the load, free at every pose, leave nothing but noise and
what is not linear in the load: a constant (lost motion), what is curved (hardening), and what
differs between loading and unloading (friction), which have columns of their own.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import LoadCases
from sk120stiff.measurements.poses import rows_by_label

MOMENT = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # a moment of 1 N·m counts like 2 N


def load_basis(
    load_cases: LoadCases, *, jump: bool = False, cubic: bool = False, branches: bool = False
) -> Array:
    """(N, k) the loads of every pose in their own principal directions, sizes of order one.

    Column j of one pose has nothing to do with column j of another. Where a pose has readings
    enough, `jump` adds a constant (lost motion), `cubic` what grows with the cube of the load
    (hardening), and `branches` a constant and a slope for unloading (friction).
    """
    loads = load_cases.wrench * MOMENT
    size = max(float(np.abs(loads).max(initial=0.0)), 1e-300)
    parts: list[tuple[Index, Array]] = []
    for rows in rows_by_label(load_cases.pose):
        ways = load_directions(load_cases, rows)
        rank = len(ways)
        basis = loads[rows] / size @ ways.T
        along = np.linalg.norm(basis, axis=1, keepdims=True)
        if jump and len(rows) >= rank + 3:
            basis = np.hstack([basis, np.sign(along)])
        if cubic and rank and len(rows) >= rank + 4:
            basis = np.hstack([basis, basis[:, :1] * along**2])
        if branches and rank and len(rows) >= rank + 5:
            turned = load_cases.branch[rows, None] < 0.0
            if turned.any() and not turned.all():
                basis = np.hstack([basis, turned, turned * basis[:, :1]])
        parts.append((rows, basis))
    width = max((basis.shape[1] for _, basis in parts), default=0)
    out = np.zeros((load_cases.count, width))
    for rows, basis in parts:
        out[rows, : basis.shape[1]] = basis
    return out


def load_directions(load_cases: LoadCases, rows: Index) -> Array:
    """(r, 6) principal directions of the loads of one pose, of those that are more than rounding.

    Args:
        load_cases: All readings.
        rows: Those of the pose.
    """
    _, singular, Vt = np.linalg.svd(load_cases.wrench[rows] * MOMENT, full_matrices=False)
    rank = int((singular > 0.02 * singular[0]).sum()) if singular[0] > 0.0 else 0
    return np.asarray(Vt[:rank])


def pose_columns(basis: Array) -> Array:
    """(N, 3, 3k) the basis for each reading axis on its own."""
    N, k = basis.shape
    return np.asarray(np.einsum("nk,ij->nikj", basis, np.eye(3)).reshape(N, 3, 3 * k))
