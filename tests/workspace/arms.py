"""Arms that several tests of the workspace share."""

from functools import cache

import numpy as np

from sk120stiff.model import base_model, joint_spring_model
from sk120stiff.robot import load_robot
from sk120stiff.workspace import Axis, ElasticArm, Grid, JointGrid, MapJob, elastic_arm
from tests.oracles.sample_urdfs import six_axis_arm

LOADS = np.array([[0.0, 0.0, -490.0, 0.0, 0.0, 0.0], [300.0, 200.0, 100.0, 10.0, -20.0, 30.0]])


@cache
def sk120() -> ElasticArm:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return elastic_arm(model)


@cache
def skew_arm() -> ElasticArm:
    robot = load_robot(six_axis_arm(seed=3))
    return elastic_arm(joint_spring_model(robot, np.linspace(3e5, 6e5, 6)))


def joint_job(*counts: int, **options: bool) -> MapJob:
    """A small map of the SK120 over joints 2, 3 and 5."""
    names = ("joint_2_l", "joint_3_u", "joint_5_b")[: len(counts)]
    axes = tuple(
        Axis(name, np.linspace(-1.1, 0.5, n)) for name, n in zip(names, counts, strict=True)
    )
    rest = np.array([0.2, 0.0, 0.0, 0.3, 0.0, 0.1])
    return MapJob(sk120(), JointGrid(Grid(axes), rest), LOADS, **options)
