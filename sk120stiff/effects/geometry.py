"""The rigid geometry is wrong. It shows in deflections through the Jacobian only: hardly ever."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from sk120stiff.effects.base import Geometric, scale_of
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, of_axes
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint
from sk120stiff.robot.rotations import homogeneous

STANDS = "true minus reported coordinate; positive: the joint stands further than it reads"


def length_error(name: str, *, typical: float, scale: float, meaning: str) -> ParameterSpec:
    """An error of a length [m]; `typical` on an arm of the reference length."""
    return ParameterSpec(
        name, "m", "m", plausible=0.02 * scale, typical=typical * scale, meaning=meaning
    )


def length_errors(
    name: str, *, typical: float, scale: float, meaning: str
) -> tuple[ParameterSpec, ...]:
    """The same along three axes, ``{}`` in name and meaning."""
    size = {"plausible": 0.02 * scale, "typical": typical * scale}
    return of_axes(name, "m", meaning=meaning, **size)


def tool_slides(robot: Robot, name: str) -> tuple[VirtualJoint, ...]:
    """Three slides along the axes of the tool frame, at its origin."""
    chain = robot.mechanism().chain
    last, place = chain.m - 1, chain.placements[-1]
    return tuple(
        VirtualJoint(f"{name}.{label}", last, place, axis, revolute=False)
        for label, axis in zip("xyz", np.eye(3), strict=True)
    )


def link_slide(robot: Robot, link: str, name: str) -> VirtualJoint:
    """A slide along a link, at its far end."""
    joint = arm_joint(robot, link)
    end = homogeneous(joint.along)
    return VirtualJoint(name, joint.index, end, joint.directions[0], revolute=False)


@dataclass(frozen=True)
class JointOffset(Geometric):
    """The joint stands elsewhere than it reads."""

    slides: bool = False
    name: ClassVar[str] = "joint_offset"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "q_true = q_reported + o"
    says: ClassVar[str] = "The zero of {where} is off."
    axes: ClassVar[str] = "the axis of the joint itself"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """True coordinate minus reading."""
        if self.slides:
            return (length_error("offset", typical=1e-3, scale=self.scale, meaning=STANDS),)
        return (
            ParameterSpec("offset", "rad", "rad", plausible=0.05, typical=1e-3, meaning=STANDS),
        )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The offset of one joint, in rad or m as the joint asks for."""
        slides = robot.prismatic[robot.actuated.index(where)]
        return cls(where, scale_of(robot), slides=slides)


@dataclass(frozen=True)
class ToolOffset(Geometric):
    """The measured point (and the force with it) sits elsewhere in the tool frame."""

    name: ClassVar[str] = "tool_offset"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "p_true = p_stated + o"
    says: ClassVar[str] = "The measured point sits elsewhere on the tool than stated."
    axes: ClassVar[str] = "axes of the tool frame"
    of_marker: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """True position minus stated position of the point, tool axes."""
        meaning = "true minus stated place along {} of the tool frame"
        return length_errors("offset_{}", typical=2e-3, scale=self.scale, meaning=meaning)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three rigid slides at the tool frame."""
        return tool_slides(robot, self.id)


@dataclass(frozen=True)
class LinkLength(Geometric):
    """A link is longer or shorter than stated."""

    name: ClassVar[str] = "link_length"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "length_true = length_stated + o"
    says: ClassVar[str] = "The link {where} has another length than stated."
    axes: ClassVar[str] = "the line from the link's joint to the next"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """True length minus stated length."""
        meaning = "true minus stated length"
        return (length_error("offset", typical=2e-3, scale=self.scale, meaning=meaning),)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """A rigid slide along the link, at its far end."""
        return (link_slide(robot, self.where, f"{self.id}.length"),)
