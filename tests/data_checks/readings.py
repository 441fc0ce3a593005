"""Sound readings of two arms, and the slips of the pen that spoil them."""

from __future__ import annotations

import sysconfig
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.robot import Robot
from tests.explain.readings import hidden
from tests.hidden.generator.causes_elastic import BaseRocking

PUBLIC = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
UR5 = PUBLIC / "ur_description/urdf/ur5_robot.urdf"
NOISE = 5e-6  # m


@dataclass(frozen=True)
class Arm:
    """Readings with a missing effect in them, and the model that they are held against."""

    model: Model
    readings: Measurements

    @property
    def robot(self) -> Robot:
        return self.model.robot


@cache
def sk120() -> Arm:
    """The bundled arm; its foundation rocks, which the model does not know."""
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return Arm(model, hidden(BaseRocking("base_link", {"x": 3e-8, "y": 5e-8}), poses=12, loads=4))


@cache
def ur5() -> Arm:
    """An arm that is not bundled; the bearing of its second joint tilts."""
    robot = load_robot(str(UR5), base="base_link", tool="tool0")
    rng = np.random.default_rng(5)
    poses, loads = 14, 4
    q = np.repeat(rng.uniform(-1.6, 1.6, (poses, 6)), loads, axis=0)
    force = rng.normal(size=(poses * loads, 3))
    force *= rng.uniform(20.0, 60.0, (len(q), 1)) / np.linalg.norm(force, axis=1, keepdims=True)
    wrench = np.hstack([force, np.zeros_like(force)])
    point = np.array([0.03, -0.05, 0.12])
    springs = [2.0e4, 2.2e4, 1.6e4, 4.0e3, 4.5e3, 3.5e3]
    arm = joint_spring_model(robot, springs) + effect(robot, "joint_tilt", robot.actuated[1])
    values = arm.values.copy()
    values[-2:] = 6e-6, 3e-6
    moved = arm.with_values(values).deflect(q, wrench, point=point)
    error = rng.normal(0.0, NOISE, moved.shape)
    readings = Measurements(
        pose=tuple(str(k // loads) for k in range(len(q))),
        joint_names=robot.actuated,
        joints=q,
        wrench=wrench,
        displacement=moved + error,
        robot=str(UR5),
        base_frame="base_link",
        tool_frame="tool0",
        point=point,
        zero="separate",
        noise=NoiseStatement(sigma=NOISE / np.sqrt(2.0)),
    )
    return Arm(joint_spring_model(robot), readings)


ARMS: dict[str, Callable[[], Arm]] = {"sk120": sk120, "ur5": ur5}


# Factor by which the arm seems to yield more, and the likeliest slip behind it.
SCALES = (
    (4.448, "forces in lbf labelled N"),
    (9.807, "forces in kgf labelled N"),
    (1 / 4.448, "forces in N labelled lbf"),
    (25.4, "displacements in mm labelled inch"),
    (0.1, "displacements in cm labelled mm"),
    (1 / 25.4, "displacements in inch labelled mm"),
)


def loads_as_if(data: Measurements, factor: float) -> Measurements:
    """All springs together, the loads and the readings are one number: the loads are changed."""
    return replace(data, wrench=data.wrench / factor)


def joints_times(data: Measurements, k: int, factor: float) -> Measurements:
    by = np.ones(data.joints.shape[1])
    by[k] = factor
    return replace(data, joints=data.joints * by)


def exchanged(data: Measurements, i: int, j: int) -> Measurements:
    order = np.arange(data.joints.shape[1])
    order[[i, j]] = order[[j, i]]
    return replace(data, joints=data.joints[:, order])


def in_tool_axes(arm: Arm, values: np.ndarray) -> np.ndarray:
    """Vectors (N, 3) of base axes as a sensor on the tool states them."""
    rotation = arm.robot.screws(arm.readings.joints).rotation
    return np.einsum("nji,nj->ni", rotation, values)


def spoilt(arm: Arm, slip: str) -> Measurements:
    """The readings with one slip; those behind a comma are numbers of columns."""
    data, (kind, *numbers) = arm.readings, slip.split(",")
    which = [int(number) for number in numbers]
    assert data.displacement is not None
    count = np.arange(data.n_readings)
    match kind:
        case "sign":
            return joints_times(data, which[0], -1.0)
        case "exchanged":
            return exchanged(data, *which)
        case "degrees labelled rad":
            factor = 180.0 / np.pi
            return (
                joints_times(data, which[0], factor)
                if which
                else replace(data, joints=data.joints * factor)
            )
        case "radians labelled deg":
            by = np.ones(data.joints.shape[1])
            by[which or slice(None)] = np.pi / 180.0
            return replace(data, joints=data.joints * by)
        case "force of the tool":
            force = in_tool_axes(arm, data.wrench[:, :3])
            return replace(data, wrench=np.hstack([force, data.wrench[:, 3:]]))
        case "displacement of the tool":
            return replace(data, displacement=in_tool_axes(arm, data.displacement))
        case "both of the tool":
            half = Arm(arm.model, spoilt(arm, "force of the tool"))
            return spoilt(half, "displacement of the tool")
        case "unit of one axis":
            by = np.ones(3)
            by[which[0]] = 1e3
            return replace(data, displacement=data.displacement * by)
        case "readings shifted":
            return replace(data, displacement=np.roll(data.displacement, which[0], axis=0))
        case "loads shifted":
            return replace(data, wrench=np.roll(data.wrench, which[0], axis=0))
        case "readings reversed":
            return replace(data, displacement=data.displacement[::-1])
        case "shuffled":
            order = np.random.default_rng(1).permutation(count)
            return replace(data, displacement=data.displacement[order])
        case "random":
            size = data.displacement.std()
            drawn = np.random.default_rng(2).normal(0.0, size, data.displacement.shape)
            return replace(data, displacement=drawn)
        case "floor":
            joints = data.joints.copy()
            joints[:, 2] -= joints[:, 1]
            return replace(data, joints=joints)
        case "floor and wrist":
            joints = spoilt(arm, "floor").joints * [1.0, 1.0, -1.0, -1.0, -1.0, -1.0]
            return replace(data, joints=joints)
    raise ValueError(slip)
