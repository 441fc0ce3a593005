"""Places go to a controller in the axes of its maker, not in those of ROS."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.errors import InputError
from sk120stiff.measurements.table.table import table_of
from sk120stiff.plan import Route
from sk120stiff.programs import LANGUAGES
from sk120stiff.programs.building import build
from sk120stiff.programs.controller import (
    checked_text,
    controller_frame,
    frame_words,
    places,
)
from sk120stiff.programs.driving import route_program
from sk120stiff.programs.placing import part_frame, place_text
from sk120stiff.robot import Robot, load_robot
from sk120stiff.robot.description import ControllerRule
from sk120stiff.workspace import LoadedPath
from tests.corpus.robots import example

SK120 = Path(__file__).resolve().parents[2] / "robots/motoman_sk120"
SHIFT = [0.02, -0.05, 0.45]  # m, and a turn about z: where `base` lies in these tests
YAW = 0.7


def with_base(tmp_path: Path, prefix: str = "") -> Robot:
    """The SK120 with a link `base` beside `base_link`, as ROS-Industrial describes arms."""
    text = (SK120 / "sk120.urdf").read_text().replace('"base_link"', f'"{prefix}base_link"')
    xyz = " ".join(map(str, SHIFT))
    text = text.replace(
        "</robot>",
        f'<link name="{prefix}base"/><joint name="to_base" type="fixed">'
        f'<parent link="{prefix}base_link"/><child link="{prefix}base"/>'
        f'<origin xyz="{xyz}" rpy="0 0 {YAW}"/></joint></robot>',
    )
    file = tmp_path / "sk120.urdf"
    file.write_text(text)
    (tmp_path / "robot.yaml").write_text(
        (SK120 / "robot.yaml").read_text().replace("base_link", f"{prefix}base_link")
    )
    return load_robot(str(tmp_path))


def in_base(T: np.ndarray) -> np.ndarray:
    turned = Rotation.from_euler("z", YAW).as_matrix()
    found = T.copy()
    found[..., :3, :3] = turned.T @ T[..., :3, :3]
    found[..., :3, 3] = (T[..., :3, 3] - SHIFT) @ turned
    return found


@pytest.mark.parametrize("name", LANGUAGES)
def test_every_language_states_places_in_the_link_base(name: str, tmp_path: Path) -> None:
    language, robot, plain = LANGUAGES[name], with_base(tmp_path), load_robot("motoman_sk120")
    a = np.random.default_rng(4).uniform(-0.4, 0.4, (5, 6))
    program = program_of(language, robot, a)
    found = language.read(checked_text(language, program, robot, a, None, part_of(language)))
    T = plain.placement(a)
    expected = T if language.in_part_frame(program.settings) else in_base(T)
    np.testing.assert_allclose(found.position, expected[:, :3, 3], atol=1e-6)
    if found.rotation is not None:
        np.testing.assert_allclose(found.rotation, expected[:, :3, :3], atol=1e-5)


def test_a_place_in_other_axes_than_the_controllers_is_refused(tmp_path: Path) -> None:
    language, robot = LANGUAGES["urscript"], with_base(tmp_path)
    a = np.random.default_rng(4).uniform(-0.4, 0.4, (5, 6))
    program = program_of(language, robot, a)
    T = robot.placement(a)
    for wrong in (
        replace(program, position=T[:, :3, 3]),
        replace(program, rotation=T[:, :3, :3]),
    ):
        with pytest.raises(RuntimeError, match="off its target"):
            checked_text(language, wrong, robot, a)


def test_the_parts_frame_stays_the_parts(tmp_path: Path) -> None:
    language, robot = LANGUAGES["krl"], with_base(tmp_path)
    a = np.random.default_rng(5).uniform(-0.4, 0.4, (5, 6))
    part = part_frame("x=1500 mm; y=-300 mm; yaw=20 deg")
    program = program_of(language, robot, a, part, {"base": "3"})
    found = language.read(checked_text(language, program, robot, a, None, part))
    expected = np.linalg.inv(part) @ robot.placement(a)
    np.testing.assert_allclose(found.position, expected[:, :3, 3], atol=1e-6)
    where = part_frame(frame_words(robot, part)[1].partition(": ")[2].rstrip("."))
    np.testing.assert_allclose(where, in_base(part), atol=1e-9)  # what to type into BASE_DATA[3]


def test_a_way_through_poses_says_places_in_the_same_axes(tmp_path: Path) -> None:
    robot = with_base(tmp_path)
    a = np.random.default_rng(6).uniform(-0.4, 0.4, (3, 6))
    route = Route(order=np.array([0, 1]), a=a, pose=np.array([0, -1, 1]), seconds=1.0)
    language = LANGUAGES["rapid"]
    program = route_program(language, "way", robot, route, ["1", "2"])
    found = language.read(checked_text(language, program, robot, a))
    expected = in_base(load_robot("motoman_sk120").placement(a))
    np.testing.assert_allclose(found.position, expected[:, :3, 3], atol=1e-6)
    assert "controller's own base is the frame base" in " ".join(program.header)


def test_which_link_is_the_controllers(tmp_path: Path) -> None:
    plain = load_robot("motoman_sk120")
    assert controller_frame(plain) == plain.base_frame and frame_words(plain) == ()
    a = np.zeros((1, 6))
    np.testing.assert_allclose(places(plain, a, None), plain.placement(a), atol=1e-15)
    left = with_base(tmp_path, "left_")
    assert controller_frame(left) == "left_base"
    own = replace(left, controller=ControllerRule(frame="left_base_link"))
    assert controller_frame(own) == "left_base_link" and frame_words(own) == ()
    moved = replace(left, controller=ControllerRule(frame=left.tool_frame))
    with pytest.raises(InputError, match="moves against the base"):
        controller_frame(moved)
    absent = replace(left, controller=ControllerRule(frame="bse"))
    with pytest.raises(InputError, match="no frame 'bse'"):
        controller_frame(absent)


def test_a_base_that_rides_on_a_rail_is_not_the_controllers(tmp_path: Path) -> None:
    arm = example("ur10_robot.urdf").read_text()
    file = tmp_path / "rail.urdf"
    file.write_text(
        arm.replace(
            '<joint name="world_joint" type="fixed">',
            '<joint name="world_joint" type="prismatic"><axis xyz="1 0 0"/>'
            '<limit lower="0" upper="2" effort="1000" velocity="1"/>',
        )
    )
    robot = load_robot(str(file), base="world", tool="tool0")
    assert robot.n == 7 and controller_frame(robot) == "world"


def test_a_placement_in_words_is_read_as_it_was_meant() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        T = np.eye(4)
        T[:3, :3] = Rotation.random(random_state=int(rng.integers(10**6))).as_matrix()
        T[:3, 3] = rng.uniform(-2, 2, 3)
        np.testing.assert_allclose(part_frame(place_text(T)), T, atol=2e-8)
    np.testing.assert_array_equal(part_frame(place_text(np.eye(4))), np.eye(4))


def part_of(language):
    return np.eye(4) if language.name == "gcode" else None


def program_of(language, robot, a, part=None, given=None):
    return build(
        language, Path("way"), plain_path(a), robot, a, frame=None,
        part=np.eye(4) if part is None else part, feed=0.01, rapid=0.1, by_joints=False,
        given=given or {}, facts=(), date="2026/11/22 09:30",
    )  # fmt: skip


def plain_path(a):
    count = len(a)
    rows = [[str(k)] for k in range(count)]
    table = table_of(Path("way.csv"), ["point"], 1, rows, list(range(2, count + 2)))
    speed, rapid = np.full(count, np.nan), np.zeros(count, dtype=bool)
    return LoadedPath(np.zeros((count, 6)), a, None, None, table, speed, rapid)
