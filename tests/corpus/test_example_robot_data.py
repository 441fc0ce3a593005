"""Every URDF of example-robot-data: it loads or is refused for a listed reason, and it is right.

The oracle reads the same file with xml.etree and 4x4 matrices and shares nothing with the product.
"""

import warnings
import zlib
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.robot import STANDARD_GRAVITY, Robot, load_robot
from sk120stiff.robot.checks import check_robot
from sk120stiff.robot.urdf import read_urdf
from sk120stiff.robot.visuals import visuals
from sk120stiff.stiffness import complementary_stiffness
from tests.corpus.robots import example_urdfs
from tests.oracles.numpy_kinematics import GRAVITY, UrdfTree

# Fixed joints of some files have a zero axis, which the oracle divides by and never uses.
pytestmark = pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")

URDFS = example_urdfs()
REFUSED = {
    "ur3.urdf": "the robot has no links",
}
NOTHING_MOVES = {"quadrotor_base.urdf", "iris_simple.urdf"}
MOVING = [path for path in URDFS if path.name not in {*REFUSED, *NOTHING_MOVES}]


def label(path: Path) -> str:
    return f"{path.parent.parent.name}/{path.name}"


def loaded(path: Path) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        return load_robot(path)


def poses(robot: Robot, count: int) -> np.ndarray:
    """Random coordinates inside the limits, the same on every run."""
    rng = np.random.default_rng(zlib.crc32(robot.name.encode()))
    low, high = np.maximum(robot.lower, -2.0), np.minimum(robot.upper, 2.0)
    return rng.uniform(np.minimum(low, high), np.maximum(low, high), size=(count, robot.n))


def test_the_corpus_is_complete() -> None:
    assert len(URDFS) >= 69
    assert {path.name for path in URDFS} >= {*REFUSED, *NOTHING_MOVES}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_for_the_listed_reason(name: str) -> None:
    (path,) = [path for path in URDFS if path.name == name]
    with pytest.raises(InputError, match=REFUSED[name]) as refusal:
        load_robot(path)
    assert refusal.value.where is not None
    assert "line" in refusal.value.where
    assert refusal.value.remedy


@pytest.mark.parametrize("path", URDFS, ids=label)
def test_check_and_picture_never_crash(path: Path) -> None:
    if path.name in REFUSED:
        return
    report = check_robot(path)
    assert report.frames
    assert (report.actuated == ()) == (path.name in NOTHING_MOVES)
    document = read_urdf(path)
    shapes = visuals(document)
    assert len(shapes) + len(shapes.findings) == len(document.visuals)
    if path.name != "romeo_laas_small.urdf":  # its meshes are not in the package
        assert not shapes.findings


@pytest.mark.parametrize("path", MOVING, ids=label)
def test_kinematics_and_gravity_against_matrices(path: Path) -> None:
    robot, oracle = loaded(path), UrdfTree(path)
    assert robot.base_frame == oracle.root
    a = poses(robot, 1)[0]
    values = dict(zip(robot.actuated, map(float, a), strict=True))
    for frame in robot.frames:
        error = robot.placement(a, frame) - oracle.placement(values, frame)
        assert np.abs(error).max() < 1e-9, frame
    expected = -oracle.gravity_torque(values, list(robot.actuated))
    expected *= STANDARD_GRAVITY / np.linalg.norm(GRAVITY)
    scale = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(robot.gravity_torque(a), expected, atol=1e-7 * scale)


@pytest.mark.parametrize("path", MOVING, ids=label)
def test_jacobian_and_complementary_stiffness_against_differences(path: Path) -> None:
    robot = loaded(path)
    point, wrench = np.array([0.03, -0.02, 0.05]), np.array([70.0, -40.0, 90.0, 8.0, -5.0, 6.0])
    (a,) = poses(robot, 1)
    oracle = UrdfTree(path)
    values = dict(zip(robot.actuated, map(float, a), strict=True))
    expected = oracle.jacobian(values, robot.tool_frame, list(robot.actuated), point)
    np.testing.assert_allclose(robot.jacobian(a, point=point), expected, atol=1e-8)

    step = 1e-3
    K_C = complementary_stiffness(robot.screws(a, point=point), wrench)
    for j in range(robot.n):
        moved = a + step * np.array([[1.0], [-1.0], [2.0], [-2.0]]) * np.eye(robot.n)[j]
        torques = np.einsum("pij,i->pj", robot.jacobian(moved, point=point), wrench)
        slope = (8 * (torques[0] - torques[1]) - (torques[2] - torques[3])) / (12 * step)
        np.testing.assert_allclose(K_C[:, j], slope, atol=1e-6)
