"""The frame of a joint sits elsewhere, and turned, against the drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.base import Geometric
from sk120stiff.effects.geometry import length_errors
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint, free_joints


@dataclass(frozen=True)
class JointFrame(Geometric):
    """Six small errors of the fixed transform before a joint.

    Of a whole arm many of them cannot be told apart: along parallel axes only sums show, the first
    joint's are the tracker's frame, the last one's the marker's place.
    """

    name: ClassVar[str] = "joint_frame"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "T_true = T_stated * (shift, turn)"
    says: ClassVar[str] = "The frame of {where} sits elsewhere than the URDF states."
    axes: ClassVar[str] = "axes of the joint's frame in the URDF"
    needs: ClassVar[str] = "positions"
    only_absolute: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Shift along and turn about the three axes of the joint's frame."""
        shift = "true minus stated origin of the joint's frame along its {}"
        turn = "turn of the joint's frame about its {}, true minus stated"
        return (
            *length_errors("{}", typical=3e-4, scale=self.scale, meaning=shift),
            *of_axes("r{}", "rad", plausible=0.05, typical=3e-4, meaning=turn),
        )

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every joint on the way to the tool that moves."""
        return free_joints(robot)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three rigid slides and three rigid turns where the joint's frame is."""
        index = arm_joint(robot, self.where).index
        placement = robot.mechanism().chain.placements[index]
        return tuple(
            VirtualJoint(f"{self.id}.{spec.name}", index - 1, placement, axis, revolute=k > 2)
            for k, (spec, axis) in enumerate(
                zip(self.parameters, np.tile(np.eye(3), (2, 1)), strict=True)
            )
        )
