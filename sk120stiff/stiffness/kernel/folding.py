"""The constants of an elastic mechanism, folded into the form in which the batch kernel reads them.

Joint frames are turned so that every joint moves along or about its own z, and every rotation
between two joints is split as Rz(θ) Rx(α) Rz(φ), of which both Rz join the joint angles beside
them. What remains between two joints is a shift and a turn about x. Nothing is lost or
approximated, and no common normal of nearly parallel axes is needed. Which pair of joints adds to
which element of K_C is told here too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.robot import Coupling, JointMotion, LinearCoupling, Mechanism
from sk120stiff.robot.rotations import frame_about

VARIABLE, CONSTANT, NONE = 0, 1, 2  # does the turn about a joint's z depend on the pose?


class Fold(NamedTuple):
    """Constants of a chain of m joints, n coordinates and s of them soft.

    Attributes:
        start: (9,) columns of the rotation before the first joint.
        shift: (m + 1, 3) translation before each joint, and to the point after the last [m].
        final: (3, 3) rotation from the axes after the last joint to the end frame.
        tilt: (m, 2) cosine and sine of the turn about x before each joint.
        pose_map, value: (m, n) and (m,): joint values q = pose_map z + value. Where the motion is
            given, z stands for the joint values themselves.
        n, actuated, inputs: Number of coordinates, of those that motors drive, and of the columns
            of `poses`; the other coordinates stand at zero until the arm sags.
        given: Does `Given` say how the joints follow, and where the arm hangs?
        offset: (m,) constant angle beside each joint's value [rad].
        slides: (m,) 1 for a joint that slides, 0 for one that turns.
        kind, constant: (m,) VARIABLE, CONSTANT or NONE, and (m, 2) cosine and sine where constant.
        column_joint, column_coordinate, column_soft, column_factor: Entries of the map from
            coordinates to joints, dq = Σ factor · dz; where the coordinate stands in `soft`, or -1.
        mass, centre: (m,) mass that each joint carries [kg], and (m, 3) its centre in the folded
            frame [m].
        weighs: Does the arm sag under its own weight?
        gravity: (3,) acceleration [m/s²].
        soft: (s,) coordinates with a finite spring.
        springs: (s(s+1)/2,) lower triangle of their K_θ by rows.
        whitener: (s, s) L⁻¹ with L Lᵀ = K_θ.
        pair: (p, 2) pairs of joints, the first nearer to the base or the same.
        pair_end: (p,) end of each pair's stretch in the following two.
        row: (e, 4) element of the lower triangle of K_C that a pair adds to, of the strictly lower
            triangle of its skew part, -1 for none, and the two entries of the map.
        factor: (e, 2) how much of it; times the two entries where the motion is given.
        bend: (b, 2) joint, and element of the lower triangle of K_C, of each `Given.bends`.
    """

    start: Array
    shift: Array
    final: Array
    tilt: Array
    pose_map: Array
    value: Array
    n: int
    actuated: int
    inputs: int
    given: bool
    offset: Array
    slides: Array
    kind: Integers
    constant: Array
    column_joint: Integers
    column_coordinate: Integers
    column_soft: Integers
    column_factor: Array
    mass: Array
    centre: Array
    weighs: bool
    gravity: Array
    soft: Integers
    springs: Array
    whitener: Array
    pair: Integers
    pair_end: Integers
    row: Integers
    factor: Array
    bend: Integers


class Given(NamedTuple):
    """What the pose decides and the kernel cannot know; sizes of zero where `Fold` says it all.

    Attributes:
        factors: (N, entries) of the map from coordinates to joints, where the motion is given.
        bends: (N, b) second derivatives of joints by coordinates.
        springs: (N, s(s+1)/2) K_θ as in `Fold`, where it changes with the pose.
    """

    factors: Array
    bends: Array
    springs: Array


def fold(
    mechanism: Mechanism,
    soft: Integers,
    K_theta: Array | None,
    point: Array,
    shift: Array,
    gravity: Array | None = None,
) -> Fold:
    """Fold a mechanism with springs for the kernel.

    Args:
        mechanism: Chain and coupling; virtual joints allowed.
        soft, K_theta: (s,) coordinates that yield, and (s, s) their stiffness [N·m/rad or N/m],
            positive definite; None where it changes with the pose.
        point: (3,) the point in the end frame [m].
        shift: (n,) by which the coordinates start from elsewhere than commanded [rad or m].
        gravity: (3,) in base axes [m/s²]: lets the arm sag before the load comes.
    """
    coupling = mechanism.elastic or mechanism.coupling
    chain = mechanism.chain
    m, n, n_a, s = chain.m, mechanism.n, mechanism.coupling.n, len(soft)
    weighs = gravity is not None and chain.weighs
    given = K_theta is None or not isinstance(coupling, LinearCoupling)
    if given or not isinstance(coupling, LinearCoupling):
        to_joints = coupling.pattern[chain.coordinates].astype(float)
        pose_map, value, moves = np.eye(m), np.zeros(m), np.ones(m, dtype=bool)
    else:
        to_joints = pose_map = np.ascontiguousarray(coupling.A[chain.coordinates])
        value = to_joints @ shift + coupling.b[chain.coordinates]
        varies = np.arange(n) < n_a
        varies[soft] |= weighs
        moves = (to_joints[:, varies] != 0.0).any(axis=1) | (value != 0.0)
    frames = _frames(mechanism, point)
    kind = np.where(
        moves & chain.revolute, VARIABLE, np.where(frames.offset != 0.0, CONSTANT, NONE)
    )
    joints, coordinates = np.nonzero(to_joints)
    pair, pair_end, row, factor = contributions(to_joints, soft)
    place = np.full(n, -1)
    place[soft] = np.arange(s)
    K_mean = np.eye(s) if K_theta is None else K_theta
    return Fold(
        **frames._asdict(),
        pose_map=pose_map,
        value=np.ascontiguousarray(value),
        n=n,
        actuated=n_a,
        inputs=m if given else n_a,
        given=given,
        slides=(~chain.revolute).astype(float),
        kind=kind.astype(np.int64),
        constant=np.stack([np.cos(frames.offset), np.sin(frames.offset)], axis=1),
        column_joint=joints.astype(np.int64),
        column_coordinate=coordinates.astype(np.int64),
        column_soft=place[coordinates],
        column_factor=to_joints[joints, coordinates],
        mass=chain.masses,
        weighs=weighs,
        gravity=np.zeros(3) if gravity is None else np.asarray(gravity, dtype=float),
        soft=np.asarray(soft, dtype=np.int64),
        springs=K_mean[np.tril_indices(s)],
        whitener=np.ascontiguousarray(np.linalg.inv(np.linalg.cholesky(K_mean))),
        pair=pair,
        pair_end=pair_end,
        row=row,
        factor=factor,
        bend=_bend(coupling, chain.coordinates, soft),
    )


def _bend(coupling: Coupling, order: Index, soft: Integers) -> Integers:
    """(b, 2) `Fold.bend`."""
    joints, coordinates = coupling.bending
    i, j = np.tril_indices(len(soft))
    felt = np.flatnonzero(np.isin(soft[i], coordinates) & np.isin(soft[j], coordinates))
    bent = np.flatnonzero(np.isin(order, joints))
    return np.stack([np.repeat(bent, len(felt)), np.tile(felt, len(bent))], axis=1)


def given(fold: Fold, mechanism: Mechanism, motion: JointMotion, springs: Array) -> Given:
    """What the kernel reads at N poses; K_θ (N, s, s), or (0, s, s) where `fold` knows it."""
    order, count = mechanism.chain.coordinates, len(motion.q)
    first = np.broadcast_to(motion.first, (count, *motion.first.shape[-2:]))[:, order]
    i, j = np.tril_indices(len(fold.soft))
    bends = np.zeros((count, 0))
    curvature = None if motion.second is None else motion.second.picked(order)
    if curvature is not None:
        element = fold.bend[:, 1]
        joint = np.searchsorted(curvature.joints, fold.bend[:, 0])
        near, far = (np.searchsorted(curvature.coordinates, fold.soft[k][element]) for k in (i, j))
        bends = curvature.hessian[:, joint, near, far]
    return Given(
        np.ascontiguousarray(first[:, fold.column_joint, fold.column_coordinate]),
        np.ascontiguousarray(bends),
        np.ascontiguousarray(springs[:, i, j]),
    )


class _Frames(NamedTuple):
    start: Array
    shift: Array
    final: Array
    tilt: Array
    offset: Array
    centre: Array


def _frames(mechanism: Mechanism, point: Array) -> _Frames:
    """start, shift, final, tilt, offset and centre of `Fold`."""
    chain = mechanism.chain
    m = chain.m
    shift, tilt, offset = np.empty((m + 1, 3)), np.empty((m, 2)), np.zeros(m)
    centre = chain.centres.copy()
    start = np.eye(3)
    before = np.eye(3)  # turns the frame after the previous joint so that its axis is z
    for k in range(m):
        upright = frame_about(chain.axes[k])
        rotation = before.T @ chain.placements[k, :3, :3] @ upright
        shift[k] = before.T @ chain.placements[k, :3, 3]
        before = upright
        centre[k] = upright.T @ centre[k]
        if k == 0:
            tilt[0] = (1.0, 0.0)
            start = rotation
            shift[0] = start.T @ shift[0]
            continue
        theta, tilt[k], phi = _split(rotation)
        offset[k - 1] += theta
        offset[k] += phi
        shift[k] = _turned_back(shift[k], theta)
        centre[k - 1] = _turned_back(centre[k - 1], theta)
    shift[m] = before.T @ (chain.placements[m, :3, 3] + chain.placements[m, :3, :3] @ point)
    final = np.ascontiguousarray(before.T @ chain.placements[m, :3, :3])
    return _Frames(start.T.reshape(9).copy(), shift, final, tilt, offset, centre)


def _turned_back(vector: Array, theta: float) -> Array:
    """Rz(θ)ᵀ v."""
    c, s = np.cos(theta), np.sin(theta)
    return np.array([c * vector[0] + s * vector[1], c * vector[1] - s * vector[0], vector[2]])


def _split(rotation: Array) -> tuple[float, tuple[float, float], float]:
    """θ, (cos α, sin α) and φ of a rotation Rz(θ) Rx(α) Rz(φ)."""
    s = float(np.hypot(rotation[0, 2], rotation[1, 2]))
    c = float(rotation[2, 2])
    theta = float(np.arctan2(rotation[0, 2], -rotation[1, 2])) if s > 1e-15 else 0.0
    if s <= 1e-15:
        s, c = 0.0, float(np.sign(c))
    ct, st = np.cos(theta), np.sin(theta)
    back = np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]) @ np.array(
        [[ct, st, 0.0], [-st, ct, 0.0], [0.0, 0.0, 1.0]]
    )
    turn = back @ rotation
    return theta, (c, s), float(np.arctan2(turn[1, 0], turn[0, 0]))


def contributions(to_joints: Array, soft: Integers) -> tuple[Integers, Integers, Integers, Array]:
    """The pairs, their stretches, rows and factors of `Fold`.

    Args:
        to_joints: (m, n) factors of the coordinates; ones where they change with the pose.
        soft: (s,) coordinates that yield.
    """
    pairs: list[tuple[int, int]] = []
    ends: list[int] = []
    adds: list[tuple[int, float, int, float, int, int]] = []
    entry = np.cumsum(to_joints != 0.0).reshape(to_joints.shape) - 1
    by, entry = to_joints[:, soft], entry[:, soft]
    for first, second in _joint_pairs(by):
        before = len(adds)
        for i, j, *add in _additions(by[first], by[second], same=first == second):
            adds.append((*add, entry[first, i], entry[second, j]))
        if len(adds) > before:
            pairs.append((first, second))
            ends.append(len(adds))
    table = np.array(adds, dtype=float).reshape(-1, 6)
    pair = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    rows = table[:, [0, 2, 4, 5]].astype(np.int64, order="C")  # one layout, one compilation
    return pair, np.array(ends, dtype=np.int64), rows, table[:, [1, 3]].copy()


def _joint_pairs(to_joints: Array) -> Iterator[tuple[int, int]]:
    moved = np.flatnonzero((to_joints != 0.0).any(axis=1)).tolist()
    return ((first, second) for k, first in enumerate(moved) for second in moved[k:])


def _additions(
    first: Array, second: Array, *, same: bool
) -> Iterator[tuple[int, int, int, float, int, float]]:
    """Aᵀ K A for one symmetric pair of elements of K: i, j, row, factor, skew row, skew factor."""
    for i in np.flatnonzero(first).tolist():
        for j in np.flatnonzero(second).tolist():
            value = float(first[i] * second[j])
            high, low = max(i, j), min(i, j)
            row = high * (high + 1) // 2 + low
            if same:
                if i >= j:
                    yield i, j, row, value, -1, 0.0
            elif i == j:
                yield i, j, row, 2.0 * value, -1, 0.0
            else:
                skew = high * (high - 1) // 2 + low
                # K[second, first] carries + half of the moment's part, K[first, second] minus that.
                yield i, j, row, value, skew, value if j > i else -value
