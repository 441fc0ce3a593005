"""An arm on a wall: where weight pulls is said by the readings, and goes with the model."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.cli.opening import open_data

WALL = np.array([9.81, 0.0, 0.0])
STAND = (  # the base's x axis points down
    '<link name="wall"/><joint name="bolts" type="fixed"><parent link="wall"/>'
    '<child link="BASE"/><origin xyz="0 0 0" rpy="0 1.5707963267948966 0"/></joint></robot>'
)


@pytest.fixture
def readings(tmp_path: Path) -> Path:
    """A CSV file of displacements of an arm on a wall."""
    robot = sk.load_robot("ur5e")
    joints = ",".join(f"{name}[rad]" for name in robot.actuated)
    file = tmp_path / "wall.csv"
    file.write_text(
        f"pose,{joints},fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm]\n"
        "a,0,-1.2,1.4,-1.2,-1.5,0,0,0,-50,0.1,0,-0.5\n"
        "b,0.5,-0.8,1.0,-1.2,-1.5,0,0,50,0,0,0.4,0.1\n"
        "c,-0.5,-1.0,1.2,-1.0,-1.2,0,50,0,0,0.3,0.1,-0.1\n"
    )
    file.with_suffix(".yaml").write_text("robot: ur5e\ngravity: [9.81, 0, 0]\n")
    return file


def test_weight_is_that_of_the_same_arm_turned() -> None:
    """Telling where weight pulls is the same as turning the base in the URDF."""
    robot = sk.load_robot("ur5e")
    urdf = (sk.bundled_robots()["ur5e"] / "ur5e.urdf").read_text()
    a = np.array([0.3, -1.1, 1.2, 0.2, 0.5, 0.1])
    turned = urdf.replace("</robot>", STAND.replace("BASE", robot.base_frame))
    other = sk.load_robot(turned, base=robot.base_frame, tool=robot.tool_frame)
    own = robot.under(WALL)
    np.testing.assert_allclose(other.gravity_in_base / 9.80665, WALL / 9.81, atol=1e-12)
    np.testing.assert_allclose(
        own.gravity_torque(a) / 9.81, other.gravity_torque(a) / 9.80665, atol=1e-9
    )
    assert abs(robot.gravity_torque(a)[0]) < 1e-9 < abs(own.gravity_torque(a)[0])


def test_readings_of_displacements_say_it(readings: Path) -> None:
    """The key is heard for displacements too: by commands, and by a fit from Python."""
    data, robot = open_data(readings)
    np.testing.assert_allclose(robot.gravity_in_base, WALL, atol=1e-12)
    found = sk.fit(sk.base_model(sk.load_robot("ur5e")), data)
    np.testing.assert_allclose(found.model.robot.gravity_in_base, WALL, atol=1e-12)


def test_files_keep_it(readings: Path, tmp_path: Path) -> None:
    """Readings and models that are written say it; the readings hold over the model."""
    data, robot = open_data(readings)
    assert data.gravity is not None
    copy = sk.read(sk.write_measurements(data, tmp_path / "copy.csv"))
    assert copy.gravity is not None and np.array_equal(copy.gravity, WALL)
    file = sk.write_model(sk.base_model(robot), tmp_path / "model.yaml")
    again = sk.read_model(file)
    np.testing.assert_allclose(again.robot.gravity_in_base, WALL, atol=1e-12)
    ceiling = robot.under(np.array([0.0, 0.0, 9.81]))
    assert np.allclose(sk.read_model(file, ceiling).robot.gravity_in_base, [0.0, 0.0, 9.81])
    plain = sk.write_model(sk.base_model(sk.load_robot("ur5e")), tmp_path / "floor.yaml")
    assert "gravity" not in plain.read_text()
