"""Poses and loads that could be measured."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases, load_case
from sk120stiff.errors import Refusal
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.efforts import held_loads_of
from sk120stiff.plan.feasible import feasible, unfolded
from sk120stiff.plan.surroundings import assumptions
from sk120stiff.robot import Robot

TYPED = 2e-6  # rad or m: joint values of a plan are rounded to 1e-4 deg
REACH_OF_UNLIMITED = np.pi  # rad; a joint without limits is used over one turn
REACH_OF_UNLIMITED_SLIDE = 0.5  # m
SHARE_OF_RANGE = 0.9  # the ends of the range are left out
BATCHES = 200  # drawn before closed loops are given up
DRAWS = 50_000  # poses drawn before a cell is given up
TOLD = 4_000  # poses drawn that tell how many there would be after all of them


@dataclass(frozen=True, eq=False)
class Pool:
    """M candidate readings.

    Attributes:
        load_cases: Their poses and loads.
        remarks: What was done so that they can be driven, and what nobody checked, in sentences.
    """

    load_cases: LoadCases
    remarks: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of candidates M."""
        return self.load_cases.count

    def without(self, a: Array) -> Pool:
        """The candidates that do not stand at a pose (n,)."""
        return Pool(self.load_cases.rows(~same_pose(self.load_cases.a, a)), self.remarks)

    def rows(self, index: Index) -> Pool:
        """Some of the candidates."""
        return Pool(self.load_cases.rows(index), self.remarks)

    @cached_property
    def pose(self) -> Index:
        """(M,) index of each candidate's pose."""
        return np.unique(self.load_cases.a, axis=0, return_inverse=True)[1].reshape(-1)


def same_pose(a: Array, other: Array) -> Mask:
    """Are poses (..., n) another one (n,), as people type joint values?"""
    return np.asarray(np.abs(a - other).max(axis=-1) < TYPED)


def random_pool(
    robot: Robot,
    *,
    poses: int | np.integer | Array,
    directions: int,
    force: float,
    point: Array,
    seed: int = 0,
    cell: Cell | None = None,
    force_point: Array | None = None,
) -> Pool:
    """Random poses within the joint limits, each under loads in random directions.

    Where the rig has fewer directions than are asked for, it brings smaller sizes in each too.

    Args:
        robot: The robot.
        poses, directions: Number of poses, or these themselves (K, n) [rad or m], and number of
            load directions at each.
        force: Size of the largest loads [N].
        point, force_point: (3,) measured point and point of the force in the tool frame [m]; the
            force acts at the measured point unless said otherwise.
        seed: Of the draw.
        cell: What poses and directions must keep to; without one joint limits alone.

    Raises:
        Refusal: Next to no pose can be had.
    """
    rng = np.random.default_rng(seed)
    if np.ndim(poses):
        a = np.asarray(poses, dtype=float)
    elif cell is None:
        a = random_poses(robot, int(poses), rng)
    else:
        a = poses_in(robot, int(poses), rng, cell, point)
    pushed = robot.screws(a, point=point if force_point is None else force_point).position
    rig = (cell or Cell()).rig
    drawn = rig.draw(pushed, directions, rng)
    sizes = rig.sizes(force, max(1, directions // drawn.shape[1]))
    brought = (drawn[:, :, None] * sizes[:, None]).reshape(len(a), -1, 3)
    loads = np.zeros((brought.shape[0] * brought.shape[1], 6))
    loads[:, :3] = brought.reshape(-1, 3) + 0.0  # no -0.0 in a plan
    repeated = np.repeat(a, brought.shape[1], axis=0)
    return Pool(load_case(robot, repeated, loads, point=point, force_point=force_point))


def feasible_pool(
    robot: Robot,
    *,
    poses: int | np.integer | Array,
    directions: int,
    force: float,
    point: Array,
    seed: int = 0,
    cell: Cell | None = None,
    force_point: Array | None = None,
) -> Pool:
    """`random_pool` of what can be driven, held and seen; see `feasible`.

    Loads are scaled down to what the efforts of the URDF hold beside the arm's weight, and to the
    steps of the rig; poses whose weight alone is too much are left out. `Pool.remarks` says so, and
    what was taken for granted.

    Raises:
        Refusal: Next to no pose is feasible, or the motors cannot hold the arm itself.
    """
    within = cell or Cell()
    drawn = random_pool(
        robot, poses=poses, directions=directions, force=force, point=point, seed=seed,
        cell=within, force_point=force_point,
    ).load_cases  # fmt: skip
    held = held_loads_of(robot, within, drawn.a, drawn.wrench, drawn.force_point)
    if not len(held.rows):
        raise Refusal(
            f"at no pose do the motors hold a step of the rig up to {force:g} N",
            where=within.source or robot.name,
            remedy="Give smaller steps, or a larger force.",
        )
    remarks = (*held.remarks, *assumptions(robot, within, point))
    # What is too much for the motors may come down to a size that is there already.
    told = np.hstack([drawn.a[held.rows], held.wrench])
    once = np.sort(np.unique(told, axis=0, return_index=True)[1])
    return Pool(replace(drawn.rows(held.rows[once]), wrench=held.wrench[once]), remarks)


def random_poses(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """(count, n) coordinates drawn evenly from the middle of the joint ranges.

    Poses at which a closed loop cannot be closed are drawn again, and so are those at which a
    linkage is so folded that its rod holds next to nothing.

    Raises:
        Refusal: Next to no pose can be closed.
    """
    lower, upper = usable_range(robot)
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    kept = np.zeros((0, robot.n))
    for _ in range(BATCHES):
        drawn = middle + half * rng.uniform(-1.0, 1.0, (count, robot.n))
        kept = np.concatenate([kept, drawn[robot.closes(drawn) & unfolded(robot, drawn)]])
        if len(kept) >= count:
            return kept[:count]
    raise Refusal(
        "next to no pose within the joint limits can be closed",
        where=robot.name,
        remedy="State the limits of the driven joints, or start: of the closures in robot.yaml.",
    )


def usable_range(robot: Robot) -> tuple[Array, Array]:
    """Lower and upper end (n,) of the ranges from which poses are drawn [rad or m]."""
    reach = np.where(robot.prismatic, REACH_OF_UNLIMITED_SLIDE, REACH_OF_UNLIMITED)
    lower = np.where(np.isfinite(robot.lower), robot.lower, -reach)
    upper = np.where(np.isfinite(robot.upper), robot.upper, reach)
    # A joint that turns farther stands no otherwise there: one turn is enough, and driven sooner.
    wide = ~np.array(robot.prismatic) & (lower < -reach) & (upper > reach)
    lower, upper = np.where(wide, -reach, lower), np.where(wide, reach, upper)
    middle, half = 0.5 * (lower + upper), 0.5 * SHARE_OF_RANGE * (upper - lower)
    return middle - half, middle + half


def poses_in(
    robot: Robot, count: int, rng: np.random.Generator, cell: Cell, point: ArrayLike
) -> Array:
    """(count, n) random feasible coordinates.

    Raises:
        Refusal: Next to no pose is; the commonest reason is named.
    """
    found: list[Array] = []
    missing = count
    why: Counter[str] = Counter()
    example: dict[str, str] = {}
    drawn_in_all = 0
    while drawn_in_all < DRAWS and not _hopeless(count - missing, drawn_in_all, count):
        drawn = random_poses(robot, max(count, 64), rng)
        verdict = feasible(robot, cell, drawn, point=point)
        drawn_in_all += len(drawn)
        found.append(drawn[verdict.ok][:missing])
        missing -= len(found[-1])
        if not missing:
            return np.concatenate(found)
        if len(found) == 1:
            said = (faults[0] for faults in verdict.faults if faults)
            for text in said:
                why[_kind(text)] += 1
                example.setdefault(_kind(text), text)
    raise Refusal(
        f"only {count - missing} of {drawn_in_all} poses drawn within the joint limits can be "
        f"had; the commonest reason: {example[why.most_common(1)[0][0]]}",
        where=cell.source or robot.name,
        remedy="Lower the floor, widen the box, or correct the cell; --check says what is wrong "
        "with single poses.",
    )


def _hopeless(found: int, drawn: int, count: int) -> bool:
    """Would all draws bring too few, at three standard errors more than this rate?"""
    return drawn >= TOLD and (found + 3.0 * np.sqrt(found) + 3.0) * DRAWS < count * drawn


def _kind(fault: str) -> str:
    """A fault without its numbers, so that like ones count together."""
    return re.sub(r"\([^()]*\) mm|-?\d[\d.]*", "...", fault).removesuffix(": ...")
