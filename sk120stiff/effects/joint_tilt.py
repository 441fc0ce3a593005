"""A bearing tilts about the axes normal to its joint axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.nonlinear import Nonlinear, StraightPart
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint, free_joints


@dataclass(frozen=True)
class JointTilt(StraightPart):
    """Two virtual joints at the bearing, on its moving side: along the link, and across it.

    The bearing of a joint that slides is its carriage.
    """

    name: ClassVar[str] = "joint_tilt"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "tilt = moment / K, about each of two axes"
    says: ClassVar[str] = "The bearing of {where} tilts about the axes normal to its joint axis."
    axes: ClassVar[str] = (
        "axes through the joint, normal to its own: along the link that it carries, and across it"
    )
    yields_under: ClassVar[str] = "{where} carries across its axis"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Tilt stiffness about the link's direction and across it."""
        return (
            compliance(
                "stiffness_along",
                softest=3e5,
                typical=1e7,
                scale=self.scale,
                meaning="against tilting about the direction of the link",
            ),
            compliance(
                "stiffness_across",
                softest=3e5,
                typical=1e7,
                scale=self.scale,
                meaning="against tilting about the axis across link and joint axis",
            ),
        )

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff about one axis as about the other."""
        return ((0, 1),)

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every joint on the way to the tool that a motor drives or a closed loop determines."""
        return free_joints(robot)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """One joint for each tilt axis, at the joint's origin."""
        joint = arm_joint(robot, self.where)
        return tuple(
            VirtualJoint(f"{self.id}.{label}", joint.index, np.eye(4), axis)
            for label, axis in zip(("along", "across"), joint.tilt_axes(), strict=True)
        )


class NonlinearTilt(Nonlinear):
    """The bearing stiffens as more of it carries, or gives way one way only."""

    says: ClassVar[str] = (
        "The bearing of {where} tilts about the axes normal to its joint axis, not in proportion."
    )
    straight: ClassVar[type[StraightPart]] = JointTilt
