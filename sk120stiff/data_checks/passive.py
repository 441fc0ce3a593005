"""What a passive arm could do: how much of the readings compliances from zero up can explain.

To first order a compliance c about the unit twist u displaces the point by c u (uᵀ W). An arm
yields in its drives, in its bearings and in its foundation; none of these compliances is negative.
So with A the displacements of unit compliances, ``min ‖d − A c‖, c ≥ 0`` leaves little of sound
readings d, whatever passive part the model lacks, and much of readings that belong to other poses,
other loads or other axes. The springs of the model are not asked: they may be as wrong as they
like.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import nnls

from sk120stiff.arrays import Array
from sk120stiff.robot import Screws

ROUNDING = 1e-12  # of a column's square: compliances that are one to the readings stay solvable
UNSEEN = 1e-9  # of the largest column: a compliance that the readings do not show


@dataclass(frozen=True)
class Passive:
    """The best that non-negative compliances can do.

    Attributes:
        share: Of ‖d‖² that they explain, from 0 to 1.
        left: Mean square of what they leave, per axis [m²].
        count: Numbers that were explained, three per reading or as many as were read.
    """

    share: float
    left: float
    count: int


def passive(columns: Array, d: Array) -> Passive:
    """How far columns (N, 3, k) of unit compliances explain displacements (N, 3) [m].

    NaN is what was not read.
    """
    A, y = columns.reshape(d.size, -1), d.ravel()
    known = np.isfinite(y)
    if not known.all():
        A, y = A[known], y[known]
    size, gram, along = float(y @ y), A.T @ A, A.T @ y
    c = compliances(gram, along) if size > 0.0 else None
    if c is None:
        return Passive(0.0, size / max(len(y), 1), len(y))
    rest = y - A @ c
    left = float(rest @ rest)
    return Passive(1.0 - left / size, left / len(y), len(y))


def of_sums(gram: Array, along: Array, size: float, count: int) -> Passive:
    """The same from AᵀA, Aᵀd and dᵀd of `count` numbers; less exact where little is left."""
    c = compliances(gram, along) if size > 0.0 else None
    if c is None:
        return Passive(0.0, size / max(count, 1), count)
    left = max(float(size - 2.0 * along @ c + c @ gram @ c), 0.0)
    return Passive(1.0 - left / size, left / count, count)


def compliances(gram: Array, along: Array) -> Array | None:
    """(k,) compliances from zero up that leave least, from AᵀA and Aᵀd; None: none is seen."""
    scale = np.sqrt(np.diag(gram))
    seen = np.flatnonzero(scale > UNSEEN * scale.max(initial=0.0))
    if not len(seen):
        return None
    by, out = scale[seen], np.zeros(len(gram))
    out[seen] = _non_negative(gram[np.ix_(seen, seen)] / np.outer(by, by), along[seen] / by) / by
    return out


def _non_negative(gram: Array, along: Array) -> Array:
    """min ‖y − A c‖, c ≥ 0, from AᵀA with ones on its diagonal, and Aᵀy."""
    lower = np.linalg.cholesky(gram + ROUNDING * np.eye(len(gram)))
    return np.asarray(nnls(lower.T, solve_triangular(lower, along, lower=True))[0])


def unit_displacements(at: Screws, force_point: Array, wrench: Array) -> Array:
    """(N, 3, k) displacement for each unit compliance, in base axes, to first order.

    The compliances are those of the n coordinates, which come first, of two tilts of every bearing,
    and of the foundation (three rotations, three slides).

    Args:
        at: N poses, seen from the measured point.
        force_point: (3,) point of attack in the tool frame [m].
        wrench: (N, 6) load in base axes [N, N·m].
    """
    attack = at if np.array_equal(at.point, force_point) else at.at(force_point)
    axes, origins = _bearings(at)
    moves = np.cross(axes, at.position[:, None] - origins)
    torques = _torques_on(axes, origins, attack, wrench)
    return np.concatenate(
        [
            at.linear_jacobian * attack.torques(wrench)[:, None, :],
            np.swapaxes(moves * torques[..., None], 1, 2),
            np.eye(3) * wrench[:, None, :3],
        ],
        axis=2,
    )


def unit_turns(at: Screws, force_point: Array, wrench: Array) -> Array:
    """(N, 3, k) rotation of the tool for each of the same unit compliances, base axes."""
    attack = at if np.array_equal(at.point, force_point) else at.at(force_point)
    axes, origins = _bearings(at)
    torques = _torques_on(axes, origins, attack, wrench)
    return np.concatenate(
        [
            at.jacobian[:, 3:] * attack.torques(wrench)[:, None, :],
            np.swapaxes(axes * torques[..., None], 1, 2),
            np.zeros((len(wrench), 3, 3)),
        ],
        axis=2,
    )


def _torques_on(axes: Array, origins: Array, attack: Screws, wrench: Array) -> Array:
    """(N, m) torques of loads (N, 6) about axes (N, m, 3) through points."""
    lever = np.cross(axes, attack.position[:, None] - origins)
    force, moment = wrench[:, None, :3], wrench[:, None, 3:]
    return np.asarray((lever * force).sum(-1) + (axes * moment).sum(-1))


def _bearings(at: Screws) -> tuple[Array, Array]:
    """(N, 2m + 3, 3) axes about which bearings and foundation tilt, and points on them [m].

    A bearing's tilts are normal to its joint's axis and turn with its moving side: towards the next
    joint, and across.
    """
    along = np.diff(at.origins, axis=1, append=at.position[:, None])
    beyond = np.roll(at.axes, -1, axis=1)
    flat = _normal(at.axes, along)
    short = np.linalg.norm(flat, axis=2) < 1e-3
    flat[short] = _normal(at.axes, beyond)[short]
    size = np.linalg.norm(flat, axis=2, keepdims=True)
    flat = np.divide(flat, size, out=np.zeros_like(flat), where=size > 1e-6)
    base = np.broadcast_to(np.eye(3), (len(flat), 3, 3))
    axes = np.concatenate([flat, np.cross(at.axes, flat), base], axis=1)
    origins = np.concatenate([at.origins, at.origins, np.zeros_like(base)], axis=1)
    return axes, origins


def _normal(axes: Array, vectors: Array) -> Array:
    return np.asarray(vectors - axes * (axes * vectors).sum(-1, keepdims=True))
