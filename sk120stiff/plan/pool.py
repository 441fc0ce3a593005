"""Poses and loads that could be measured."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Situation, situation_of_load
from sk120stiff.errors import InputError, Refusal
from sk120stiff.plan.feasible import Column, base_column, clear_of, held_loads_of, lowest_points
from sk120stiff.robot import Robot

REACH_OF_UNLIMITED = np.pi  # rad; a joint without limits is used over one turn
REACH_OF_UNLIMITED_SLIDE = 0.5  # m
SHARE_OF_RANGE = 0.9  # the ends of the range are left out
FOLDED = 0.2  # sine of the crank-rod angle; below it a rod's share grows beyond all loads
DRAWS = 200  # batches drawn before a region is given up


@dataclass(frozen=True, eq=False)
class Pool:
    """M candidate readings.

    Attributes:
        situation: Their poses and loads.
        remarks: What was done so that they can be driven, and what nobody checked, in sentences.
    """

    situation: Situation
    remarks: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of candidates M."""
        return self.situation.count


@dataclass(frozen=True, eq=False)
class Region:
    """Where the arm may stand, beside its joint limits; in the base frame [m].

    Attributes:
        lowest: Height above which every joint and the measured point must stay.
        low, high: (3,) corners of a box that the measured point must not leave.
        column: What the arm stands on and must not run into.
    """

    lowest: float = -np.inf
    low: Array | None = None
    high: Array | None = None
    column: Column | None = None

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            corner = getattr(self, name)
            if corner is not None and np.shape(corner) != (3,):
                raise InputError(f"a corner of the box has the shape {np.shape(corner)}, not (3,)")
        if self.low is not None and self.high is not None and np.any(self.low >= self.high):
            raise InputError(
                "the box has no inside", remedy="Give the smaller corner first: x, y, z each."
            )

    def holds(self, robot: Robot, a: Array, point: Array) -> Mask:
        """(N,) poses a (N, n) that lie in the region, coupled joints within their limits too."""
        at = robot.screws(a, point=point).position
        good = np.ones(len(a), dtype=bool)
        if self.low is not None:
            good &= (at >= self.low).all(axis=1)
        if self.high is not None:
            good &= (at <= self.high).all(axis=1)
        if np.isfinite(self.lowest):
            good &= lowest_points(robot, a, point) >= self.lowest - 1e-9
        if self.column is not None:
            good &= clear_of(self.column, robot, a, point)
        return good & _coupled_within_limits(robot, a)


def random_pool(
    robot: Robot,
    *,
    poses: int,
    directions: int,
    force: float,
    point: Array,
    seed: int = 0,
    region: Region | None = None,
    force_point: Array | None = None,
) -> Pool:
    """Random poses within the joint limits, each under loads in random directions.

    Args:
        robot: The robot.
        poses, directions: Number of poses, and of load directions at each.
        force: Size of the loads [N].
        point, force_point: (3,) measured point and point of the force in the tool frame [m]; the
            force acts at the measured point unless said otherwise.
        seed: Of the draw.
        region: Restricts the poses further.

    Raises:
        Refusal: Next to no pose lies in the region.
    """
    rng = np.random.default_rng(seed)
    a = random_poses(robot, poses, rng)
    if region is not None:
        a = poses_in(robot, poses, rng, region, point)
    loads = np.zeros((poses * directions, 6))
    loads[:, :3] = rng.normal(size=(poses * directions, 3))
    loads[:, :3] *= force / np.linalg.norm(loads[:, :3], axis=1, keepdims=True)
    repeated = np.repeat(a, directions, axis=0)
    return Pool(situation_of_load(robot, repeated, loads, point=point, force_point=force_point))


def feasible_pool(
    robot: Robot,
    *,
    poses: int,
    directions: int,
    force: float,
    point: Array,
    seed: int = 0,
    region: Region | None = None,
    force_point: Array | None = None,
) -> Pool:
    """`random_pool` of what can be driven: clear of the base column, within the motors' efforts.

    Loads are scaled down to what the efforts of the URDF hold beside the arm's weight; poses whose
    weight alone is too much are left out. `Pool.remarks` says so, and what was not checked.

    Raises:
        Refusal: Next to no pose lies in the region, or the motors cannot hold the arm itself.
    """
    within = replace(region or Region(), column=base_column(robot))
    drawn = random_pool(
        robot, poses=poses, directions=directions, force=force, point=point, seed=seed,
        region=within, force_point=force_point,
    )  # fmt: skip
    situation = drawn.situation
    loaded = situation.force_point
    held = held_loads_of(robot, situation.a, situation.wrench, loaded)
    remarks = list(held.remarks)
    if within.column is None:
        remarks.append("The first joint does not turn: what the arm stands on is not kept clear.")
    if not np.isfinite(within.lowest):
        remarks.append("No floor was given: poses may go below the ground.")
    return Pool(replace(situation.rows(held.rows), wrench=held.wrench), tuple(remarks))


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
    for _ in range(DRAWS):
        drawn = middle + half * rng.uniform(-1.0, 1.0, (count, robot.n))
        kept = np.concatenate([kept, drawn[robot.closes(drawn) & _open(robot, drawn)]])
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
    middle, half = 0.5 * (lower + upper), 0.5 * SHARE_OF_RANGE * (upper - lower)
    return middle - half, middle + half


def poses_in(
    robot: Robot, count: int, rng: np.random.Generator, region: Region, point: ArrayLike
) -> Array:
    """(count, n) random coordinates in a region.

    Raises:
        Refusal: Next to no pose lies in it.
    """
    at = np.asarray(point, dtype=float)
    found: list[Array] = []
    missing = count
    for _ in range(DRAWS):
        drawn = random_poses(robot, max(count, 64), rng)
        kept = drawn[region.holds(robot, drawn, at)][:missing]
        found.append(kept)
        missing -= len(kept)
        if not missing:
            return np.concatenate(found)
    raise Refusal(
        f"only {count - missing} of {DRAWS * max(count, 64)} poses drawn within the joint limits "
        "lie where the arm may stand",
        where=robot.name,
        remedy="Lower the floor or widen the box.",
    )


def _open(robot: Robot, a: Array) -> Mask:
    """(M,) crank and rod of every linkage stand at an angle whose sine exceeds `FOLDED`."""
    good = np.ones(len(a), dtype=bool)
    for linkage in robot.linkages:
        pivot, elbow, end = (robot.screws(a, frame).position for frame in linkage.corners)
        crank, rod = elbow - pivot, end - elbow
        sine = np.linalg.norm(np.cross(crank, rod), axis=1)
        good &= sine > FOLDED * np.linalg.norm(crank, axis=1) * np.linalg.norm(rod, axis=1)
    return good


def _coupled_within_limits(robot: Robot, a: Array) -> Mask:
    good = np.ones(len(a), dtype=bool)
    if not robot.followers:
        return good
    values = robot.joint_values(a)
    for joint in robot.document.joints:
        low, high = joint.lower, joint.upper
        if joint.name not in robot.followers or joint.name not in values:
            continue
        if joint.type != "continuous" and low is not None and high is not None and low < high:
            value = values[joint.name]
            good &= (value >= low - 1e-9) & (value <= high + 1e-9)
    return good
