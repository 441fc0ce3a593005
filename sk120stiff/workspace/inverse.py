"""Joint coordinates that put the tool where it is wanted: many targets from many starts at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot.rotations import rotation_vector
from sk120stiff.workspace.arm import ElasticArm, Kinematics

POSITION_TOLERANCE = 1e-9  # m
ANGLE_TOLERANCE = 1e-9  # rad
ITERATIONS = 40
BIAS = 1e-10  # of the damping: keeps the step finite at singular poses
STUCK, PATIENCE = 0.98, 6  # a start that gains no more than this after some steps is given up
LEADING_STEPS = 24  # on the straight way from a start pose
LONGEST_LEAD = 0.5  # rad or m in one of these steps; more is a jump to another branch
REACH = 1.0  # m that count as one radian in the damping


@dataclass(frozen=True, eq=False)
class Task:
    """Where N tools should be, in base axes.

    Attributes:
        position: (N, 3) of the arm's point [m].
        axis: (N, 3) or (3,) direction in which the tool's z axis should point, rotation about it
            free; or None.
        rotation: (N, 3, 3) or (3, 3) orientation of the tool frame; or None. Overrules `axis`.
    """

    position: Array
    axis: Array | None = None
    rotation: Array | None = None

    @property
    def count(self) -> int:
        """Number of targets N."""
        return len(self.position)

    def rows(self, pick: Index) -> Task:
        """Some of the targets."""

        def part(x: Array | None, single: int) -> Array | None:
            return x if x is None or x.ndim == single else x[pick]

        return Task(self.position[pick], part(self.axis, 1), part(self.rotation, 2))

    def error(self, position: Array, rotation: Array) -> Array:
        """(N, 3) or (N, 6) twist that would bring the tool there, to first order [m, rad]."""
        away = self.position - position
        if self.rotation is not None:
            turn = np.broadcast_to(self.rotation, rotation.shape) @ np.swapaxes(rotation, -1, -2)
            return np.concatenate([away, rotation_vector(turn)], axis=-1)
        if self.axis is not None:
            z = rotation[..., 2]
            goal = np.broadcast_to(self.axis, z.shape)
            across = np.cross(z, goal)
            sine = np.linalg.norm(across, axis=-1, keepdims=True)
            angle = np.arctan2(sine, (z * goal).sum(-1, keepdims=True))
            # Opposite directions have no axis between them: any across z will do.
            helper = np.cross(z, np.where(np.abs(z[..., :1]) < 0.7, [1.0, 0, 0], [0, 1.0, 0]))
            helper /= np.linalg.norm(helper, axis=-1, keepdims=True)
            unit = np.where(sine > 1e-12, across / np.maximum(sine, 1e-12), helper)
            return np.concatenate([away, angle * unit], axis=-1)
        return away


def starting_poses(arm: ElasticArm, count: int, rest: Array) -> Array:
    """(count, n) starts: `rest` first, then poses spread evenly over the joints' ranges."""
    from scipy.stats import qmc

    lower = np.where(np.isfinite(arm.lower), arm.lower, -np.pi)
    upper = np.where(np.isfinite(arm.upper), arm.upper, np.pi)
    power = max(1, int(np.ceil(np.log2(max(count, 2)))))
    spread = qmc.Sobol(arm.n, seed=0).random_base2(power)[: count - 1]
    return np.concatenate([rest[None], lower + spread * (upper - lower)])


@dataclass(frozen=True, eq=False)
class Reached:
    """What the search found for N targets.

    Attributes:
        a: (N, n) joint coordinates, the best that were met [rad or m].
        found: (N,) is the target met within the tolerances?
    """

    a: Array
    found: Mask


def solve_inverse(
    arm: ElasticArm,
    task: Task,
    start: Array,
    *,
    limits: bool = True,
) -> Reached:
    """Damped Newton steps from one start per target, all targets at once.

    The damping is half the squared error plus a little (Sugihara, IEEE T-RO 2011): the step goes
    over to Newton's near a solution and stays bounded where there is none.

    Args:
        arm: The arm.
        task: N targets.
        start: (N, n) starting coordinates [rad or m].
        limits: Keep joints within their limits.
    """
    a = start.copy()
    found = np.zeros(task.count, dtype=bool)
    active = np.arange(task.count)
    before = np.full(task.count, np.inf)
    for step_number in range(ITERATIONS):
        if not len(active):
            break
        now = arm.kinematics(a[active])
        error = task.rows(active).error(now.position, now.rotation)
        good = np.linalg.norm(error[:, :3], axis=-1) < POSITION_TOLERANCE
        if error.shape[-1] == 6:
            good &= np.linalg.norm(error[:, 3:], axis=-1) < ANGLE_TOLERANCE
        found[active[good]] = True
        size = (error**2).sum(-1)
        stuck = (size > STUCK * before[active]) & (step_number >= PATIENCE)
        before[active] = size
        go_on = ~good & ~stuck
        active, error, size = active[go_on], error[go_on], size[go_on]
        if not len(active):
            break
        J = now.jacobian[go_on][:, : error.shape[-1]]
        if task.rotation is None and task.axis is not None:
            J = _without_spin(J, now.rotation[go_on][..., 2])
        damping = 0.5 * size / REACH**2 + BIAS
        normal = np.swapaxes(J, -1, -2) @ J + damping[:, None, None] * np.eye(J.shape[-1])
        step = np.linalg.solve(normal, np.swapaxes(J, -1, -2) @ error[..., None])[..., 0]
        largest = np.abs(step).max(axis=-1, keepdims=True)
        step *= np.minimum(1.0, 1.0 / np.maximum(largest, 1e-300))
        a[active] += step
        if limits:
            a[active] = np.clip(wrapped(arm, a[active]), arm.lower, arm.upper)
    return Reached(wrapped(arm, a), found)


def lead_straight(arm: ElasticArm, task: Task, start: Array) -> Reached:
    """Lead the arm from one pose along straight lines to N targets, all at once.

    The point moves in equal steps, the tool turns first to the orientation that is wanted. A target
    is met only if no joint jumps on the way, so the arm stays in the branch of its start.

    Args:
        arm, task: The arm and the targets.
        start: (n,) where the arm begins [rad or m].
    """
    begin = arm.kinematics(start[None])
    a = np.tile(start, (task.count, 1))
    on_the_way = np.arange(task.count)
    turning, away = _turned_first(arm, task, start, begin)
    a[:] = turning
    on_the_way = on_the_way if away else on_the_way[:0]
    for share in np.arange(1, LEADING_STEPS + 1) / LEADING_STEPS:
        if not len(on_the_way):
            break
        here = task.rows(on_the_way)
        between = begin.position + share * (here.position - begin.position)
        step = Task(between, here.axis, here.rotation)
        reached = solve_inverse(arm, step, a[on_the_way])
        calm = np.abs(reached.a - a[on_the_way]).max(axis=1) <= LONGEST_LEAD
        good = reached.found & calm
        a[on_the_way[good]] = reached.a[good]
        on_the_way = on_the_way[good]
    found = np.zeros(task.count, dtype=bool)
    found[on_the_way] = True
    return Reached(a, found)


def _turned_first(
    arm: ElasticArm, task: Task, start: Array, begin: Kinematics
) -> tuple[Array, bool]:
    """(n,) the start with its tool as the task wants it, all targets alike; and is that reached?"""
    if task.axis is None and task.rotation is None:
        return start, True
    if (task.axis is not None and task.axis.ndim > 1) or (
        task.rotation is not None and task.rotation.ndim > 2
    ):
        raise ValueError("all targets need one orientation")
    turned = Task(begin.position, task.axis, task.rotation)
    reached = solve_inverse(arm, turned, start[None])
    return reached.a[0], bool(reached.found[0])


def _without_spin(J: Array, z: Array) -> Array:
    """The Jacobian with rotation about the tool's own axis z taken out of its angular half."""
    angular = J[:, 3:] - z[:, :, None] * (z[:, None, :] @ J[:, 3:])
    return np.concatenate([J[:, :3], angular], axis=1)


def wrapped(arm: ElasticArm, a: Array) -> Array:
    """Turning joints brought within their limits by whole turns where that is possible."""
    turns = ~np.asarray(arm.slides)
    middle = middle_of(arm)
    inside = (a >= arm.lower) & (a <= arm.upper) & np.isfinite(arm.lower)
    near = middle + (a - middle + np.pi) % (2.0 * np.pi) - np.pi
    return np.where(turns & ~inside, near, a)


def middle_of(arm: ElasticArm) -> Array:
    """(n,) the middle between each joint's limits [rad or m]; zero where one is infinite."""
    known = np.isfinite(arm.lower) & np.isfinite(arm.upper)
    low, high = np.where(known, arm.lower, 0.0), np.where(known, arm.upper, 0.0)
    return np.asarray(0.5 * (low + high))


def near(arm: ElasticArm, a: Array, before: Array) -> Array:
    """Turning joints within half a turn of where they were before, where limits allow it."""
    turned = a + 2.0 * np.pi * np.round((before - a) / (2.0 * np.pi))
    allowed = (turned >= arm.lower) & (turned <= arm.upper) & ~np.asarray(arm.slides)
    return np.where(allowed, turned, a)
