"""Arms, readings and models that the contract of every effect is tried on."""

from __future__ import annotations

import tempfile
import warnings
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sk120stiff.effects import Effect, LoadCases, all_effects, load_case
from sk120stiff.errors import ToolkitWarning
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.robot import Robot, load_robot
from sk120stiff.robot.anatomy import sample_poses
from tests.effects.outside import EVERYTHING
from tests.oracles.sample_urdfs import six_axis_arm
from tests.robot.loop_arms import four_bar, sk120_loop

Array = NDArray[np.float64]
FOLDER = Path(__file__).resolve().parents[1] / "hidden" / "robots"
POSES = tuple("ABCDEF")


def scara() -> str:
    """Two parallel joints, a lift, a turn of the tool; two links have masses."""

    def joint(name: str, kind: str, parent: str, child: str, xyz: str, low: str, high: str) -> str:
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="0 0 1"/>'
            f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint>'
        )

    def link(name: str, mass: float = 0.0) -> str:
        if not mass:
            return f'<link name="{name}"/>'
        return (
            f'<link name="{name}"><inertial><origin xyz="0.2 0 0"/><mass value="{mass}"/>'
            '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )

    return (
        '<robot name="scara">'
        + link("base") + link("inner", 8.0) + link("outer", 5.0) + link("quill") + link("tool")
        + joint("shoulder", "revolute", "base", "inner", "0 0 0.4", "-2.2", "2.2")
        + joint("elbow", "revolute", "inner", "outer", "0.45 0 0.05", "-2.5", "2.5")
        + joint("lift", "prismatic", "outer", "quill", "0.35 0 -0.1", "-0.3", "0")
        + joint("turn", "revolute", "quill", "tool", "0 0 -0.05", "-3", "3")
        + "</robot>"
    )  # fmt: skip


@cache
def arm(name: str) -> Robot:
    """One of the robots in `ARMS`."""
    if name == "sk120":
        return load_robot("motoman_sk120")
    if name == "six_axis":
        with warnings.catch_warnings(action="ignore", category=ToolkitWarning):
            return load_robot(six_axis_arm(5), base="base", tool="tool")  # axes of any length
    if name in ("loop", "four_bar"):
        with tempfile.TemporaryDirectory() as folder:
            return (sk120_loop if name == "loop" else four_bar)(Path(folder))
    if name == "telescope":
        return load_robot(FOLDER / "telescope.urdf", base="floor", tool="plate")
    return load_robot(scara(), base="base", tool="tool")


ARMS = ("sk120", "six_axis", "telescope", "scara")
LOOPED = ("loop", "four_bar")


def every_effect(robot: Robot) -> tuple[Effect, ...]:
    """All effects at all places, two from outside among them, drift by the clock."""
    return all_effects(robot, poses=POSES, timed=True, catalogue=EVERYTHING)


def some_poses(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    """(count, n) within limits, and no further than a rad or a metre from zero."""
    if robot.closures:
        return sample_poses(robot, count, int(rng.integers(1000)))
    low = np.maximum(robot.lower, -1.0)
    high = np.minimum(robot.upper, 1.0)
    return rng.uniform(low, high, (count, robot.n))


def readings(robot: Robot, count: int = 12, seed: int = 0, moments: bool = True) -> LoadCases:
    """Readings in which every effect has something to say: two per pose, both branches, a clock."""
    rng = np.random.default_rng(seed)
    poses = some_poses(robot, len(POSES), rng)
    index = np.arange(count) % len(POSES)
    size = 400.0 * (robot_length(robot) / 2.87) ** 2
    wrench = size * rng.normal(size=(count, 6)) * [1, 1, 1, 0.2, 0.2, 0.2]
    if not moments:
        wrench[:, 3:] = 0.0
    plain = load_case(
        robot, poses[index], wrench, point=[0.05, -0.12, 0.2], force_point=[0.1, 0.02, 0.15]
    )
    return replace(
        plain,
        reading_axes=plain.rotation,
        order=1.0 + rng.permutation(count),
        time=rng.uniform(5.0, 900.0, count),
        branch=np.where(rng.random(count) < 0.5, -1.0, 1.0),
        pose=index,
        poses=POSES,
    )


def robot_length(robot: Robot) -> float:
    """Distance from base to tool with all joints at zero, which sets the size of the loads [m]."""
    return float(np.linalg.norm(robot.placement(np.zeros(robot.n))[:3, 3])) + 0.2


def sprung(robot: Robot) -> Model:
    """The arm with a spring in every joint, softer ones towards the tool."""
    usual = joint_spring_model(robot)
    return usual.with_values(usual.values * np.linspace(0.8, 2.5, robot.n))


def random_values(model: Model, rng: np.random.Generator, size: float = 1.0) -> Array:
    """(P,) values of usual size, negative ones where physics allows them."""
    values = []
    for parameter in model.parameters:
        spec = parameter.spec
        value = size * spec.typical * rng.uniform(0.3, 1.0)
        values.append(value if spec.lower == 0.0 else value * rng.choice([-1.0, 1.0]))
    return np.array(values)


def with_every_effect(robot: Robot, seed: int = 0) -> Model:
    """Springs and all other effects at once, at values that are not zero."""
    model = sprung(robot)
    for effect in every_effect(robot):
        if effect.name != "joint_springs":
            model = model + effect
    values = random_values(model, np.random.default_rng(seed), 0.5)
    values[: robot.n] = sprung(robot).values
    return model.with_values(values)
