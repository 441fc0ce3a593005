"""Links as elastic beams: bending and torsion between one joint and the next.

A beam cut at s turns there by M(s) ds / EI(s). The displacement it causes at the point is
∫ j(s) j(s)ᵀ W ds / EI(s). With 1/EI(s) = ρ(s)/EI, ρ of mean one, the integrand is ρ times a
polynomial of second degree in s, for which three stations suffice whatever ρ is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import AxisByAxis, LinearElastic, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import ArmJoint, arm_joint, arm_links, last_link, passed_on
from sk120stiff.robot.rotations import homogeneous

TAPER = 0.3  # links get slimmer towards the wrist: share of its depth that a section loses
TAPERS = (-0.5, 0.0, 0.3, 0.6)  # that are tried; below zero: stouter towards the far end
FINER = (-0.5, -0.25, 0.0, 0.15, 0.3, 0.45, 0.6, 0.75)  # once the readings show the beam
STATIONS = 0.5 + np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.15)  # Gauss and Legendre's, from 0 to 1
SHAFT = np.deg2rad(15.0)  # largest angle between a link and the axis of the shaft that it is
BRACKET = np.deg2rad(45.0)  # the same where the link's near end may be a stiff bracket
PLANES = ("in_plane", "out_of_plane")
NAME = re.compile(r"EI(_in_plane|_out_of_plane)?(_roll_axis)?(?:_taper_(minus_)?(\d+))?")


@cache
def shares(taper: float) -> Array:
    """(3,) weights of `STATIONS` along a beam, which add up to one; not to be written to.

    The flexibility ρ(s) goes with (1 − taper · s)⁻³, the cube of the section's depth. The weights
    have its moments up to the second.
    """
    nodes, weights = np.polynomial.legendre.leggauss(24)
    s = 0.5 * (nodes + 1.0)
    rho = weights * (1.0 - taper * s) ** -3
    moments = np.vander(s, 3, increasing=True).T @ (rho / rho.sum())
    found = np.linalg.solve(np.vander(STATIONS, 3, increasing=True).T, moments)
    found.setflags(write=False)  # every caller is given the same
    return np.asarray(found)


@dataclass(frozen=True, eq=False)
class Member:
    """The straight piece of a link that bends, in the frame of the joint that moves the link.

    `start` (3,) and `span` (3,) [m]; `in_plane` and `across` (3,) unit axes about which it bends.
    """

    start: Array
    span: Array
    in_plane: Array
    across: Array


@dataclass(frozen=True)
class LinkBending(LinearElastic):
    """A beam along the link, equally stiff in both planes, slimmer at its far end.

    EI is that of the uniform beam whose end a moment would turn as far. Other laws taper otherwise,
    lie along the roll axis that the link carries (what is off that axis is a stiff bracket), or
    have an EI for each plane.

    Attributes:
        taper: Share of its depth that the section loses along the link.
        roll: The beam lies along the axis of the next joint.
        planes: Each plane has an EI of its own.
    """

    taper: float = TAPER
    roll: bool = False
    planes: bool = False
    name: ClassVar[str] = "link_bending"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "curvature(s) = M(s) / EI(s), slimmer at the far end"
    says: ClassVar[str] = "The link {where} bends along its length."
    axes: ClassVar[str] = "the line from the link's joint to the next; both planes that hold it"
    also: ClassVar[str] = (
        "EI_taper_60: its section loses 60 % of its depth towards the far end (EI alone: 30 %; "
        "EI_taper_minus_50 gains 50 %); EI_roll_axis: the beam lies along the axis of the next "
        "joint; EI_in_plane and EI_out_of_plane: one for each plane; ends add up in the order "
        "EI_in_plane_roll_axis_taper_60"
    )
    inexact: ClassVar[float] = 0.14  # links taper more or less
    yields_under: ClassVar[str] = "bends {where}"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Self:
        """The beam of one link, by the law that names of parameters tell."""
        found = [match for name in options.shape if (match := NAME.fullmatch(name))]
        if not found:
            return cls(where, scale_of(robot))
        plane, roll, minus, percent = found[0].groups()
        taper = TAPER if percent is None else int(percent) / (-100.0 if minus else 100.0)
        return cls(where, scale_of(robot), taper, roll is not None, plane is not None)

    def special_case_of(self, robot: Robot) -> str | None:
        """What bends behind the last joint is the flange and what is bolted to it."""
        behind = self.where == last_link(robot)
        return f"tool_compliance:{robot.tool_frame}" if behind else None

    @property
    def _law(self) -> str:
        """End of the parameters' names."""
        sign = "minus_" if self.taper < 0.0 else ""
        taper = "" if self.taper == TAPER else f"_taper_{sign}{round(abs(100.0 * self.taper))}"
        return self._line + taper

    @property
    def _line(self) -> str:
        """Where the beam lies, in the parameters' names."""
        return "_roll_axis" if self.roll else ""

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Bending stiffness EI, or one for each plane."""
        along = ", along the axis of the next joint" if self.roll else ""
        return tuple(
            compliance(
                f"EI{plane}{self._law}",
                softest=3e5,
                typical=7e6,
                scale=self.scale,
                unit="N*m**2",
                meaning="bending stiffness of the uniform beam whose end a moment turns as far"
                + along
                + (f", {plane[1:].replace('_', ' ')} in which the joint turns" if plane else ""),
                quantity=f"EI{plane}{self._line}",  # whatever the taper
            )
            for plane in ([f"_{each}" for each in PLANES] if self.planes else [""])
        )

    def free_form(self) -> LinkBending:
        """Each plane has an EI of its own."""
        return replace(self, planes=True)

    def other_laws(self, load_cases: LoadCases) -> tuple[LinkBending, ...]:
        """Other tapers, a beam along the roll axis where there is one, planes that differ."""
        along = [False, True] if _roll_member(load_cases.robot, self.where) else [False]
        laws = [
            replace(self, taper=taper, roll=roll, planes=planes)
            for planes in (False, True)
            for roll in along
            for taper in TAPERS
        ]
        return tuple(law for law in laws if law != self)

    def nearby_laws(self, load_cases: LoadCases) -> tuple[LinkBending, ...]:
        """The tapers next to this one."""
        if self.taper not in FINER:
            return ()
        place = FINER.index(self.taper)
        near = set(FINER[max(place - 1, 0) : place + 2]) - {*TAPERS, self.taper}
        return tuple(replace(self, taper=taper) for taper in sorted(near))

    def _member(self, robot: Robot) -> Member:
        found = _roll_member(robot, self.where) if self.roll else None
        if found is not None:
            return found
        link = arm_joint(robot, self.where)
        _, across, third = link.directions
        if passed_on(robot, link):
            across, third = _split(link)
        return Member(np.zeros(3), link.along, third, across)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Two joints across the beam at each station.

        A bend about the joint axis is passed on to joints that a linkage ties to the link.
        """
        link, member = arm_joint(robot, self.where), self._member(robot)
        tied = passed_on(robot, link)
        line = ".roll_axis" if self.roll else ""
        return tuple(
            VirtualJoint(
                f"{self.id}{line}[{k}].{label}",
                link.index,
                homogeneous(member.start + place * member.span),
                axis,
                followers=tied if tied and label == "in_plane" else (),
            )
            for k, place in enumerate(STATIONS)
            for label, axis in zip(PLANES, (member.in_plane, member.across), strict=True)
        )

    def patterns(self, load_cases: LoadCases) -> Array:
        """Every station of the beam yields by its share of the flexibility."""
        length = float(np.linalg.norm(self._member(load_cases.robot).span))
        both = length * np.repeat(shares(self.taper), 2)
        if not self.planes:
            return np.diag(both)[None]
        own = np.tile(np.eye(2), len(STATIONS))  # (2, 6) which plane a joint bends in
        return np.stack([np.diag(both * plane) for plane in own])


@dataclass(frozen=True)
class LinkTorsion(AxisByAxis):
    """A shaft of torsional stiffness GJ along the link."""

    name: ClassVar[str] = "link_torsion"
    place: ClassVar[str] = "a link"
    equation: ClassVar[str] = "twist = moment * length / GJ"
    says: ClassVar[str] = "The link {where} twists along its length."
    axes: ClassVar[str] = (
        "the line of the link, or the next joint's axis where the link is its shaft"
    )
    yields_under: ClassVar[str] = "twists {where}"

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
        axis, placement = link.directions[0], np.eye(4)
        roll = _rolling_axis(robot, link, SHAFT)
        if roll is not None:
            axis, placement[:3, 3] = roll, link.along
        return (VirtualJoint(f"{self.id}.twist", link.index, placement, axis),)

    def patterns(self, load_cases: LoadCases) -> Array:
        """Twist of the whole length."""
        return np.full((1, 1, 1), arm_joint(load_cases.robot, self.where).length)


def _rolling_axis(robot: Robot, link: ArmJoint, most: float) -> Array | None:
    """(3,) axis of the next joint in the link's frame where it follows the link within an angle."""
    chain = robot.mechanism().chain
    if link.index + 1 >= chain.m or not chain.revolute[link.index + 1]:
        return None
    axis = chain.placements[link.index + 1][:3, :3] @ chain.axes[link.index + 1]
    cosine = float(axis @ link.along) / link.length
    return axis * np.sign(cosine) if abs(cosine) > np.cos(most) else None


def _roll_member(robot: Robot, where: str) -> Member | None:
    """The beam along the axis of the next joint; None where there is none, or it is the link's."""
    link = arm_joint(robot, where)
    axis = None if passed_on(robot, link) else _rolling_axis(robot, link, BRACKET)
    if axis is None or np.linalg.norm(np.cross(axis, link.along)) < 1e-6 * link.length:
        return None
    span = axis * (axis @ link.along)
    across = np.cross(link.axis, axis)
    if np.linalg.norm(across) < 1e-6:
        across = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    across = across / np.linalg.norm(across)
    return Member(link.along - span, span, np.cross(axis, across), across)


def _split(link: ArmJoint) -> tuple[Array, Array]:
    """Bending axes of a link in a planar linkage: out of the plane, and the joint axis itself."""
    along = link.along / link.length
    in_plane = link.axis - along * (along @ link.axis)
    in_plane = in_plane / np.linalg.norm(in_plane)
    return np.cross(in_plane, along), in_plane
