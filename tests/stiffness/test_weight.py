"""The arm's own weight: torques against Pinocchio, stiffness and sag against finite differences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.robot import load_robot
from sk120stiff.stiffness import (
    Weight,
    equilibrium,
    gravity_stiffness,
    gravity_torques,
    linear_springs,
)

FOLDER = Path(__file__).parents[1] / "hidden" / "robots"
LOAD = np.array([40.0, -30.0, 60.0, 0.0, 0.0, 0.0])


@pytest.fixture(params=["six_axis.urdf", "telescope.urdf"])
def heavy(request):
    robot = load_robot(FOLDER / request.param)
    rng = np.random.default_rng(3)
    a = rng.uniform(-1.0, 1.0, (6, robot.n)) * np.where(robot.prismatic, 0.2, 1.0)
    return robot, a


def test_torques_are_pinocchios(heavy):
    robot, a = heavy
    found = gravity_torques(robot.screws(a), robot.gravity_in_base)
    assert np.abs(found).max() > 10.0
    assert np.allclose(found, robot.gravity_torque(a), rtol=0, atol=1e-10)


def test_stiffness_is_the_derivative_of_the_torques(heavy):
    robot, a = heavy
    found = gravity_stiffness(robot.screws(a), robot.gravity_in_base)
    step = 1e-6
    for j in range(robot.n):
        e = step * np.eye(robot.n)[j]
        slope = (robot.gravity_torque(a + e) - robot.gravity_torque(a - e)) / (2 * step)
        assert np.allclose(found[..., j], slope, rtol=0, atol=1e-6)


def test_sag_balances_weight_and_load(heavy):
    robot, a = heavy
    springs = np.full(robot.n, 2e5)
    weight = Weight(robot.gravity_in_base, np.diag(1.0 / springs))
    rest = equilibrium(robot.mechanism(), a, LOAD, linear_springs(springs), weight=weight)
    pull = robot.screws(rest.z).torques(LOAD) + robot.gravity_torque(rest.z)
    assert np.allclose(springs * (rest.z - a), pull, rtol=0, atol=1e-8)
    light = equilibrium(robot.mechanism(), a, LOAD, linear_springs(springs))
    assert np.abs(rest.z - light.z).max() > 1e-4
