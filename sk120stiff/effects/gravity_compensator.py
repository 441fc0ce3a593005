"""A balancer or the arm's own weight beside a joint: stiffness that goes with the posture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import LinearElastic
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_joint, arm_joints, sample_poses


@dataclass(frozen=True)
class GravityCompensator(LinearElastic):
    """The joint's compliance falls by γ cos θ, θ the link's angle from the vertical.

    To first order this is a stiffness K + ΔK cos θ with γ = ΔK/K². A balancer that pulls the link
    upright adds stiffness there (γ > 0); a weight that no URDF states takes some away (γ < 0).
    """

    name: ClassVar[str] = "gravity_compensator"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = (
        "q - q_0 = torque * (1 / K - g * cos(angle of the link from the vertical))"
    )
    says: ClassVar[str] = "A balancer adds stiffness to {where} that goes with the arm's posture."
    axes: ClassVar[str] = "the axis of the joint itself"
    rare: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Drop of the compliance where the link stands upright."""
        unit = "rad/(N*m)"
        size = self.scale**-3
        return (
            ParameterSpec(
                "compliance_drop",
                unit,
                unit,
                plausible=5e-7 * size,
                typical=1e-7 * size,
                meaning="g; positive where the joint is stiffer with its link upright",
            ),
        )

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every actuated joint that turns about a horizontal axis at all poses, and has a link."""
        return tuple(
            joint.name
            for joint in arm_joints(robot)
            if joint.revolute
            and joint.actuated is not None
            and joint.length > 0.1
            and _stays_horizontal(robot, joint.index)
        )

    def patterns(self, load_cases: LoadCases) -> Array:
        """−cos θ, from the height of the link's far end over its near end."""
        robot = load_cases.robot
        joint = arm_joint(robot, self.where)
        origin = robot.screws(load_cases.a, joint.link).position
        end = robot.screws(load_cases.a, joint.link, joint.along).position
        up = -robot.gravity / np.linalg.norm(robot.gravity)
        cosine = (end - origin) @ up / joint.length
        return -cosine[None, :, None, None]


def _stays_horizontal(robot: Robot, index: int) -> bool:
    axes = robot.screws(sample_poses(robot, 8)).axes[:, index]
    return bool(np.abs(axes @ robot.gravity).max() < 1e-9 * np.linalg.norm(robot.gravity))
