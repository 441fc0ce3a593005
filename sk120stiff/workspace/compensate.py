"""Joint commands with which the loaded tool stands where the unloaded one was meant to.

The target is where the nominal robot, rigid and without load, would stand. The commands are
changed until the model's exact equilibrium under the load stands there. A correction is of the size
of the deflection, so the rigid Jacobian leads there in a few steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import load_case
from sk120stiff.errors import InputError, Refusal
from sk120stiff.model import Model, seen_from, without_marker
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import rotation_vector
from sk120stiff.stiffness.wrench import wrenches

STEPS = 40
REST = 1e-10  # rad or m: after a correction smaller than this nothing is left to correct
DAMPING = 1e-9  # of squared singular values of J: directions below are left alone
ENOUGH = 1e-8  # m and rad: what remains counts as nothing
BLOCK = 1024  # points solved together


@dataclass(frozen=True, eq=False)
class Standing:
    """Where the loaded tool stands.

    Attributes:
        away: (N, 3) displacement of the point from its target, base axes [m]; NaN where the springs
            cannot hold the load.
        turned: (N, 3) rotation of the tool from its target, base axes [rad].
    """

    away: Array
    turned: Array

    @property
    def distance(self) -> Array:
        """(N,) length of `away` [m]."""
        return np.asarray(np.linalg.norm(self.away, axis=1))

    @property
    def exists(self) -> Mask:
        """(N,) is there an equilibrium?"""
        return np.asarray(np.isfinite(self.away).all(axis=1), dtype=bool)


@dataclass(frozen=True, eq=False)
class Compensation:
    """Corrected commands for N points.

    Attributes:
        a: (N, n) corrected joint coordinates; the given ones where no equilibrium exists [rad or
            m].
        before, after: Where the loaded tool stands with the given and with the corrected commands.
        reasons: (N,) why something remains; empty where nothing does.
    """

    a: Array
    before: Standing
    after: Standing
    reasons: tuple[str, ...]

    def __repr__(self) -> str:
        before, after = (
            1e6 * float(np.max(where.distance, initial=0.0)) for where in (self.before, self.after)
        )
        return (
            f"<Compensation: {len(self.a)} points, at most {before:.4g} µm off before, "
            f"{after:.4g} µm after>"
        )


def compensate(
    model: Model,
    a: ArrayLike,
    wrench: ArrayLike,
    *,
    frame: str | None = None,
    point: ArrayLike | None = None,
    orientation: bool = False,
    movable: Mask | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Compensation:
    """Correct joint commands for the deflection under load.

    Args:
        model: Robot and effects. Instruments have no say; weight and wrong geometry do, and are
            corrected too.
        a: (N, n) commands for the rigid, unloaded robot [rad or m].
        wrench: (N, 6) or (6,) load at the point, base axes [N, N·m].
        frame, point: Where the load acts and what is to stand right: a point (3,) [m] of a frame;
            the origin of the tool frame by default.
        orientation: Restore the tool's orientation too.
        movable: (n,) joints that may be corrected; all by default.
        progress: Called with (points done, points in all).

    Raises:
        InputError: Shapes do not fit, or a number is not finite.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> mended = sk.compensate(model, [0, 0.2, -0.3, 0, -1, 0], [0, 0, -490, 0, 0, 0])
        >>> bool(mended.after.distance[0] < 1e-6 < mended.before.distance[0])  # m
        True
    """
    physical, at = seen_from(without_marker(model), frame, point)
    given = np.atleast_2d(physical.robot.coordinates(a))
    load = wrenches(wrench, len(given))
    if not np.isfinite(load).all():
        raise InputError("a load is not a finite number", remedy="Check forces and moments.")
    parts = []
    for k in range(0, len(given), BLOCK):
        end = min(k + BLOCK, len(given))
        parts.append(_compensated(physical, given[k:end], load[k:end], at, orientation, movable))
        if progress:
            progress(end, len(given))
    return Compensation(
        np.concatenate([given[:0], *(part.a for part in parts)]),
        _joined([part.before for part in parts]),
        _joined([part.after for part in parts]),
        tuple(reason for part in parts for reason in part.reasons),
    )


def standing(
    model: Model,
    commanded: ArrayLike,
    meant: ArrayLike,
    wrench: ArrayLike,
    *,
    frame: str | None = None,
) -> Standing:
    """Where a tool stands under load for commands (N, n), away from what was `meant` (N, n).

    With another model than the one that corrected the commands this shows what a wrong model costs.
    """
    physical, at = seen_from(without_marker(model), frame)
    robot = physical.robot
    a, goal = np.atleast_2d(robot.coordinates(commanded)), np.atleast_2d(robot.coordinates(meant))
    load = wrenches(wrench, len(a))
    return _joined(
        [
            _standing(physical, a[part], load[part], at, _Target.of(robot, goal[part], at))
            for part in (slice(k, k + BLOCK) for k in range(0, len(a), BLOCK))
        ]
    )


@dataclass(frozen=True, eq=False)
class _Target:
    position: Array
    rotation: Array

    @staticmethod
    def of(robot: Robot, a: Array, point: Array) -> _Target:
        screws = robot.screws(a, point=point)
        return _Target(screws.position, screws.rotation)

    def rows(self, pick: Index) -> _Target:
        return _Target(self.position[pick], self.rotation[pick])


def _compensated(
    model: Model,
    given: Array,
    load: Array,
    point: Array,
    orientation: bool,
    movable: Mask | None,
) -> Compensation:
    robot = model.robot
    target = _Target.of(robot, given, point)
    before = _standing(model, given, load, point, target)
    a, now = given.copy(), before
    held = before.exists
    active = np.flatnonzero(held)
    moves = np.ones(robot.n, dtype=bool) if movable is None else movable
    lower = np.minimum(robot.lower, given)  # a command beyond a limit is not made worse
    upper = np.maximum(robot.upper, given)
    for _ in range(STEPS):
        if not len(active):
            break
        error = -now.away[active]
        if orientation:
            error = np.concatenate([error, -now.turned[active]], axis=1)
        free = np.broadcast_to(moves, (len(active), robot.n)).copy()
        step = _step(robot, a[active], point, error, free, lower[active], upper[active])
        a[active] += step
        again = _standing(model, a[active], load[active], point, target.rows(active))
        now = _replaced(now, active, again)
        failed = ~again.exists
        a[active[failed]] = given[active[failed]]
        going = (np.abs(step).max(axis=1) > REST) & ~failed
        active = active[going]
    lost = ~now.exists & held
    if lost.any():
        now = _replaced(now, np.flatnonzero(lost), _picked(before, lost))
    worse = now.distance > before.distance + ENOUGH  # beside a singular pose steps lead away
    if worse.any():
        a[worse] = given[worse]
        now = _replaced(now, np.flatnonzero(worse), _picked(before, worse))
    reasons = _reasons(model, a, now, held, lost, orientation, moves)
    stays = "its correction would lead away, so it stays as it was: "
    told = tuple(stays * bool(off) + why for off, why in zip(worse, reasons, strict=True))
    return Compensation(a, before, now, told)


def _step(
    robot: Robot,
    a: Array,
    point: Array,
    error: Array,
    free: Mask,
    lower: Array,
    upper: Array,
) -> Array:
    """Smallest joint step that takes the error away, joints at a limit left where they are."""
    J = robot.jacobian(a, point=point)[:, : error.shape[1]]
    for _ in range(robot.n):
        used = np.where(free[:, None, :], J, 0.0)
        normal = used @ np.swapaxes(used, -1, -2)
        size = np.trace(normal, axis1=-2, axis2=-1)[:, None, None]
        damped = normal + DAMPING * size * np.eye(error.shape[1]) + 1e-300 * np.eye(error.shape[1])
        step = (np.swapaxes(used, -1, -2) @ np.linalg.solve(damped, error[..., None]))[..., 0]
        beyond = free & ((a + step > upper) | (a + step < lower))
        if not beyond.any():
            break
        free &= ~beyond
    return np.asarray(np.clip(a + step, lower, upper) - a)


def _standing(model: Model, a: Array, load: Array, point: Array, target: _Target) -> Standing:
    try:
        at = load_case(model.robot, a, load, point=point, absolute=True)
        rest = model.solve(at).rest.screws
    except Refusal:
        if len(a) == 1:
            return Standing(np.full((1, 3), np.nan), np.full((1, 3), np.nan))
        half = len(a) // 2
        first, second = np.arange(half), np.arange(half, len(a))
        return _joined(
            [
                _standing(model, a[part], load[part], point, target.rows(part))
                for part in (first, second)
            ]
        )
    turn = rest.rotation @ np.swapaxes(target.rotation, -1, -2)
    return Standing(rest.position - target.position, rotation_vector(turn))


def _reasons(
    model: Model,
    a: Array,
    now: Standing,
    held: Mask,
    lost: Mask,
    orientation: bool,
    moves: Mask,
) -> tuple[str, ...]:
    robot = model.robot
    left = now.distance > ENOUGH
    if orientation:
        left |= np.linalg.norm(now.turned, axis=1) > ENOUGH
    reasons = [""] * len(a)
    wanted = 6 if orientation else 3
    for k in np.flatnonzero(left | lost | ~held):
        at_limit = [
            robot.actuated[j]
            for j in range(robot.n)
            if moves[j] and (a[k, j] <= robot.lower[j] or a[k, j] >= robot.upper[j])
        ]
        if not held[k]:
            reasons[k] = "the springs cannot hold this load"
        elif lost[k]:
            reasons[k] = "the corrected arm cannot hold this load"
        elif at_limit:
            reasons[k] = f"at the limit of {', '.join(at_limit)}"
        elif moves.sum() < wanted:
            reasons[k] = f"{moves.sum()} joints cannot correct {wanted} directions"
        else:
            reasons[k] = "near a singular pose, some direction cannot be corrected"
    return tuple(reasons)


def _joined(parts: list[Standing]) -> Standing:
    empty = np.zeros((0, 3))
    return Standing(
        np.concatenate([empty, *(part.away for part in parts)]),
        np.concatenate([empty, *(part.turned for part in parts)]),
    )


def _replaced(old: Standing, rows: Index, new: Standing) -> Standing:
    away, turned = old.away.copy(), old.turned.copy()
    away[rows], turned[rows] = new.away, new.turned
    return Standing(away, turned)


def _picked(old: Standing, rows: Mask) -> Standing:
    return Standing(old.away[rows], old.turned[rows])
