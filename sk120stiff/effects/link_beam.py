"""Links as elastic beams: bending and torsion between one joint and the next.

A uniform beam cut at s turns there by M(s)/(EI) ds. The displacement it causes at the point is
∫ j(s) j(s)ᵀ W ds / (EI); the integrand is of second degree in s, so two Gauss points are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.effects.base import LinearElastic, ParameterSpec, compliance
from sk120stiff.effects.situation import Situation
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import ArmJoint, arm_joint, arm_links, passed_on
from sk120stiff.robot.coupling import Array

GAUSS_POINTS = tuple(0.5 + sign / np.sqrt(12.0) for sign in (-1.0, 1.0))


@dataclass(frozen=True)
class LinkBending(LinearElastic):
    """A beam of equal bending stiffness EI in both planes along the link."""

    name: ClassVar[str] = "link_bending"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Bending stiffness EI."""
        return (compliance("EI", softest=3e5, typical=7e6, unit="N*m**2"),)

    def sentence(self) -> str:
        """What happens."""
        return f"The link {self.where} bends along its length."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every link with a length."""
        return tuple(joint.link for joint in arm_links(robot))

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Two joints across the beam at each Gauss point.

        A bend about the joint axis is passed on to joints that a linkage ties to the link.
        """
        link = arm_joint(robot, self.where)
        _, across, third = link.directions()
        tied = passed_on(robot, link)
        if tied:
            across, third = _split(link)
        return tuple(
            VirtualJoint(
                f"{self.id}[{k}].{label}",
                link.index,
                _moved(fraction * link.along),
                axis,
                followers=tied if tied and label == "in_plane" else (),
            )
            for k, fraction in enumerate(GAUSS_POINTS)
            for label, axis in (("in_plane", third), ("out_of_plane", across))
        )

    def patterns(self, situation: Situation) -> Array:
        """Every slice of the beam yields by its share of the length."""
        length = arm_joint(situation.robot, self.where).length
        return 0.5 * length * np.eye(2 * len(GAUSS_POINTS))[None]


@dataclass(frozen=True)
class LinkTorsion(LinearElastic):
    """A shaft of torsional stiffness GJ along the link."""

    name: ClassVar[str] = "link_torsion"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Torsional stiffness GJ."""
        return (compliance("GJ", softest=2e5, typical=4e6, unit="N*m**2"),)

    def sentence(self) -> str:
        """What happens."""
        return f"The link {self.where} twists along its length."

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every link with a length that is not its own joint's axis."""
        return tuple(
            joint.link
            for joint in arm_links(robot)
            if not joint.revolute
            or np.linalg.norm(np.cross(joint.axis, joint.along)) > 1e-9 * joint.length
        )

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """One joint about the link's direction: where along the link makes no difference."""
        link = arm_joint(robot, self.where)
        return (VirtualJoint(f"{self.id}.twist", link.index, np.eye(4), link.directions()[0]),)

    def patterns(self, situation: Situation) -> Array:
        """Twist of the whole length."""
        return np.full((1, 1, 1), arm_joint(situation.robot, self.where).length)


def _split(link: ArmJoint) -> tuple[Array, Array]:
    """Bending axes of a link in a planar linkage: out of the plane, and the joint axis itself."""
    along = link.along / link.length
    in_plane = link.axis - along * (along @ link.axis)
    in_plane = in_plane / np.linalg.norm(in_plane)
    return np.cross(in_plane, along), in_plane


def _moved(offset: Array) -> Array:
    placement = np.eye(4)
    placement[:3, 3] = offset
    return placement
