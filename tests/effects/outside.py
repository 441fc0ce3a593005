"""Effects as a stranger writes them: one class each, no line of the package changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sk120stiff.effects import CATALOGUE, AxisByAxis, Imposed, LoadCases, ParameterSpec
from sk120stiff.effects.parameter import compliance
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint, arm_links

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkStretch(AxisByAxis):
    """A link gets longer under tension."""

    name: ClassVar[str] = "link_stretch"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "stretch = force / K"
    axes: ClassVar[str] = "the line of the link"
    yields_under: ClassVar[str] = "stretches {where}"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        return (
            compliance(
                "stiffness", softest=1e6, typical=5e7, scale=self.scale, unit="N/m",
                meaning="against stretching along the link",
            ),
        )  # fmt: skip

    def sentence(self) -> str:
        return f"The link {self.where} stretches along its length."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        return tuple(joint.link for joint in arm_links(robot) if joint.revolute)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        link = arm_joint(robot, self.where)
        placement = np.eye(4)
        placement[:3, 3] = link.along
        axis = link.along / link.length
        return (VirtualJoint(f"{self.id}.z", link.index, placement, axis, revolute=False),)


@dataclass(frozen=True)
class JointCreep(Imposed):
    """A joint creeps on with every reading, whatever the load is."""

    name: ClassVar[str] = "joint_creep"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "q - q_0 = r * number of the reading since its zero"
    axes: ClassVar[str] = "the axis of the joint itself"
    needs: ClassVar[str] = "a column order"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        return (
            ParameterSpec(
                "rate", "rad", "rad", plausible=1e-4, typical=1e-6,
                meaning="how far the joint creeps from one reading to the next",
            ),
        )  # fmt: skip

    def sentence(self) -> str:
        return f"The brake of {self.where} creeps from reading to reading."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        slides = dict(zip(robot.actuated, robot.prismatic, strict=True))
        return tuple(name for name in robot.actuated if not slides[name])

    def coordinates(self, robot: Robot) -> tuple[str, ...]:
        return (self.where,)

    def applies_to(self, load_cases: LoadCases) -> bool:
        return load_cases.order is not None

    def shifts(self, load_cases: LoadCases) -> Array:
        steps = np.zeros(load_cases.count) if load_cases.order is None else load_cases.order
        return steps[:, None, None]


EVERYTHING = CATALOGUE + (LinkStretch, JointCreep)
