"""Sound readings of a random arm: poses, loads, springs, noise, and a missing effect or none."""

from __future__ import annotations

import numpy as np

from sk120stiff.data_checks.scale import WRIST, usual_stiffness
from sk120stiff.effects import all_effects, load_case
from sk120stiff.effects.base import Elastic
from sk120stiff.errors import Refusal
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_length
from tests.data_checks.readings import Arm

SHARE = (0.1, 0.6)  # size of the missing effect over that of the springs' displacements
SIGNAL = (30.0, 300.0)  # displacements over noise
WITHIN = 0.8  # of the joint limits that poses keep to


def random_arm(
    robot: Robot, seed: int, *, poses: int = 16, loads: int = 4, effect: bool = True
) -> Arm:
    """Readings of an arm with springs that are usual for its size; σ is stated every other time."""
    rng = np.random.default_rng(seed)
    q = np.repeat(_poses(robot, rng, poses), loads, axis=0)
    softest, stiffest = usual_stiffness(arm_length(robot))
    middle = np.sqrt(softest * stiffest)
    springs = np.where(np.arange(robot.n) < 3, middle, WRIST * middle)
    springs = springs * np.exp(rng.uniform(-0.7, 0.7, robot.n))
    lever = arm_length(robot)
    push = 2e-3 * middle / lever  # about 2 mrad at a base joint
    way = rng.normal(size=(len(q), 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    force = way * push * rng.uniform(0.2, 1.0, (len(q), 1))
    wrench = np.hstack([force, np.zeros_like(force)])
    point = rng.uniform(-0.1, 0.1, 3) * lever
    arm = joint_spring_model(robot, springs)
    moved = arm.deflect(q, wrench, point=point)
    if effect:
        moved = _with_something_missing(arm, q, wrench, point, moved, rng)
    sigma = float(np.sqrt(np.mean(moved**2))) / rng.uniform(*SIGNAL)
    error = rng.normal(0.0, np.sqrt(2.0) * sigma, moved.shape)
    readings = Measurements(
        pose=tuple(str(k // loads) for k in range(len(q))),
        joint_names=robot.actuated,
        joint_kinds=tuple("length" if slides else "angle" for slides in robot.prismatic),
        joints=q,
        wrench=wrench,
        displacement=moved + error,
        point=point,
        zero="separate",
        noise=NoiseStatement(sigma=sigma if seed % 2 else None),
    )
    return Arm(joint_spring_model(robot), readings)


def _poses(robot: Robot, rng: np.random.Generator, count: int) -> np.ndarray:
    middle = np.where(np.isfinite(robot.lower + robot.upper), 0.5 * (robot.lower + robot.upper), 0)
    low = np.maximum(middle + WITHIN * (robot.lower - middle), -2.5)
    high = np.minimum(middle + WITHIN * (robot.upper - middle), 2.5)
    return rng.uniform(low, high, (count, robot.n))


def _with_something_missing(
    arm: Model,
    q: np.ndarray,
    wrench: np.ndarray,
    point: np.ndarray,
    moved: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """The displacements with an elastic effect of random kind, place and size."""
    names = {"joint_springs", "gravity_compensator"}
    load_cases = load_case(arm.robot, q, wrench, point=point)
    offered = [
        e
        for e in all_effects(arm.robot)
        if isinstance(e, Elastic) and e.name not in names and e.applies_to(load_cases)
    ]
    for _ in range(20):
        chosen = offered[rng.integers(len(offered))]
        values = np.zeros(len(arm.values) + len(chosen.parameters))
        values[: len(arm.values)] = arm.values
        typical = np.array([spec.typical for spec in chosen.parameters])
        values[len(arm.values) :] = typical * rng.uniform(0.2, 1.0, len(typical))
        more = arm + chosen
        wished = rng.uniform(*SHARE)
        try:
            for _ in range(3):
                found = more.predict(load_cases, values)
                share = np.linalg.norm(found - moved) / np.linalg.norm(moved)
                if share == 0.0:
                    break
                values[len(arm.values) :] *= wished / share
            found = more.predict(load_cases, values)
        except Refusal:
            continue
        if np.linalg.norm(found - moved) > 0.05 * np.linalg.norm(moved):
            return found
    return moved
