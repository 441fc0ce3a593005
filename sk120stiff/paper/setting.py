"""The arm on which the paper's numbers are recomputed: the SK120 with the paper's springs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.model import Model, base_model
from sk120stiff.paper.printed import LOWER, STEP, UPPER
from sk120stiff.robot import Robot, Screws, load_robot
from sk120stiff.stiffness import ConstantCompliance, UnderLoad, spring_matrix, under_load


@dataclass(frozen=True, eq=False)
class Setting:
    """The bundled SK120 and its base model, three springs and a rigid wrist; flange loaded."""

    robot: Robot
    model: Model

    @cached_property
    def springs(self) -> Array:
        """(6,) [N·m/rad], infinite for the wrist."""
        return self.model.joint_stiffness()

    @cached_property
    def arm_springs(self) -> Array:
        """(3,) springs of the joints that yield [N·m/rad]."""
        return self.springs[:3]

    @cached_property
    def K_theta(self) -> Array:
        """(3, 3) joint stiffness [N·m/rad]."""
        return spring_matrix(self.arm_springs)

    def arm(self, joints: Array, frame: str | None = None) -> Screws:
        """Kinematics by the first three joints alone, at (..., 3 or 6) joint readings [rad]."""
        screws = self.robot.screws(straight(joints), frame)
        return replace(screws, first=screws.first[..., :3])

    def under_load(
        self,
        joints: Array,
        force: Array,
        *wanted: str,
        frame: str | None = None,
        point: Array | None = None,
        springs: Array | None = None,
    ) -> UnderLoad:
        """What is wanted at (..., 3 or 6) readings [rad] under forces (..., 3) [N].

        The force acts at a point of a frame, the flange by default; `springs` (3,) replace the
        paper's [N·m/rad].
        """
        values = self.springs if springs is None else np.append(springs, self.springs[3:])
        arm = ConstantCompliance.of_springs(self.robot, values, frame=frame, point=point)
        return under_load(arm, straight(joints), wrench_of(force), wanted)

    def deflection(self, joints: Array, force: Array, **options: Any) -> Array:
        """(..., 3) at exact equilibrium [m]; the arguments are those of `under_load`."""
        exact = "deflection_equilibrium"
        return self.under_load(joints, force, exact, **options).of(exact)


def setting() -> Setting:
    """The bundled SK120 with its bundled base model."""
    robot = load_robot("motoman_sk120")
    return Setting(robot, base_model(robot))


def straight(joints: Array) -> Array:
    """(..., 6) readings for (..., 3 or 6): the wrist is straight where it is not given [rad]."""
    rest = np.zeros((*joints.shape[:-1], 6 - joints.shape[-1]))
    return np.concatenate([joints, rest], axis=-1)


def motion_axes() -> tuple[Array, ...]:
    """Values of joints 1, 2, 3 that section VI steps through, each from its lower limit [rad]."""
    ends = zip(LOWER, UPPER, strict=True)
    return tuple(np.arange(low, high + 1e-9, STEP) for low, high in ends)


def motion_grid() -> Array:
    """(5824, 3) the grid of section VI [rad]."""
    return np.array(list(product(*motion_axes())))


def random_poses(rng: np.random.Generator, count: int) -> Array:
    """(count, 3) readings of the first three joints, evenly over their ranges [rad]."""
    return rng.uniform(LOWER, UPPER, size=(count, 3))


def even_directions(count: int) -> Array:
    """(count, 3) unit vectors spread evenly over the sphere, on a spiral."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + 5.0**0.5) * k
    across = np.sqrt(1.0 - z**2)
    return np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)


def slopes(of: Callable[[Array], Array], step: float) -> Array:
    """(..., 3) slopes along three axes at the origin, by differences of fourth order."""
    found = []
    for unit in step * np.eye(3):
        near, far = of(unit) - of(-unit), of(2.0 * unit) - of(-2.0 * unit)
        found.append((8.0 * near - far) / (12.0 * step))
    return np.stack(found, axis=-1)


def wrench_of(force: ArrayLike) -> Array:
    """(..., 6) wrench of a force (..., 3) [N]."""
    given = np.asarray(force, dtype=float)
    return np.concatenate([given, np.zeros_like(given)], axis=-1)
