"""Ways between poses: short, free of what stands there, and honest where there is none."""

import sys
from itertools import permutations

import numpy as np
import pytest

from sk120stiff.errors import Refusal
from sk120stiff.plan import Cell, NoWay, jumps, route
from sk120stiff.plan.route import joint_speeds
from sk120stiff.robot import load_robot
from sk120stiff.robot.solids import Solid
from tests.plan.test_cell import ARM


@pytest.fixture(scope="module")
def arm():
    return load_robot(ARM, base="base", tool="hand")


def test_the_order_is_nearly_the_best_of_all(arm) -> None:
    a = np.random.default_rng(4).uniform(-1.0, 1.0, (7, 2))
    free = Cell(pedestal=0.0, clearance=0.0)
    found = route(arm, free, a)
    speed = joint_speeds(arm)

    def seconds(order) -> float:
        return float((np.abs(np.diff(a[list(order)], axis=0)) / speed).max(axis=1).sum())

    best = min(seconds((0, *rest)) for rest in permutations(range(1, 7)))
    assert sorted(found.order.tolist()) == list(range(7)) and found.order[0] == 0
    assert found.seconds == pytest.approx(seconds(found.order))
    assert found.seconds <= 1.1 * best


def test_the_way_goes_around_a_post(arm) -> None:
    """A post before the stretched arm: between above and below it, the arm must fold."""
    T = np.eye(4)
    T[0, 3] = 1.35
    post = Solid("post", "base", T, "sphere", (0.1,))
    cell = Cell(pedestal=0.0, clearance=0.0, obstacles=(post,))
    a = np.array([[-0.6, 0.0], [0.6, 0.0]])
    straight = route(arm, Cell(pedestal=0.0, clearance=0.0), a)
    assert len(straight.a) == 2
    found = route(arm, cell, a)
    assert (found.pose == -1).any() and found.seconds > straight.seconds
    for start, end in zip(found.a[:-1], found.a[1:], strict=True):  # the sphere's own geometry
        for t, u in start + np.linspace(0, 1, 200)[:, None] * (end - start):
            elbow = np.array([np.cos(t), -np.sin(t)])
            ball = elbow + 0.4 * np.array([np.cos(t + u), -np.sin(t + u)])
            assert np.hypot(*(ball - [1.35, 0.0])) > 0.199
    wall = Solid("wall", "base", np.eye(4), "box", (4.0, 4.0, 0.02))
    with pytest.raises(Refusal, match="no free way"):
        route(arm, Cell(pedestal=0.0, obstacles=(wall,)), a)


def ball(name: str, x: float, z: float) -> Solid:
    T = np.eye(4)
    T[[0, 2], 3] = x, z
    return Solid(name, "base", T, "sphere", (0.1,))


def test_the_pose_that_is_trapped_is_the_one_to_leave_out(arm, monkeypatch) -> None:
    """The first pose holds the hand between two posts; the others all go to each other."""
    monkeypatch.setattr(sys.modules["sk120stiff.plan.route"], "ROADMAPS", (60,))
    posts = ball("above", 1.4, 0.22), ball("below", 1.4, -0.22)
    cell = Cell(pedestal=0.0, clearance=0.0, obstacles=posts)
    free = [[-1.2, 0.3], [-1.4, -0.2], [-1.0, -0.6], [-1.6, 0.4]]
    with pytest.raises(NoWay) as caught:
        route(arm, cell, np.array([[0.0, 0.0], *free]))
    assert caught.value.pose == 0
    with pytest.raises(NoWay) as caught:
        route(arm, cell, np.array([*free, [0.0, 0.0]]))
    assert caught.value.pose == 4


def test_what_stands_between_two_poses_is_named(arm) -> None:
    cell = Cell(pedestal=0.0, clearance=0.0, obstacles=(ball("post", 1.4, 0.0),))
    a = np.array([[0.5, 0.0], [0.3, 0.0], [-0.5, 0.0], [-0.6, 0.0]])
    (found,) = jumps(arm, cell, a)
    assert found.row == 1 and found.touching == (("fore", "post"),)
    t = float(found.a[0])  # the pose itself, by the spheres' own distance
    assert np.hypot(1.4 * np.cos(t) - 1.4, 1.4 * np.sin(t)) < 0.2
    assert jumps(arm, cell, a[[0, 1]]) == () == jumps(arm, cell, a[:1])
