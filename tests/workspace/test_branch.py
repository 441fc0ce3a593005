"""In which branch an arm runs along a path: chosen, kept, said, and found in linear time."""

import time
import tracemalloc
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import Robot, load_robot
from sk120stiff.workspace import branch_of, elastic_arm, joints_along, read_path
from sk120stiff.workspace.branch import joint_heights
from sk120stiff.workspace.path import without_turns
from tests.corpus.robots import example

UP = np.array([0.0, -1.2, 1.6, -1.97, -1.57, 0.0])  # elbow above, tool down
SPRINGS = np.full(6, 3e4)


def ur10() -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        return load_robot(example("ur10_robot.urdf"), tool="tool0")


def other_elbow(robot: Robot) -> np.ndarray:
    """The same tool placement with the elbow on the other side, by inverse kinematics."""
    from sk120stiff.workspace import Task, solve_inverse

    arm = elastic_arm(joint_spring_model(robot, SPRINGS))
    goal = robot.placement(UP)
    rng = np.random.default_rng(0)
    starts = np.concatenate([UP + rng.normal(size=(200, 6)) * [0.1, 1, 2, 1, 0.1, 0.1]])
    task = Task(np.tile(goal[:3, 3], (200, 1)), rotation=np.tile(goal[:3, :3], (200, 1, 1)))
    reached = solve_inverse(arm, task, starts)
    return next(a for a in reached.a[reached.found] if a[2] < -0.5 and abs(a[0] - UP[0]) < 0.5)


def milling_path(folder: Path, robot: Robot, count: int = 40) -> Path:
    """A straight line of 0.3 m from the tool's place at `UP`, tool pointing down."""
    T = robot.placement(UP)
    rpy = [np.arctan2(T[2, 1], T[2, 2]), -np.arcsin(T[2, 0]), np.arctan2(T[1, 0], T[0, 0])]
    angles = ",".join(repr(float(np.degrees(x))) for x in rpy)
    head = "point,x[mm],y[mm],z[mm],roll[deg],pitch[deg],yaw[deg],fx[N],fy[N],fz[N]"
    start = 1e3 * T[:3, 3]
    along = start[1] + np.linspace(0.0, 300.0, count)
    rows = [f"{k},{start[0]!r},{y!r},{start[2]!r},{angles},0,0,-100" for k, y in enumerate(along)]
    path = folder / "path.csv"
    path.write_text("\n".join([head, *rows]).replace("np.float64(", "").replace(")", ""))
    return path


def test_the_arm_keeps_the_branch_of_its_start(tmp_path: Path) -> None:
    robot = ur10()
    arm = elastic_arm(joint_spring_model(robot, SPRINGS))
    path = read_path(milling_path(tmp_path, robot), robot)
    under = other_elbow(robot)
    for start, up in ((UP, True), (under, False)):
        a = joints_along(path, arm, start + 0.05)
        np.testing.assert_allclose(a[0], start, atol=1e-6)
        assert np.abs(np.diff(a, axis=0)).max() < 0.05
        assert (np.sign(a[:, 2]) == np.sign(start[2])).all()
        branch = branch_of(robot, a, 0.0)
        assert branch.elbow == "elbow_joint"
        assert branch.elbow_up is up
        assert branch.jumps == ()
        at = robot.screws(start).origins[2]
        assert branch.elbow_height == pytest.approx(at[2], abs=1e-5)


def test_without_a_start_a_branch_above_the_floor_is_taken(tmp_path: Path) -> None:
    robot = ur10()
    arm = elastic_arm(joint_spring_model(robot, SPRINGS))
    path = read_path(milling_path(tmp_path, robot), robot)
    below = joint_heights(robot, other_elbow(robot)[None]).min()
    floor = float(path.position[:, 2].min() if path.position is not None else 0.0)
    assert below < floor
    a = joints_along(
        path, arm, stays_above=lambda a: (joint_heights(robot, a) >= min(0.0, floor)).all(axis=1)
    )
    assert joint_heights(robot, a).min() >= min(0.0, floor)


def test_a_path_that_ends_out_of_reach_names_its_line(tmp_path: Path) -> None:
    robot = ur10()
    file = milling_path(tmp_path, robot, 5)
    lines = file.read_text().splitlines()
    lines[4] = lines[4].replace(lines[4].split(",")[1], "9000")
    file.write_text("\n".join(lines))
    with pytest.raises(Refusal, match=r"line 5: .*from the one before it"):
        joints_along(read_path(file, robot), elastic_arm(joint_spring_model(robot, SPRINGS)), UP)


def test_many_points_cost_what_they_should(tmp_path: Path) -> None:
    """Ten times the points in far less than ten times the time, and in little memory."""
    robot = ur10()
    arm = elastic_arm(joint_spring_model(robot, SPRINGS))
    seconds, found = {}, {}
    for count in (200, 20_000):
        path = read_path(milling_path(tmp_path, robot, count), robot)
        begin = time.process_time()
        tracemalloc.start()
        found[count] = joints_along(path, arm, UP)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        seconds[count] = time.process_time() - begin
    assert peak < 60e6
    assert seconds[20_000] < 40 * seconds[200]
    assert np.abs(np.diff(found[20_000], axis=0)).max() < 1e-3
    np.testing.assert_allclose(found[20_000][-1], found[200][-1], atol=1e-6)


def test_no_joint_makes_a_whole_turn_that_its_limits_spare() -> None:
    """±360° let the wrist go on from 179° to 181°; ±180° do not."""
    arm = elastic_arm(joint_spring_model(ur10(), SPRINGS))
    a = np.tile(UP, (3, 1))
    a[:, 5] = np.radians([179.0, -179.0, -177.0])
    np.testing.assert_allclose(np.degrees(without_turns(arm, a)[:, 5]), [179.0, 181.0, 183.0])
    short = replace(arm, lower=np.full(6, -np.pi), upper=np.full(6, np.pi))
    np.testing.assert_array_equal(without_turns(short, a), a)
