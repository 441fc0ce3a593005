"""Any serial arm through the product against MuJoCo's statics of the same URDF."""

import numpy as np
import pytest

from sk120stiff.robot import load_robot
from tests.oracles.mujoco_serial import deflect_urdf
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.sample_urdfs import six_axis_arm
from tests.stiffness.arms import deflection

STIFFNESS = np.array([1e6, 5e5, 4e5, 1e5, 1e5, 5e4])
WRENCH = np.array([300, -400, 500, 80, -60, 40.0])
POINT = np.array([0.1, 0.2, 0.3])


@pytest.mark.parametrize("seed", [None, 1, 2, 3])
@pytest.mark.parametrize("part", [(1, 1, 1, 0, 0, 0), (0, 0, 0, 1, 1, 1), (1, 1, 1, 1, 1, 1)])
def test_deflection_agrees_with_mujoco(seed, part):
    text, wrench = six_axis_arm(seed), WRENCH * part
    robot, tree = load_robot(text, base="base", tool="tool"), UrdfTree(text)
    assert list(robot.actuated) == tree.independent
    for pose in np.random.default_rng(seed).uniform(-2, 2, (3, 6)):
        values = dict(zip(tree.independent, pose, strict=True))
        springs = dict(zip(tree.independent, STIFFNESS, strict=True))
        theirs = deflect_urdf(tree, "tool", values, springs, wrench, POINT)
        ours = deflection(robot.mechanism(), pose, wrench, STIFFNESS, POINT)
        assert np.linalg.norm(theirs.displacement) > 1e-5
        assert np.allclose(ours.equilibrium, theirs.displacement, rtol=0, atol=1e-9)
        assert np.max(np.abs(ours.conventional - theirs.displacement)) > 2e-9
