"""What is planned can be driven: efforts, floor and pedestal, on public arms."""

import warnings
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import Refusal, ToolkitWarning
from sk120stiff.explain.advise.consequences import next_poses
from sk120stiff.explain.findings import Finding
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import joint_spring_model
from sk120stiff.plan import Cell, Rig, feasible, feasible_pool, lowest_points, random_poses
from sk120stiff.robot import Robot, load_robot
from sk120stiff.robot.anatomy import arm_length
from tests.corpus.robots import example
from tests.oracles.numpy_kinematics import UrdfTree

ARMS = {"panda.urdf": "panda_link8", "ur10_robot.urdf": "tool0", "ur5_robot.urdf": "tool0"}
POINT = np.array([0.0, 0.05, 0.1])


def arm(name: str) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        return load_robot(example(name), tool=ARMS[name])


def efforts(name: str, robot: Robot) -> np.ndarray:
    stated = {
        joint.get("name"): float(joint.find("limit").get("effort"))  # type: ignore[union-attr]
        for joint in ET.parse(example(name)).getroot().iter("joint")
        if joint.find("limit") is not None
    }
    return np.array([stated[joint] for joint in robot.actuated])


@pytest.mark.parametrize("name", ARMS)
def test_no_motor_is_asked_for_more_than_it_has(name: str) -> None:
    """Torques by differences of 4x4 matrices, and the URDF read with xml.etree."""
    robot = arm(name)
    pool = feasible_pool(robot, poses=40, directions=4, force=400.0, point=POINT, seed=3)
    tree = UrdfTree(example(name).read_text(encoding="utf-8"))
    limit = efforts(name, robot)
    tight = 0
    for a, wrench in zip(pool.load_cases.a[::7], pool.load_cases.wrench[::7], strict=True):
        values = dict(zip(robot.actuated, a, strict=True))
        J = tree.jacobian(values, ARMS[name], list(robot.actuated), POINT)
        asked = np.abs(J.T @ wrench + robot.gravity_torque(a))
        assert (asked <= 0.9 * limit + 1e-6).all()
        tight += bool((asked > 0.88 * limit).any())
    assert tight  # loads are as large as they may be
    sizes = np.linalg.norm(pool.load_cases.wrench[:, :3], axis=1)
    assert sizes.max() <= 400.0 + 1e-9 and sizes.min() < 300.0
    assert any("400 N" in said and "effort" in said for said in pool.remarks)
    small = feasible_pool(robot, poses=20, directions=2, force=5.0, point=POINT, seed=3)
    np.testing.assert_allclose(np.linalg.norm(small.load_cases.wrench[:, :3], axis=1), 5.0)
    assert not any("effort" in said for said in small.remarks)


def test_what_nobody_stated_is_told(robot: Robot) -> None:
    told = feasible_pool(robot, poses=10, directions=2, force=400.0, point=POINT).remarks
    assert any("states no efforts" in said for said in told)
    assert any("No floor was given" in said for said in told)


def test_motors_that_cannot_hold_the_arm_itself_are_no_motors(tmp_path) -> None:
    text = example("ur10_robot.urdf").read_text(encoding="utf-8")
    for effort in ("330.0", "150.0", "54.0"):
        text = text.replace(f'effort="{effort}"', 'effort="1"')
    weak = tmp_path / "weak.urdf"
    weak.write_text(text, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        robot = load_robot(weak, tool="tool0")
    with pytest.raises(Refusal, match="own weight"):
        feasible_pool(robot, poses=20, directions=2, force=100.0, point=POINT)


@pytest.mark.parametrize("name", ARMS)
def test_wrist_and_tool_stay_out_of_the_pedestal(name: str) -> None:
    robot = arm(name)
    tree = UrdfTree(example(name).read_text(encoding="utf-8"))

    def inside(a: np.ndarray) -> bool:
        """Tool, point or wrist in the cylinder below the shoulder, by 4x4 matrices."""
        values = dict(zip(robot.actuated, a, strict=True))
        wrist = next(j.child for j in robot.document.joints if j.name == robot.actuated[-1])
        places = ((ARMS[name], POINT), (ARMS[name], np.zeros(3)), (wrist, np.zeros(3)))
        points = [tree.point(values, link, at) for link, at in places]
        return any(np.hypot(p[0], p[1]) < radius and p[2] < shoulder - radius for p in points)

    radius = 0.08 * arm_length(robot)
    shoulder = robot.screws(robot.rest).origins[1][2]
    drawn = random_poses(robot, 150, np.random.default_rng(0))
    assert 0.01 < np.mean([inside(a) for a in drawn]) < 0.5 or name == "panda.urdf"
    pool = feasible_pool(robot, poses=60, directions=1, force=10.0, point=POINT, seed=1)
    assert not any(inside(a) for a in pool.load_cases.a)


def test_a_floor_holds_for_every_moving_link() -> None:
    robot = arm("ur10_robot.urdf")
    cell = Cell(floor=0.0)
    pool = feasible_pool(robot, poses=40, directions=1, force=10.0, point=POINT, cell=cell)
    tree = UrdfTree(example("ur10_robot.urdf").read_text(encoding="utf-8"))
    moving = [joint.child for joint in robot.document.joints if joint.name in robot.actuated]
    for a in pool.load_cases.a:
        values = dict(zip(robot.actuated, a, strict=True))
        assert min(tree.point(values, link, np.zeros(3))[2] for link in moving) >= 0.0
        assert tree.point(values, "tool0", POINT)[2] >= 0.0
    assert lowest_points(robot, pool.load_cases.a, POINT).min() >= cell.clearance
    assert not any("No floor" in said for said in pool.remarks)


def test_the_next_poses_of_an_explanation_are_feasible_too() -> None:
    """No lower than what was measured, clear of the column, and within the efforts."""
    robot = arm("ur10_robot.urdf")
    model = joint_spring_model(robot, np.full(6, 2e4))
    rng = np.random.default_rng(2)
    measured = random_poses(robot, 400, rng)
    measured = measured[lowest_points(robot, measured, POINT) > 0.02][:12]
    load_cases = load_case(robot, measured, [0, 0, -300.0, 0, 0, 0], point=POINT)
    tilt = effect(robot, "joint_tilt", robot.actuated[1])
    finding = Finding(tilt, (f"joint_tilt:{robot.actuated[2]}",), exact=(), evidence=None)
    final = SimpleNamespace(
        problem=SimpleNamespace(load_cases=load_cases),
        model=model + finding.effect,
        noise_factor=1.0,
    )
    answer = SimpleNamespace(
        findings=(finding,),
        final=final,
        noise=NoiseModel(1e-5),
        effect=lambda _: effect(robot, "joint_tilt", robot.actuated[2]),
    )
    found = next_poses(answer, seed=0)  # type: ignore[arg-type]
    assert found is not None
    a, wrench, remarks, pairs = found
    assert [pair.rival for pair in pairs] == [f"joint_tilt:{robot.actuated[2]}"]
    assert any("the motors hold" in said for said in remarks)
    assert lowest_points(robot, a, POINT).min() > 0.02
    at = robot.screws(a, point=POINT)
    assert feasible(robot, Cell(), a, wrench, point=POINT).ok.all()
    asked = np.abs(at.torques(wrench) + robot.gravity_torque(a))
    assert (asked <= 0.9 * efforts("ur10_robot.urdf", robot) + 1e-6).all()
    up = Rig("a cable", anchors=np.array([[0.8, 0.0, 3.0]]))
    cell = Cell(low=np.array([0.2, -2.0, 0.0]), rig=up)
    assert not feasible(robot, cell, a, wrench, point=POINT).ok.all()
    a, wrench, _, _ = next_poses(answer, seed=0, cell=cell)  # type: ignore[arg-type, misc]
    assert feasible(robot, cell, a, wrench, point=POINT).ok.all()


def test_an_arm_on_a_rail_has_no_column() -> None:
    rail = load_robot(
        """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
        <joint name="x" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
        <limit lower="0" upper="1" effort="0" velocity="0"/></joint>
        <joint name="y" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0 0 1"/>
        <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint>
        <joint name="z" type="revolute"><parent link="c"/><child link="d"/><origin xyz="1 0 0"/>
        <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint></robot>"""
    )
    told = feasible_pool(rail, poses=5, directions=1, force=1.0, point=np.zeros(3)).remarks
    assert any("does not turn" in said for said in told)


def test_the_range_that_motors_hold_is_that_of_all_loads_of_that_size():
    """Loads are drawn as unit vectors: no two of them are of exactly the same size."""
    robot = load_robot("ur5e")
    pool = feasible_pool(robot, poses=60, directions=6, force=400.0, point=np.zeros(3), seed=2)
    size = np.linalg.norm(pool.load_cases.wrench[:, :3], axis=1)
    (said,) = (text for text in pool.remarks if "the motors hold" in text)
    assert f"{size.min():.3g} to {size.max():.3g} N" in said
