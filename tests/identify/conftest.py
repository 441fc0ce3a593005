"""An arm, the paper's readings, and readings made from a model."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements import Measurements, NoiseModel, read_measurements
from sk120stiff.model import Model, base_model
from sk120stiff.plan import Schedule, random_poses, simulate
from sk120stiff.robot import Robot, load_robot

DATA = Path(__file__).resolve().parents[2] / "robots" / "motoman_sk120" / "data"
POINT = np.array([-0.06, 0.04, 0.15])


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot("motoman_sk120")


@pytest.fixture(scope="session")
def table2(robot: Robot) -> Measurements:
    return read_measurements(DATA / "table2_measured.csv", robot.actuated)


@pytest.fixture(scope="session")
def springs(robot: Robot) -> Model:
    model = base_model(robot)
    assert model is not None
    return model


def readings_of(
    model: Model,
    *,
    poses: int = 12,
    sigma: float = 10e-6,
    seed: int = 0,
    schedule: Schedule | None = None,
    outliers: float = 0.0,
    growth: float = 0.0,
) -> Measurements:
    """Random poses and load directions, simulated with noise."""
    rng = np.random.default_rng((seed, 1))
    robot = model.robot
    wrench = np.zeros((poses, 6))
    wrench[:, :3] = rng.normal(size=(poses, 3))
    wrench[:, :3] *= 400.0 / np.linalg.norm(wrench[:, :3], axis=1, keepdims=True)
    plan = Measurements(
        pose=tuple(f"p{k}" for k in range(poses)),
        joint_names=robot.actuated,
        joints=random_poses(robot, poses, rng),
        wrench=wrench,
        displacement=None,
        robot=robot.source,
        point=POINT,
    )
    steps = schedule or Schedule("ascending", 4)
    noise = NoiseModel(sigma, growth, steps.zero)
    return simulate(
        model, plan, noise=noise, schedule=steps, outliers=outliers, seed=seed
    ).measurements


def without_statement(readings: Measurements, **changes: object) -> Measurements:
    """The same readings, silent about their noise."""
    return replace(readings, noise=type(readings.noise)(), **changes)
