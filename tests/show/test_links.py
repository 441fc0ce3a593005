"""Link placement in the scene against Pinocchio's, for links on and off the chain."""

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.show.scene.links import link_tree
from tests.show.scenes import TWO_SLIDES, random_pose, sk120

SOURCES = ["motoman_sk120", TWO_SLIDES]


@pytest.fixture(params=SOURCES, ids=["sk120", "gantry"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return load_robot(request.param)


def test_every_link_is_where_pinocchio_puts_it(robot: Robot) -> None:
    tree = link_tree(robot)
    generator = np.random.default_rng(1)
    for _ in range(5):
        a = random_pose(robot, generator)
        placed = tree.place(robot.coupling.motion(a).q)
        for name, T in zip(tree.names, placed, strict=True):
            np.testing.assert_allclose(T, robot.placement(a, name), atol=1e-12, err_msg=name)


def test_the_five_bar_stays_closed() -> None:
    robot = sk120()
    tree = link_tree(robot)
    rod, lever = tree.names.index("rod_end"), tree.names.index("forearm_lever_end")
    generator = np.random.default_rng(2)
    for _ in range(20):
        placed = tree.place(robot.coupling.motion(random_pose(robot, generator)).q)
        np.testing.assert_allclose(placed[rod, :3, 3], placed[lever, :3, 3], atol=1e-12)


def test_a_link_rides_on_the_virtual_joints_before_it_and_on_no_other() -> None:
    robot = sk120()
    T = np.eye(4)
    T[:3, 3] = 0.1, 0.2, 0.3
    slide = VirtualJoint("slide", 1, T, np.array([1.0, 0.0, 0.0]), revolute=False)
    mechanism = robot.mechanism().with_virtual_joints([slide])
    tree = link_tree(robot)
    z = np.zeros(7)
    z[6] = 0.01
    q = mechanism.elastic.motion(z).q
    placed = tree.riding(mechanism.chain).place(q)[: len(tree.names)]
    moved = np.linalg.norm((placed - tree.place(q))[:, :3, 3], axis=1)
    by_name = dict(zip(tree.names, moved, strict=True))
    for name, distance in {"link_2_l": 0.0, "crank": 0.0, "tool0": 0.01, "reflector": 0.01}.items():
        assert by_name[name] == pytest.approx(distance, abs=1e-12), name
