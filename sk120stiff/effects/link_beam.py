"""Links as elastic beams: bending and torsion between one joint and the next.

A beam cut at s turns there by M(s) ds / EI(s). The displacement it causes at the point is
∫ j(s) j(s)ᵀ W ds / EI(s). With 1/EI(s) = ρ(s)/EI, ρ of mean one, the integrand is ρ times a
polynomial of second degree in s, for which the two Gauss points of the weight ρ are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import SPRINGS, Alias, LinearElastic
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.effects.situation import Situation
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import ArmJoint, arm_joint, arm_links, passed_on, sample_poses

TAPER = 0.3  # links get slimmer towards the wrist: share of its depth that a section loses


def gauss_points(taper: float) -> tuple[Array, Array]:
    """Places (2,) along a beam from 0 to 1 and their weights (2,), which add up to one.

    The flexibility ρ(s) goes with (1 − taper · s)⁻³, the cube of the section's depth.
    """
    nodes, weights = np.polynomial.legendre.leggauss(24)
    s = 0.5 * (nodes + 1.0)
    rho = weights * (1.0 - taper * s) ** -3
    rho /= rho.sum()
    mean = rho @ s
    spread = rho @ (s - mean) ** 2
    skewness = rho @ (s - mean) ** 3
    # roots of the orthogonal polynomial (s − mean)² − (skewness / spread)(s − mean) − spread
    half = 0.5 * skewness / spread
    root = np.sqrt(half**2 + spread)
    near, far = half - root, half + root
    return mean + np.array([near, far]), np.array([far, -near]) / (far - near)


SHAFT = np.deg2rad(15.0)  # largest angle between a link and the axis of the shaft that it is


@dataclass(frozen=True)
class LinkBending(LinearElastic):
    """A beam of equal bending stiffness in both planes along the link, slimmer at its far end.

    EI is that of the uniform beam whose end a moment would turn as far.
    """

    name: ClassVar[str] = "link_bending"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "curvature(s) = M(s) / EI(s), slimmer at the far end"
    axes: ClassVar[str] = "the line from the link's joint to the next; both planes that hold it"
    inexact: ClassVar[float] = 0.14  # links taper more or less

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Bending stiffness EI."""
        return (
            compliance(
                "EI",
                softest=3e5,
                typical=7e6,
                scale=self.scale,
                unit="N*m**2",
                meaning="bending stiffness of the uniform beam whose end a moment turns as far",
            ),
        )

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
        places, _ = gauss_points(TAPER)
        return tuple(
            VirtualJoint(
                f"{self.id}[{k}].{label}",
                link.index,
                _moved(fraction * link.along),
                axis,
                followers=tied if tied and label == "in_plane" else (),
            )
            for k, fraction in enumerate(places)
            for label, axis in (("in_plane", third), ("out_of_plane", across))
        )

    def aliases(self, robot: Robot) -> tuple[Alias, ...]:
        """A link of a parallelogram that bends in its plane shifts what the rod holds upright.

        So does the drive of that link: the direction is the same wherever the beam bends.
        """
        joints = self.virtual_joints(robot)
        bends = [robot.n + k for k, joint in enumerate(joints) if joint.name.endswith(".in_plane")]
        z = np.zeros((12, robot.n + len(joints)))
        z[:, : robot.n] = sample_poses(robot, 12)
        twists = robot.mechanism().with_virtual_joints(joints).screws(z).jacobian  # (12, 6, n_z)
        columns = twists.reshape(-1, z.shape[1])
        columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        alike = np.abs(columns[:, bends].T @ columns[:, : robot.n]) > 1.0 - 1e-12
        return tuple(
            Alias(f"{self.id}.EI[in_plane]", f"{SPRINGS}:{robot.actuated[j]}.stiffness")
            for j in np.flatnonzero(alike.all(axis=0))
        )

    def patterns(self, situation: Situation) -> Array:
        """Every slice of the beam yields by its share of the flexibility."""
        length = arm_joint(situation.robot, self.where).length
        _, shares = gauss_points(TAPER)
        return np.diag(length * np.repeat(shares, 2))[None]


@dataclass(frozen=True)
class LinkTorsion(LinearElastic):
    """A shaft of torsional stiffness GJ along the link."""

    name: ClassVar[str] = "link_torsion"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "twist = moment * length / GJ"
    axes: ClassVar[str] = (
        "the line of the link, or the next joint's axis where the link is its shaft"
    )
    one_axis_each: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Torsional stiffness GJ."""
        return (
            compliance(
                "GJ",
                softest=5e4,
                typical=4e6,
                scale=self.scale,
                unit="N*m**2",
                meaning="torsional stiffness over the whole length",
            ),
        )

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
        """One joint about the shaft's axis; where along it makes no difference.

        A forearm is a tube around the joint that rolls the wrist: where the next joint turns about
        an axis that all but follows the link, the shaft is that joint's, and its twist is that
        joint's spring by another name. Any other link twists about its own line.
        """
        link = arm_joint(robot, self.where)
        axis, placement = link.directions()[0], np.eye(4)
        roll = _rolling_axis(robot, link)
        if roll is not None:
            axis, placement[:3, 3] = roll, link.along
        return (VirtualJoint(f"{self.id}.twist", link.index, placement, axis),)

    def patterns(self, situation: Situation) -> Array:
        """Twist of the whole length."""
        return np.full((1, 1, 1), arm_joint(situation.robot, self.where).length)


def _rolling_axis(robot: Robot, link: ArmJoint) -> Array | None:
    """(3,) axis of the next joint in the link's frame where it nearly follows the link."""
    chain = robot.mechanism().chain
    if link.index + 1 >= chain.m or not chain.revolute[link.index + 1]:
        return None
    axis = chain.placements[link.index + 1][:3, :3] @ chain.axes[link.index + 1]
    cosine = float(axis @ link.along) / link.length
    return axis * np.sign(cosine) if abs(cosine) > np.cos(SHAFT) else None


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
