"""In which order poses are driven to, and by which way, so that nothing is run into.

The order is that of least time, by nearest neighbours and 2-opt (Croes 1958). Between two poses the
joints go straight; where that is not free, the way goes by via points of a roadmap of random free
poses, whose edges are asked when they are needed (Bohlin & Kavraki 2000, lazy PRM).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import Refusal
from sk120stiff.measurements import Measurements
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.pool import poses_in
from sk120stiff.plan.surroundings import scene_of
from sk120stiff.robot import Robot
from sk120stiff.robot.collision import Pair, Scene

SPEED_SHARE = 0.2  # of the joints' speeds in the URDF, for a campaign
USUAL_SPEED, USUAL_SLIDE = 0.3, 0.1  # rad/s and m/s where it states none
STEP, SLIDE_STEP = np.deg2rad(2.0), 0.01  # of a way between two questions
COARSER = 2.0  # than these steps: enough for a picture of the way
ROADMAPS = (120, 500, 1500)  # random poses, more where fewer do not do
NEIGHBOURS = 15  # edges of each
ATTEMPTS = 400  # ways through the roadmap that are asked before it is given up
ASKED = 3  # other poses of a plan that are asked which of two is the trapped one
SETTLING = 20.0  # s at a reading: to come to rest, to load, to read


class NoWay(Refusal):
    """No free way between two poses was found; `pose` is the index of the one to leave out."""

    def __init__(self, robot: str, here: int, there: int, trapped: int) -> None:
        super().__init__(
            f"no free way was found from pose {here + 1} of the plan to pose {there + 1}",
            where=robot,
            remedy="Take another --seed, or leave one of them out.",
        )
        self.pose = trapped


@dataclass(frozen=True, eq=False)
class Jump:
    """A straight way from a pose to the next one that is not free.

    Attributes:
        row: Index of the pose from which it goes.
        a: (n,) coordinates on the way that cannot be.
        touching: Pairs of solids that touch there; none where a closed loop cannot be closed.
    """

    row: int
    a: Array
    touching: tuple[Pair, ...]

    @property
    def words(self) -> str:
        """What is met, in words."""
        pairs = ", ".join(f"{first} touches {second}" for first, second in self.touching)
        return pairs or "the closed loops cannot be closed"


@dataclass(frozen=True, eq=False)
class Route:
    """A way through poses.

    Attributes:
        order: (N,) the poses in the order in which they are driven to.
        a: (K, n) all stops, via points among them [rad or m].
        pose: (K,) index of the pose at each stop; -1 at a via point.
        seconds: Driving time, without the readings.
    """

    order: Index
    a: Array
    pose: Index
    seconds: float

    def minutes(self, readings: int) -> float:
        """Of the campaign with so many readings [min]."""
        return (self.seconds + SETTLING * readings) / 60.0


def route(
    robot: Robot, cell: Cell, a: ArrayLike, *, point: ArrayLike | None = None, seed: int = 0
) -> Route:
    """The way through poses (N, n) that takes least time and runs into nothing.

    Raises:
        NoWay: No free way to a pose was found.
    """
    poses = np.atleast_2d(robot.coordinates(a))
    scene = scene_of(robot, cell, point)
    speed = joint_speeds(robot)
    order = _ordered(_times(poses, poses, speed))
    stops, which, seconds = [poses[order[0]]], [int(order[0])], 0.0
    roadmap = poses
    for here, there in itertools.pairwise(order):
        way = [poses[here], poses[there]]
        if not straight_is_free(robot, scene, way[0], way[1]):
            at = np.zeros(3) if point is None else point
            ends = int(here), int(there)
            found: list[Array] | None = None
            for size in ROADMAPS:
                if len(roadmap) < len(poses) + size:
                    rng = np.random.default_rng(seed)
                    roadmap = np.concatenate([poses, poses_in(robot, size, rng, cell, at)])
                found = _around(robot, scene, roadmap, *ends, speed)
                if found is not None:
                    break
            if found is None:
                trapped = _trapped(robot, scene, roadmap, len(poses), ends, speed)
                raise NoWay(robot.name, *ends, trapped)
            way = found
        for k, stop in enumerate(way[1:], 1):
            stops.append(stop)
            which.append(int(there) if k == len(way) - 1 else -1)
        seconds += sum(
            float(_times(p[None], q[None], speed)[0, 0]) for p, q in itertools.pairwise(way)
        )
    return Route(order, np.array(stops), np.array(which, dtype=np.intp), seconds)


def in_order(plan: Measurements, robot: Robot, cell: Cell, seed: int) -> tuple[Measurements, Route]:
    """The plan with its poses in the order of least driving, and the way.

    Raises:
        NoWay: No free way to a pose was found.
    """
    first = [plan.pose.index(label) for label in plan.poses]
    found = route(robot, cell, plan.joints[first], point=plan.point, seed=seed)
    rows = [
        k for pose in found.order for k, label in enumerate(plan.pose) if label == plan.poses[pose]
    ]
    return plan.select(np.array(rows, dtype=np.intp)), found


def straight_on(robot: Robot, stops: Array) -> tuple[Array, Index]:
    """(M, n) poses along joints that go straight from stop to stop, and which of them are stops."""
    rows, reached = [stops[:1]], [0]
    for start, end in itertools.pairwise(stops):
        steps = np.abs(end - start) / np.where(robot.prismatic, SLIDE_STEP, STEP)
        count = max(int(np.ceil(steps.max() / COARSER)), 1)
        rows.append(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start))
        reached.append(reached[-1] + count)
    return np.concatenate(rows), np.array(reached, dtype=np.intp)


def joint_speeds(robot: Robot) -> Array:
    """(n,) speeds at which a campaign is driven [rad/s or m/s]."""
    joints = robot.document.by_name
    usual = np.where(robot.prismatic, USUAL_SLIDE, USUAL_SPEED)
    own = [SPEED_SHARE * (joints[name].velocity or 0.0) for name in robot.actuated]
    return np.where(np.array(own) > 0.0, own, usual)


def straight_is_free(robot: Robot, scene: Scene, start: Array, end: Array) -> bool:
    """Can the joints go straight from one pose to another?"""
    ends = np.array([start, end])
    free = robot.closes(ends).all() and scene.free(ends).all()
    return bool(free) and _met(robot, scene, start, end) is None


def jumps(
    robot: Robot, cell: Cell, a: ArrayLike, *, point: ArrayLike | None = None
) -> tuple[Jump, ...]:
    """What is met where joints go straight from each of the poses (N, n) to the next.

    The poses themselves are not asked: `feasible` does that.
    """
    poses = np.atleast_2d(robot.coordinates(a))
    scene = scene_of(robot, cell, point)
    found = []
    for k, (start, end) in enumerate(itertools.pairwise(poses)):
        met = _met(robot, scene, start, end)
        if met is not None:
            pairs = scene.contacts(met[None])[0] if robot.closes(met[None])[0] else ()
            found.append(Jump(k, met, pairs))
    return tuple(found)


def _met(robot: Robot, scene: Scene, start: Array, end: Array) -> Array | None:
    """A pose (n,) between two at which something touches or a loop stays open; None: none does."""
    longest = np.abs(end - start) / np.where(robot.prismatic, SLIDE_STEP, STEP)
    steps = np.arange(1, int(np.ceil(longest.max())))
    if not len(steps):
        return None
    # the middle first: what blocks the way is met soon
    halving = np.argsort([int(k & -k) for k in steps], kind="stable")[::-1]
    between = start + (steps[halving] / (len(steps) + 1))[:, None] * (end - start)
    opened = ~robot.closes(between)
    if opened.any():
        return np.asarray(between[int(np.argmax(opened))])
    return next((row for row in between if not scene.free(row[None])[0]), None)


def _times(a: Array, b: Array, speed: Array) -> Array:
    """(N, M) seconds from each pose to each other, all joints at once."""
    return np.asarray((np.abs(a[:, None] - b[None]) / speed).max(axis=2))


def _ordered(times: Array) -> Index:
    """An order with little time between neighbours; the first pose stays first."""
    left = set(range(1, len(times)))
    order = [0]
    while left:
        order.append(min(left, key=lambda k: times[order[-1], k]))
        left.remove(order[-1])
    better = True
    while better:
        better = False
        for i in range(1, len(order) - 1):
            for j in range(i + 1, len(order)):
                tried = order[:i] + order[i : j + 1][::-1] + order[j + 1 :]
                if _length(times, tried) < _length(times, order) - 1e-9:
                    order, better = tried, True
    return np.array(order, dtype=np.intp)


def _length(times: Array, order: Sequence[int]) -> float:
    return float(times[order[:-1], order[1:]].sum())


def _trapped(
    robot: Robot, scene: Scene, nodes: Array, count: int, ends: tuple[int, int], speed: Array
) -> int:
    """Which of two poses without a way between them fewer of the other poses are driven to from.

    Args:
        nodes: The roadmap; its first `count` nodes are the poses of the plan.
        ends: The two; where nothing tells, the second one.
    """
    times = _times(nodes[:count], nodes[:count], speed)
    others = [int(k) for k in np.argsort(times[list(ends)].sum(axis=0)) if k not in ends]

    def driven(start: int, end: int) -> bool:
        return (
            straight_is_free(robot, scene, nodes[start], nodes[end])
            or _around(robot, scene, nodes, start, end, speed) is not None
        )

    reached = [sum(driven(end, other) for other in others[:ASKED]) for end in ends]
    return ends[0] if reached[0] < reached[1] else ends[1]


def _around(
    robot: Robot, scene: Scene, nodes: Array, start: int, end: int, speed: Array
) -> list[Array] | None:
    """The shortest way through the roadmap whose edges are all free; None where there is none."""
    times = _times(nodes, nodes, speed)
    near: Mask = np.zeros_like(times, dtype=bool)
    closest = np.argsort(times, axis=1)[:, 1 : NEIGHBOURS + 1]
    near[np.arange(len(nodes))[:, None], closest] = True
    near |= near.T
    near[start, end] = near[end, start] = False
    weight = csr_matrix(np.where(near, times, 0.0))
    known: set[tuple[int, int]] = set()
    for _ in range(ATTEMPTS):
        length, before = dijkstra(weight, indices=start, return_predecessors=True, directed=False)
        if not np.isfinite(length[end]):
            break
        way = [end]
        while way[-1] != start:
            way.append(int(before[way[-1]]))
        for p, q in itertools.pairwise(way):
            edge = (min(p, q), max(p, q))
            if edge in known:
                continue
            if not straight_is_free(robot, scene, nodes[p], nodes[q]):
                weight[p, q] = weight[q, p] = np.inf
                break
            known.add(edge)
        else:
            return [nodes[k] for k in reversed(way)]
    return None
