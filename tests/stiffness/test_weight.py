"""The arm's own weight: torques against Pinocchio, stiffness and sag against finite differences."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import Refusal
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import (
    Weight,
    equilibrium,
    gravity_stiffness,
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
    found = robot.screws(a).gravity_torques(robot.gravity_in_base)
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


def test_a_column_stands_under_its_own_weight_up_to_m_g_L():
    """1000 N·m/rad hold a mass at 2 m up to 50.97 kg; upright it is in balance with any mass."""
    column = """<robot name="column"><link name="floor"/><link name="top"><inertial>
<origin xyz="0 0 2"/><mass value="{}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
</inertial></link><joint name="hinge" type="revolute"><parent link="floor"/><child link="top"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint></robot>"""
    weight = Weight(np.array([0.0, 0.0, -9.81]), np.array([[1e-3]]))

    def rest(mass):
        mechanism, law = load_robot(column.format(mass)).mechanism(), linear_springs([1000.0])
        return equilibrium(mechanism, np.zeros(1), np.zeros(6), law, weight=weight)

    assert rest(50.0).z[0] == 0.0
    with pytest.raises(Refusal, match=r"falls under its own weight, at 0\.98"):
        rest(52.0)
