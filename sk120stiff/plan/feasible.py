"""Can an arm stand there, hold that load, and be seen? One question, one function.

`feasible` asks everything that the URDF and a `Cell` say: joint limits, closed loops, the arm
against itself, its pedestal, its tool and what stands around it, the motors, the rig, the tracker.
What nobody stated is not guessed in silence: `surroundings.assumptions` says what was taken for
granted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.efforts import weight_torques
from sk120stiff.plan.rig import unit
from sk120stiff.plan.surroundings import scene_of
from sk120stiff.robot import Robot
from sk120stiff.robot.collision import Scene

FOLDED = 0.2  # sine of the crank-rod angle; below it a rod's share grows beyond all loads
HIDDEN_END = 0.05  # m before the reflector in which the line of sight is not asked: its own holder
ROUNDING = 1e-9

Words = Callable[[int], str]


@dataclass(frozen=True, eq=False)
class Verdict:
    """Which of N poses with their loads can be driven, held, brought and seen.

    Attributes:
        ok: (N,) nothing stands against it.
    """

    ok: Mask
    _checks: tuple[tuple[Mask, Words], ...]

    @cached_property
    def faults(self) -> tuple[tuple[str, ...], ...]:
        """For each row what is wrong with it, in sentences."""
        return tuple(
            tuple(words(k) for bad, words in self._checks if bad[k]) for k in range(len(self.ok))
        )


def feasible(
    robot: Robot,
    cell: Cell,
    a: ArrayLike,
    wrench: ArrayLike | None = None,
    *,
    point: ArrayLike | None = None,
    force_point: ArrayLike | None = None,
) -> Verdict:
    """Ask of poses, and of the loads at them, whether they can be.

    Args:
        robot: The robot.
        cell: What stands around it, and how it is loaded and looked at.
        a: (N, n) poses [rad or m].
        wrench: (N, 6) loads at `force_point`, base axes [N, N·m]; None: poses alone are asked.
        point, force_point: (3,) measured point, and point of the force (the same by default), in
            the tool frame [m].
    """
    poses = np.atleast_2d(robot.coordinates(a))
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    unique, back = np.unique(poses, axis=0, return_inverse=True)
    back = back.reshape(-1)
    checks = [(bad[back], _at(words, back)) for bad, words in _of_poses(robot, cell, unique, at)]
    if wrench is not None:
        load = np.broadcast_to(np.atleast_2d(np.asarray(wrench, dtype=float)), (len(poses), 6))
        pushed = at if force_point is None else np.asarray(force_point, dtype=float)
        checks += _of_loads(robot, cell, poses, load, pushed)
    bad = np.any([mask for mask, _ in checks], axis=0)
    return Verdict(~bad, tuple(checks))


def _of_poses(robot: Robot, cell: Cell, a: Array, point: Array) -> list[tuple[Mask, Words]]:
    out = [*_of_limits(robot, cell, a), *_of_followers(robot, a)]
    closed = robot.closes(a)
    out.append((~closed, lambda _: "the closed loops cannot be closed here"))
    out.append(
        (~unfolded(robot, a), lambda _: "a linkage is folded: its rod holds next to nothing")
    )
    position = robot.screws(a, point=point).position
    outside = np.zeros(len(a), dtype=bool)
    if cell.low is not None:
        outside |= (position < cell.low - ROUNDING).any(axis=1)
    if cell.high is not None:
        outside |= (position > cell.high + ROUNDING).any(axis=1)
    out.append((outside, lambda k: f"the point leaves its box: {_mm(position[k])}"))
    scene = scene_of(robot, cell, point)
    asked = closed & ~outside  # the dear question comes last, and of those alone that may pass
    touching = np.zeros(len(a), dtype=bool)
    touching[asked] = ~scene.free(a[asked])

    def contacts(k: int) -> str:
        pairs = scene.contacts(a[k : k + 1])[0]
        return f"nearer than {1e3 * cell.clearance:g} mm: " + ", ".join(
            f"{first} to {second}" for first, second in pairs
        )

    out.append((touching, contacts))
    return out + _of_sight(robot, cell, a, position, scene)


def _of_limits(robot: Robot, cell: Cell, a: Array) -> list[tuple[Mask, Words]]:
    margin = np.where(robot.prismatic, cell.slide_margin, cell.angle_margin)
    # A range that is narrower than two margins has its middle left.
    half = 0.5 * (robot.upper - robot.lower)
    margin = np.minimum(margin, np.where(np.isfinite(half), half, np.inf))
    beyond = (a < robot.lower + margin - ROUNDING) | (a > robot.upper - margin + ROUNDING)

    def words(k: int) -> str:
        said = []
        for j in np.flatnonzero(beyond[k]):
            scale, unit_ = (1e3, "mm") if robot.prismatic[j] else (180.0 / np.pi, "deg")
            said.append(
                f"{robot.actuated[j]} at {scale * a[k, j]:.1f} {unit_}, allowed are "
                f"{scale * (robot.lower[j] + margin[j]):.1f} to "
                f"{scale * (robot.upper[j] - margin[j]):.1f} {unit_}"
            )
        return "; ".join(said)

    return [(np.asarray(beyond.any(axis=1)), words)]


def _of_followers(robot: Robot, a: Array) -> list[tuple[Mask, Words]]:
    """Coupled joints within their own limits."""
    if not robot.followers:
        return []
    values = robot.joint_values(a)
    out: list[tuple[Mask, Words]] = []
    for joint in robot.document.joints:
        low, high = joint.lower, joint.upper
        if joint.name not in robot.followers or joint.name not in values:
            continue
        if joint.type != "continuous" and low is not None and high is not None and low < high:
            value = values[joint.name]
            bad = (value < low - ROUNDING) | (value > high + ROUNDING)
            out.append((bad, _constant(f"the coupled joint {joint.name} passes its limit")))
    return out


def unfolded(robot: Robot, a: Array) -> Mask:
    """(M,) crank and rod of every linkage stand at an angle whose sine exceeds `FOLDED`."""
    good = np.ones(len(a), dtype=bool)
    for linkage in robot.linkages:
        pivot, elbow, end = (robot.screws(a, frame).position for frame in linkage.corners)
        crank, rod = elbow - pivot, end - elbow
        sine = np.linalg.norm(np.cross(crank, rod), axis=1)
        good &= sine > FOLDED * np.linalg.norm(crank, axis=1) * np.linalg.norm(rod, axis=1)
    return good


def _of_sight(
    robot: Robot, cell: Cell, a: Array, position: Array, scene: Scene
) -> list[tuple[Mask, Words]]:
    tracker = cell.tracker
    if tracker is None:
        return []
    ray = position - tracker.place
    away = np.linalg.norm(ray, axis=1)
    far = (away < tracker.nearest) | (away > tracker.farthest)
    out: list[tuple[Mask, Words]] = [
        (far, lambda k: f"the tracker is {away[k]:.2f} m away from the point")
    ]
    if tracker.axis is not None:
        looks = robot.screws(a).rotation @ tracker.axis
        off = np.arccos(np.clip(-np.einsum("ni,ni->n", looks, unit(ray)), -1.0, 1.0))
        out.append((
            off > tracker.cone + ROUNDING,
            lambda k: f"the reflector looks {np.rad2deg(off[k]):.0f} deg past the tracker, it "
            f"takes in {np.rad2deg(tracker.cone):.0f}",
        ))  # fmt: skip
    short = position - unit(ray) * np.minimum(HIDDEN_END, 0.5 * away)[:, None]
    seen = scene.sees(a, tracker.place, short)
    hidden = np.array([bool(name) for name in seen], dtype=bool)
    out.append((hidden, lambda k: f"{seen[k]} stands between tracker and point"))
    return out


def _of_loads(
    robot: Robot, cell: Cell, a: Array, wrench: Array, point: Array
) -> list[tuple[Mask, Words]]:
    screws = robot.screws(a, point=point)
    limit = robot.efforts
    asked = np.abs(screws.torques(wrench) + weight_torques(robot, a))
    over = asked > cell.effort_share * limit * (1.0 + 1e-6) + ROUNDING

    def effort(k: int) -> str:
        return "; ".join(
            f"{robot.actuated[j]} must give {asked[k, j]:.0f} of "
            f"{cell.effort_share * limit[j]:.0f} {'N' if robot.prismatic[j] else 'N*m'}"
            for j in np.flatnonzero(over[k])
        )

    force = wrench[:, :3]
    rig = cell.rig
    away = ~rig.allows(screws.position, force)
    twisted = np.asarray(wrench[:, 3:].any(axis=1) & (rig.words != "any direction"))
    size = np.linalg.norm(force, axis=1)
    return [
        (np.asarray(over.any(axis=1)), effort),
        (away, lambda k: f"{rig.words} cannot pull along {_n(force[k])}"),
        (twisted, lambda _: f"{rig.words} brings no moment"),
        (~rig.has(size), lambda k: f"{size[k]:.0f} N is none of the steps of the rig"),
    ]  # fmt: skip


def _at(words: Words, back: Index) -> Words:
    return lambda k: words(int(back[k]))


def _constant(text: str) -> Words:
    return lambda _: text


def _mm(x: Array) -> str:
    return "(" + ", ".join(f"{1e3 * v:.0f}" for v in x) + ") mm"


def _n(force: Array) -> str:
    return "(" + ", ".join(f"{v:.0f}" for v in force) + ") N"
