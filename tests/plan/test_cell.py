"""One function says what is wrong with a pose and its load; one file says what it must keep to."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.plan import Cell, Rig, cell_from_data, feasible, feasible_pool, read_cell
from sk120stiff.plan.design import refuse_count
from sk120stiff.robot import Robot, load_robot
from sk120stiff.robot.collision import Scene
from sk120stiff.robot.solids import Solid

ARM = """<robot name="planar"><link name="base"/>
<link name="upper"><inertial><mass value="10"/><origin xyz="0.5 0 0"/>
 <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
 <collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
 <geometry><cylinder radius="0.05" length="0.8"/></geometry></collision></link>
<link name="fore"><collision><origin xyz="0.4 0 0"/><geometry><sphere radius="0.1"/></geometry>
 </collision></link>
<link name="hand"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
 <limit lower="-3" upper="3" effort="100" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="fore"/>
 <origin xyz="1 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="50" velocity="1"/>
 </joint>
<joint name="c" type="fixed"><parent link="fore"/><child link="hand"/><origin xyz="0.6 0 0"/>
 </joint>
</robot>"""


@pytest.fixture(scope="module")
def arm() -> Robot:
    return load_robot(ARM, base="base", tool="hand")


def wall(x: float) -> Solid:
    T = np.eye(4)
    T[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # its z, the free side, is -x
    T[0, 3] = x
    return Solid("wall", "base", T, "plane")


def faults(arm: Robot, cell: Cell, a, wrench=None, point=(0, 0, 0)) -> str:
    return "; ".join(feasible(arm, cell, a, wrench, point=point).faults[0])


def test_distances_to_a_plane_are_the_geometry(arm: Robot) -> None:
    """The sphere's far side stands at 1 + 0.4 + 0.1 m when the arm is stretched."""
    for gap, hits in ((0.019, True), (0.021, False)):
        cell = Cell(clearance=0.02, obstacles=(wall(1.5 + gap),), tool=())
        assert ("fore to wall" in faults(arm, cell, [0.0, 0.0])) is hits


def test_the_lowest_point_is_the_geometry(arm: Robot) -> None:
    a = np.array([[0.3, 0.4], [-0.5, 1.0]])
    expected = [
        min(-np.sin(t) - 0.4 * np.sin(t + u) - 0.1,
            *(-x * np.sin(t) - 0.05 * np.cos(t) for x in (0.1, 0.9)))
        for t, u in a
    ]  # fmt: skip
    np.testing.assert_allclose(Scene(arm).lowest(a, np.array([0, 0, 1.0])), expected, atol=1e-6)


def test_a_floor_and_a_box_on_the_tool(arm: Robot) -> None:
    tool = Solid("gripper", "hand", np.eye(4), "box", (0.1, 0.1, 0.4))
    cell = Cell(floor=-0.15, tool=(tool,))
    assert "gripper to floor" in faults(arm, cell, [0.0, 0.0])
    assert not faults(arm, Cell(floor=-0.25, tool=(tool,)), [0.0, 0.0])


def test_limits_efforts_and_what_to_do_about_them_are_told(arm: Robot) -> None:
    cell = Cell(angle_margin=np.deg2rad(5.0))
    said = faults(arm, cell, [2.95, 0.0])
    assert "a at 169.0 deg" in said and "-166.9 to 166.9" in said
    # 100 N down at the hand: 60 N·m in b, limit 45; 49 N·m weight and 160 N·m load in a, limit 90
    said = faults(arm, Cell(), [0.0, 0.0], [0, 0, -100.0, 0, 0, 0])
    assert "b must give 60 of 45 N*m" in said and "a must give 209 of 90 N*m" in said
    pool = feasible_pool(arm, poses=np.int64(20), directions=3, force=100.0, point=np.zeros(3))
    verdict = feasible(arm, Cell(), pool.load_cases.a, pool.load_cases.wrench)
    assert verdict.ok.all()


@pytest.mark.parametrize(
    ("rig", "good", "bad"),
    [
        (Rig(directions=np.array([[0, 0, -1.0]])), [0, 0, -20.0], [0, 0, 20.0]),
        (Rig(axis=np.array([1.0, 0, 0]), angle=0.3), [50, 0, 10.0], [50, 0, 30.0]),
        (Rig(anchors=np.array([[1.6, 0, 3.0]])), [0, 0, 20.0], [0, 0, -20.0]),
        (Rig(directions=np.array([[1.0, 0, 0], [0, 0, 1]]), between=True), [9, 0, 9.0], [9, 0, -9]),
        (Rig(steps=(20.0, 40.0)), [40, 0, 0.0], [30, 0, 0.0]),
    ],
)
def test_rigs(arm: Robot, rig: Rig, good, bad) -> None:
    cell = Cell(rig=rig)
    for force, ok in ((good, True), (bad, False)):
        assert feasible(arm, cell, [0.0, 0.0], [*force, 0, 0, 0]).ok[0] == ok
    pool = feasible_pool(arm, poses=15, directions=4, force=40.0, point=np.zeros(3), cell=cell)
    assert feasible(arm, cell, pool.load_cases.a, pool.load_cases.wrench).ok.all()


def test_a_weight_hangs_in_several_sizes_and_the_motors_are_not_blamed_for_its_steps(
    arm: Robot,
) -> None:
    """It has one direction: several loads at a pose are its steps, or halves where it has none."""
    down = np.array([[0, 0, -1.0]])
    for steps in ((5.0, 10.0, 20.0), ()):
        cell = Cell(rig=Rig(directions=down, steps=steps))
        pool = feasible_pool(arm, poses=12, directions=4, force=30.0, point=np.zeros(3), cell=cell)
        cases = pool.load_cases
        readings = np.hstack([cases.a, cases.wrench])
        assert len(np.unique(readings, axis=0)) == len(readings)
        assert feasible(arm, cell, cases.a, cases.wrench).ok.all()
        at_most = np.bincount(pool.pose).max()
        assert at_most >= 3
        refuse_count(pool.pose, 1, at_most)
        with pytest.raises(InputError, match="more directions or steps"):
            refuse_count(pool.pose, 1, at_most + 1)
        assert steps == () or set(-cases.wrench[:, 2]) <= set(steps)
    up = Cell(rig=Rig(directions=np.array([[-0.0, -0.0, 1.0]]), steps=(1.0, 2.0)))
    pool = feasible_pool(arm, poses=12, directions=4, force=400.0, point=np.zeros(3), cell=up)
    assert not any("motors hold" in said for said in pool.remarks)  # two newtons: all of them
    assert not np.signbit(pool.load_cases.wrench).any()


def test_data_tell_floor_and_directions(arm: Robot) -> None:
    a = np.array([[0.0, 0.3], [-0.4, 0.2]])
    down = np.array([[0, 0, -20.0, 0, 0, 0]] * 2)
    cell = cell_from_data(arm, Cell(), a, down, np.zeros(3))
    assert feasible(arm, cell, a, down).ok.all()
    assert not feasible(arm, cell, a, -down).ok.any()
    assert "floor" in faults(arm, cell, [0.5, 0.3])
    assert any("no reading went lower" in said for said in cell.told)
    every = np.concatenate([np.eye(3), -np.eye(3)])
    free = cell_from_data(arm, Cell(), a, np.hstack([every, 0 * every]), np.zeros(3))
    assert "any direction" in free.rig.words


@pytest.mark.parametrize(("least", "drawn"), [(-3.0, True), (0.5, False)])
def test_what_touches_where_no_joint_can_stand_was_not_drawn_so(least: float, drawn: bool) -> None:
    """Folded back at zero the end meets the base: evidence only where the limits allow zero."""
    ball = (
        '<collision><origin xyz="{} 0 0"/><geometry><sphere radius="0.1"/></geometry></collision>'
    )
    limit = '<limit lower="{}" upper="3" effort="9" velocity="1"/></joint>'
    robot = load_robot(
        f"""<robot name="folded"><link name="base">{ball.format(0)}</link>
        <link name="upper">{ball.format(0.5)}</link><link name="hand">{ball.format(-1)}</link>
        <joint name="a" type="revolute"><parent link="base"/><child link="upper"/>
        <axis xyz="0 1 0"/>{limit.format(-3)}
        <joint name="b" type="revolute"><parent link="upper"/><child link="hand"/>
        <origin xyz="1 0 0"/><axis xyz="0 1 0"/>{limit.format(least)}</robot>""",
        base="base",
        tool="hand",
    )
    said = " ".join(Scene(robot).remarks)
    assert ("as they were drawn and are not asked: base and hand" in said) is drawn


FILE = """
floor: -900 mm
tracker: {xyz: [3, 0, 0], axis: [1, 0, 0], cone: 40 deg, range: '0.5, 20 m'}
obstacles:
- {name: post, cylinder: [30, 300], xyz: [2200, 0, 0], unit: mm}
- {name: plate, box: [100, 100, 100], xyz: [0, 0, 2000], unit: mm}
rig: {kind: weight, steps: '10, 20 N'}
"""


def test_a_file_and_the_line_of_sight(arm: Robot, tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(FILE, encoding="utf-8")
    cell = read_cell(path, arm)
    assert cell.floor == -0.9 and cell.rig.steps == (10.0, 20.0)
    assert "post stands between" in faults(arm, cell, [0.0, 0.0])
    assert "between" not in faults(arm, cell, [-0.7, 0.9])
    assert "reflector looks 136 deg past" in faults(arm, cell, [-2.0, 0.0])
    path.write_text(FILE.replace("[2200, 0, 0]", "[2200, 0.3, 0]").replace("0, 20 N", "x"))
    with pytest.raises(InputError, match=r"rig\.steps"):
        read_cell(path, arm)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("flor: 1 m", "flor"),
        ("floor: -900", "'-0.8 m'"),
        ("a, b, c", "the file holds 'a, b, c'"),
        ("obstacles: [{name: x, box: [1, 1]}]", "only 2 numbers"),
        ("obstacles: [{name: x, box: 300 mm}]", "box: [100, 3000, 2000], unit: mm"),
        ("obstacles: [{name: x, box: [1, 1, 1], unit: cm}]", "'cm'"),
        ("obstacles: [{name: x, bix: [1]}]", "'obstacles.0.bix' is not known (did you mean 'box'?"),
        ("obstacles: [{name: x}]", "0 shapes"),
        ("obstacles: [{name: x, box: [1, 1, 0]}]", "positive"),
        ("obstacles: [{name: x, mesh: nowhere.stl}]", "nowhere.stl"),
        ("rig: {kind: cable}", "anchors"),
        ("rig: {kind: weight, axis: [0, 0, 1]}", "one direction"),
        ("tracker: {xyz: [0, 0, 1], range: '3, 2 m'}", "two ends"),
        ("region: {low: [0, 0, 0], high: [1, -1, 1]}", "no inside"),
    ],
)
def test_files_that_cannot_be_read(arm: Robot, tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_cell(path, arm)
    assert said in str(error.value)
