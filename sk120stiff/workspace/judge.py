"""Postures put on a task and followed along its path, and how good each is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.plan.feasible import Verdict
from sk120stiff.robot.rotations import rotation_from_rpy
from sk120stiff.workspace.arm import ElasticArm
from sk120stiff.workspace.inverse import Task, near, solve_inverse

#: poses along the path (N, n) with the part at (6,) → which of them can be
Admits = Callable[[Array, Array], Verdict]


@dataclass(frozen=True, eq=False)
class PathTask:
    """N points that the tool passes, with what acts on it there, in base axes.

    Attributes:
        position: (N, 3) of the arm's point [m].
        axis: (N, 3) or (3,) direction of the tool's z axis, rotation about it free; or None.
        rotation: (N, 3, 3) or (3, 3) orientation of the tool; or None.
        wrench: (N, 6) or (6,) load at the point [N, N·m].
        direction: (N, 3) or (3,) unit direction that matters; None for all.
    """

    position: Array
    axis: Array | None = None
    rotation: Array | None = None
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    direction: Array | None = None

    @property
    def count(self) -> int:
        """Number of points N."""
        return len(self.position)

    def each(self) -> PathTask:
        """The same with one axis, rotation, wrench and direction for every point."""

        def spread(x: Array | None, *shape: int) -> Array | None:
            return None if x is None else np.broadcast_to(x, (self.count, *shape))

        wrench = np.broadcast_to(self.wrench, (self.count, 6))
        return PathTask(
            np.asarray(self.position, dtype=float).reshape(-1, 3),
            spread(self.axis, 3),
            spread(self.rotation, 3, 3),
            wrench,
            spread(self.direction, 3),
        )


@dataclass(frozen=True, eq=False)
class Placement:
    """How the part, and the path with it, may be moved.

    Attributes:
        origin: (3,) point of the part about which it turns, base axes [m].
        lower, upper: (6,) bounds of x, y, z [m] and roll, pitch, yaw [rad] by which it is moved;
            equal ones are fixed.
    """

    origin: Array
    lower: Array
    upper: Array


@dataclass(frozen=True, eq=False)
class Pool:
    """k postures followed along the path: (k, N, n), (k, 6) and (k,)."""

    path: Array
    placement: Array
    objective: Array

    def best(self, count: int, admits: Admits | None = None) -> Pool:
        """The first `count` that pass, the best first."""
        order = np.argsort(self.objective)
        order = order[np.isfinite(self.objective[order])]
        if admits is not None:
            fair = (int(k) for k in order if admits(self.path[k], self.placement[k]).ok.all())
            order = np.fromiter(islice(fair, count), dtype=np.intp)
        order = order[:count]
        return Pool(self.path[order], self.placement[order], self.objective[order])

    def improve(self, trial: Pool, children: int, admits: Admits | None = None) -> _Improved:
        """Each posture or the best of its children, which stand one after the other in `trial`."""
        k = len(self.objective)
        objectives = trial.objective.reshape(children, k)
        best = np.argmin(objectives, axis=0)
        pick = best * k + np.arange(k)
        improved = trial.objective[pick] < self.objective
        if admits is not None:  # dear, so asked of those alone that would be kept
            for row in np.flatnonzero(improved):
                one = pick[row]
                improved[row] = admits(trial.path[one], trial.placement[one]).ok.all()
        return _Improved(
            Pool(
                np.where(improved[:, None, None], trial.path[pick], self.path),
                np.where(improved[:, None], trial.placement[pick], self.placement),
                np.where(improved, trial.objective[pick], self.objective),
            ),
            improved,
        )


@dataclass(frozen=True, eq=False)
class _Improved:
    pool: Pool
    improved: Mask


@dataclass(frozen=True, eq=False)
class Judge:
    """Puts postures on the task, follows the path, and says how good they are."""

    arm: ElasticArm
    path: PathTask
    minimise: str
    place: Placement | None
    singularity_margin: float
    largest_step: float

    @property
    def lower(self) -> Array:
        """(6,) lower bounds of the placement [m, rad]."""
        return np.zeros(6) if self.place is None else np.asarray(self.place.lower, dtype=float)

    @property
    def upper(self) -> Array:
        """(6,) upper bounds [m, rad]."""
        return np.zeros(6) if self.place is None else np.asarray(self.place.upper, dtype=float)

    @property
    def span(self) -> Array:
        """(6,) widths between them [m, rad]."""
        return self.upper - self.lower

    def inside(self, placement: Array) -> Array:
        """Placements (..., 6) brought within the bounds."""
        return np.clip(placement, self.lower, self.upper)

    def __call__(self, starts: Array, placement: Array) -> Pool:
        """Follow the path from (k, n) starts with the part at (k, 6); infinite: does not pass."""
        count = len(starts)
        followed = np.empty((count, self.path.count, self.arm.n))
        objective = np.zeros(count)
        alive = np.arange(count)
        before = starts
        for point in range(self.path.count):
            turn, shift = self.moves(placement[alive])
            reached = solve_inverse(self.arm, self.task(point, turn, shift), before[alive])
            a = near(self.arm, reached.a, before[alive]) if point else reached.a
            ok = reached.found & self.arm.within_limits(a)
            if point:
                jump = np.abs(a - before[alive]).max(axis=1)
                ok &= jump <= self.largest_step
            followed[alive, point] = a
            before = followed[:, point]
            objective[alive[~ok]] = np.inf
            alive = alive[ok]
            if not len(alive):
                break
            cost, condition = self.cost(followed[alive, point], point, turn[ok])
            lost = (condition < self.singularity_margin) | ~np.isfinite(cost)
            objective[alive] = np.where(lost, np.inf, np.maximum(objective[alive], cost))
            alive = alive[~lost]
            if not len(alive):
                break
        return Pool(followed, placement, objective)

    def moves(self, placement: Array) -> tuple[Array, Array]:
        """(k, 3, 3) rotations and (k, 3) shifts of the part."""
        turns = np.stack([rotation_from_rpy(row) for row in placement[:, 3:]])
        return turns, placement[:, :3]

    def loads(self, placement: Array) -> Array:
        """(N, 6) the loads along the path, which turn with the part at (6,), base axes [N, N·m]."""
        turn = rotation_from_rpy(placement[3:])
        return np.concatenate([self.path.wrench[:, k : k + 3] @ turn.T for k in (0, 3)], axis=1)

    def task(self, point: int, turn: Array, shift: Array) -> Task:
        """A point of the path as the part is turned (k, 3, 3) and shifted (k, 3)."""
        path = self.path
        origin = np.zeros(3) if self.place is None else np.asarray(self.place.origin, dtype=float)
        position = turn @ (path.position[point] - origin) + origin + shift
        return Task(
            position,
            None if path.axis is None else turn @ path.axis[point],
            None if path.rotation is None else turn @ path.rotation[point],
        )

    def cost(self, a: Array, point: int, turn: Array) -> tuple[Array, Array]:
        """Compliance or deflection, and conditioning, of postures at one point of the path."""
        load = self.path.wrench[point]
        loads = np.concatenate([turn @ load[:3], turn @ load[3:]], axis=1)
        want = ["condition", "stiffness_class", "compliance", "values", "deflection_enhanced"]
        found = self.arm.batch(a, loads, want)
        if self.minimise == "compliance":
            if self.path.direction is None:
                cost = 1.0 / found.of("values")[:, 0]
            else:
                d = turn @ self.path.direction[point]
                cost = np.einsum("ki,kij,kj->k", d, found.of("compliance"), d)
        else:
            displaced = found.of("deflection_enhanced")
            if self.path.direction is None:
                cost = np.linalg.norm(displaced, axis=1)
            else:
                d = turn @ self.path.direction[point]
                cost = np.abs((d * displaced).sum(-1))
        return np.where(found.stable, cost, np.inf), found.of("condition")
