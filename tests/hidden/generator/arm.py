"""What a rigid arm is here: joints in a row, links with mass, perhaps one closed loop."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from .rotations import Array

ROLLS = 0.96  # cosine between a link and the next joint's axis from which that joint rolls it


@dataclass(frozen=True)
class ArmJoint:
    """One joint of the chain. `before` leads from the moving frame of the joint before it."""

    name: str
    before: Array  # (4, 4)
    axis: Array  # (3,) unit vector
    slides: bool
    lower: float
    upper: float
    link: str  # the link that it moves


@dataclass(frozen=True)
class Body:
    """A point mass rigidly joined to the moving frame of joint number `joint`."""

    joint: int
    centre: Array  # (3,) [m]
    mass: float  # [kg]


@dataclass(frozen=True)
class Loop:
    """Crank, rod and rear lever: they turn the passive joint `follower` of the chain.

    The crank turns about the axis of the joint `pivot` but in the frame that carries that joint.
    """

    follower: int  # index of the passive joint
    pivot: int  # index of the joint whose origin the crank shares
    driver: str  # name of the actuated coordinate that turns the crank
    crank_axis: Array  # (3,)
    crank: Array  # (3,) pivot to pin at crank angle zero [m]
    lever: Array  # (3,) passive joint to its rear pin, in the passive joint's moving frame [m]
    rod: float  # [m]


@dataclass(frozen=True)
class Typical:
    """Sizes that are usual for such an arm (SI); draws scatter around them."""

    joint: Mapping[str, float]  # stiffness of the springs of the base model
    wrist: Mapping[str, float] = field(default_factory=dict)  # held rigid by the base model
    tilt: float = 1.0e7
    rocking: float = 1.0e7
    sliding: float = 7.0e7
    bending: float = 7.0e6  # EI [N m^2]
    torsion: float = 5.0e6  # GJ [N m^2]
    tool: float = 3.0e5
    tool_sliding: float = 3.0e7
    force: float = 490.0  # largest load [N]
    lost_motion: float = 150e-6  # [rad]
    friction: float = 60e-6  # [rad]


@dataclass(frozen=True)
class Arm:
    """A rigid arm.

    `actuated` names the coordinates that a controller reports; with a loop they are not all
    joints of the chain.
    """

    name: str
    reference: str  # what the measurement file calls the robot
    base_frame: str
    tool_frame: str
    joints: tuple[ArmJoint, ...]
    tool: Array  # (4, 4) from the last joint's moving frame
    actuated: tuple[str, ...]
    limits: Mapping[str, tuple[float, float]]
    typical: Typical
    bodies: tuple[Body, ...] = ()
    loop: Loop | None = None
    base_link: str = "base_link"

    def joint_index(self, name: str) -> int:
        """Place in the chain of the joint that `name` turns (the loop's driver: its follower)."""
        if self.loop is not None and name == self.loop.driver:
            return self.loop.follower
        return [joint.name for joint in self.joints].index(name)

    def slides(self, name: str) -> bool:
        """Whether an actuated coordinate is a length."""
        return self.joints[self.joint_index(name)].slides

    def spans(self) -> dict[str, tuple[int, Array]]:
        """Link name -> (joint that moves it, vector from its own joint to the next one [m])."""
        out = {}
        for i, joint in enumerate(self.joints[:-1]):
            out[joint.link] = (i, self.joints[i + 1].before[:3, 3].copy())
        return out

    def shafts(self) -> dict[str, tuple[int, Array, Array]]:
        """Link name -> (joint that moves it, start, vector to the end) of the tube that twists.

        A link that carries a roll joint is a tube around the axis of that joint.
        """
        out = {}
        for name, (i, span) in self.spans().items():
            after, length = self.joints[i + 1], float(np.linalg.norm(span))
            axis = after.before[:3, :3] @ after.axis
            along = float(axis @ span)
            if not after.slides and length > 0.0 and abs(along) > ROLLS * length:
                tube = axis * np.sign(along) * length
                out[name] = (i, span - tube, tube)
            else:
                out[name] = (i, np.zeros(3), span)
        return out

    def long_links(self, least: float = 0.2) -> list[str]:
        """Links long enough to bend noticeably; sliding booms are left out."""
        return [
            name
            for name, (i, span) in self.spans().items()
            if np.linalg.norm(span) >= least and not self.joints[i].slides
        ]

    def with_joint(self, index: int, **changes: object) -> Arm:
        """The same arm with one joint changed."""
        joints = list(self.joints)
        joints[index] = replace(joints[index], **changes)  # type: ignore[arg-type]
        return replace(self, joints=tuple(joints))

    @property
    def has_mass(self) -> bool:
        return any(body.mass > 0.0 for body in self.bodies)
