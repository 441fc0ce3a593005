"""The SK120, its springs, and a small pool of candidate readings."""

import numpy as np
import pytest

from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, base_model
from sk120stiff.plan import Pool, random_pool, random_poses
from sk120stiff.robot import Robot, load_robot

POINT = np.array([-0.06, 0.04, 0.15])


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot("motoman_sk120")


@pytest.fixture(scope="session")
def springs(robot: Robot) -> Model:
    model = base_model(robot)
    assert model is not None
    return model


@pytest.fixture(scope="session")
def pool(robot: Robot) -> Pool:
    return random_pool(robot, poses=40, directions=3, force=400.0, point=POINT, seed=1)


@pytest.fixture(scope="session")
def plan(robot: Robot) -> Measurements:
    """Three poses, two of them with two loads."""
    rng = np.random.default_rng(0)
    a = random_poses(robot, 3, rng)
    index = [0, 0, 1, 2, 2]
    wrench = np.zeros((5, 6))
    wrench[:, :3] = 200.0 * rng.normal(size=(5, 3))
    return Measurements(
        pose=tuple(f"p{k}" for k in index),
        joint_names=robot.actuated,
        joints=a[index],
        wrench=wrench,
        displacement=None,
        robot=robot.source,
        base_frame="base_link",
        tool_frame="tool0",
        point=POINT,
    )
