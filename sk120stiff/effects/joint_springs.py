"""Torsional springs of the actuated joints: the base model of the 2005 paper, eq. (5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from sk120stiff.effects.base import AxisByAxis, scale_of
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.robot import Robot

MEANING = "torque per angle (force per way) by which the drive yields; larger is stiffer"


@dataclass(frozen=True)
class JointSprings(AxisByAxis):
    """θ − θ₀ = τ / K: gear, bearing and servo of one motor as one spring.

    For a joint that slides, K is in N/m.
    """

    slides: bool = False
    name: ClassVar[str] = "joint_springs"
    joint_spring: ClassVar[bool] = True
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "q - q_0 = torque / K"
    says: ClassVar[str] = "The drive of {where} yields under the torque it carries."
    axes: ClassVar[str] = "the axis of the joint itself"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """The spring's stiffness."""
        unit, softest, typical = ("N/m", 1e4, 1e7) if self.slides else ("N*m/rad", 1e3, 1e6)
        return (
            compliance(
                "stiffness", softest=softest, typical=typical, scale=self.scale, unit=unit,
                meaning=MEANING,
            ),
        )  # fmt: skip

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The spring of one joint, in N·m/rad or N/m as the joint asks for."""
        slides = robot.prismatic[robot.actuated.index(where)]
        return cls(where, scale_of(robot), slides=slides)
