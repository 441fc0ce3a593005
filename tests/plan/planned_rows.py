"""Plans for public arms, and MuJoCo's word on each of their rows."""

import itertools
import tempfile
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sk120stiff.errors import ToolkitWarning
from sk120stiff.plan import Cell, NoWay, feasible_pool, lowest_points, random_poses, route
from sk120stiff.robot import Robot, load_robot
from tests.corpus.robots import example
from tests.oracles.mujoco_cell import MujocoCell

POINT = np.array([0.0, 0.05, 0.1])
ARMS = {
    "ur10_robot.urdf": "tool0",
    "panda.urdf": "panda_link8",
    "ur3_robot.urdf": "tool0",
    "ur5_robot.urdf": "tool0",
    "kinova.urdf": None,
    "xarm7.urdf": None,
    "talos_left_arm.urdf": None,
    "z1.urdf": None,
    "ur5e": None,
    "motoman_sk120": None,
}
SAMPLED = np.deg2rad(0.5)  # rad, or m, between two questions on a way
PINS = {"motoman_sk120": [("crank", "rod"), ("rod", "link_3_u")]}  # its parallelogram


class Checked(NamedTuple):
    """What MuJoCo says of an arm's plan.

    Attributes:
        rows, wrong: Planned rows, and what is wrong with them.
        touching: Share of random poses that touch something.
        on_the_way, run_into: Poses sampled on the way between the first planned ones, and what
            touches there.
        no_way: Poses to which no way was found.
    """

    rows: int
    wrong: list[str]
    touching: float
    on_the_way: int
    run_into: list[str]
    no_way: int


def rows_of(name: str, poses: int, *, driven: int = 0, seed: int = 7) -> Checked:
    """Plan for an arm, ask MuJoCo of every row, and of the way through the first `driven` poses."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        robot = load_robot(example(name) if name.endswith("urdf") else name, tool=ARMS[name])
    drawn = random_poses(robot, 200, np.random.default_rng(seed))
    floor = float(np.quantile(lowest_points(robot, drawn, POINT), 0.3)) - 0.02
    cell = Cell(floor=floor)
    pool = feasible_pool(
        robot, poses=poses, directions=2, force=200.0, point=POINT, seed=seed, cell=cell
    ).load_cases
    standing = [_values(robot, a) for a in drawn]
    path = robot.document.path
    assert path is not None
    with tempfile.TemporaryDirectory() as folder:
        judge = MujocoCell(
            path, Path(folder), standing, floor + _base_height(robot), PINS.get(name, ())
        )
        wrong = [
            fault
            for row, (a, wrench) in enumerate(zip(pool.a, pool.wrench, strict=True))
            for fault in _faults(judge, robot, row, a, wrench)
        ]
        spoilt = np.mean([bool(judge.contacts(values)) for values in standing])
        way, no_way = _way(robot, cell, np.unique(pool.a, axis=0)[:driven])
        run_into = [
            f"between stops {leg} and {leg + 1}: {pair[0]} touches {pair[1]}"
            for leg, a in way
            for pair in judge.contacts(_values(robot, a))
        ]
    return Checked(pool.count, wrong, float(spoilt), len(way), run_into, no_way)


def _way(robot: Robot, cell: Cell, a: np.ndarray) -> tuple[list[tuple[int, np.ndarray]], int]:
    """Poses half a degree apart on the way through some, with the leg that each lies on.

    A pose to which no way is found is left out, and counted.
    """
    given = len(a)
    while True:
        if len(a) < 2:
            return [], given - len(a)
        try:
            stops = route(robot, cell, a, point=POINT).a
            break
        except NoWay as error:
            a = np.delete(a, error.pose, axis=0)
    out: list[tuple[int, np.ndarray]] = []
    for leg, (p, q) in enumerate(itertools.pairwise(stops)):
        count = int(np.ceil(np.abs(q - p).max() / SAMPLED))
        out += [(leg, p + share * (q - p)) for share in np.linspace(0.0, 1.0, count + 1)]
    return out, given - len(a)


def _faults(judge: MujocoCell, robot: Robot, row: int, a: np.ndarray, wrench: np.ndarray):
    values = _values(robot, a)
    for pair in judge.contacts(values):
        yield f"row {row}: {pair[0]} touches {pair[1]}"
    asked = judge.holding(values, robot.tool_frame, POINT, _in_root(robot) @ wrench[:3])
    for joint in robot.actuated:
        limit = judge.efforts.get(joint, np.inf)
        if abs(asked[joint]) > limit:
            yield f"row {row}: {joint} must give {asked[joint]:.1f} of {limit:.1f}"


def _values(robot: Robot, a: np.ndarray) -> dict[str, float]:
    return {name: float(value) for name, value in robot.joint_values(a).items()}


def _in_root(robot: Robot) -> np.ndarray:
    """Rotation of the base frame in the root, for bases that do not move."""
    body, T = robot.tree.body(robot.base_frame)
    assert body < 0
    return T[:3, :3]


def _base_height(robot: Robot) -> float:
    return float(robot.tree.body(robot.base_frame)[1][2, 3])


__all__ = ["ARMS", "rows_of"]
