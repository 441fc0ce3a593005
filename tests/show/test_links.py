"""Link placement in the scene against Pinocchio's, for links on and off the chain."""

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.robot import Robot
from sk120stiff.show.links import link_tree
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


def test_a_link_is_anchored_to_the_last_chain_joint_that_moves_it() -> None:
    robot = sk120()
    tree = link_tree(robot)
    chain = robot.mechanism().chain
    anchors = dict(zip(tree.names, tree.anchors(chain.names), strict=True))
    assert anchors["base_link"] == -1
    assert chain.names[anchors["crank"]] == "joint_1_s"
    assert chain.names[anchors["rod"]] == "joint_1_s"
    assert chain.names[anchors["reflector"]] == "joint_6_t"
