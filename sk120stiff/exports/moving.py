"""A modelled arm as simulators see it: bodies, joints, servos and springs, ready to be driven.

Every actuated joint is two in series: the motor's, which a position servo of stiffness K_m holds at
the command, and behind it the gear's, a spring K_g. Both yield under the same torque, so

    C = 1 / K_m + 1 / K_g

is the model's compliance of that joint, exactly, whatever the command is. Servos are `SERVO` times
as stiff as the joint, or `RIGID` where the model lets it not yield: the split is ours, its sum is
the model's. Other compliances (tilt, base, tool, beams) are springs of joints of their own. A joint
that follows others is a row of joints, each of which follows one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.robot.visuals import Visual

SERVO = 100.0  # stiffness of a servo over that of the joint that it drives
RIGID = 1e11  # N·m/rad or N/m: servo of a joint that the model lets not yield
PACE = 500.0  # rad/s: no spring oscillates faster with the armature that it is given
REST = 0.01  # s in which a spring comes to rest


@dataclass(frozen=True, eq=False)
class Joint:
    """One degree of freedom.

    Attributes:
        name: The URDF's for a motor and for what follows; ``JOINT.spring`` for a gear.
        axis: (3,) unit axis in the joint frame.
        slides: Translation along the axis rather than rotation about it.
        servo: Stiffness of the position servo; zero: no motor drives it [N·m/rad or N/m].
        stiffness: Of its own spring, relaxed at zero; zero: none [N·m/rad or N/m].
        stiffest: What to bound its pace by: springs that it shares with others count too.
        leader: What it follows, as (joint, factor, offset); None: nothing.
        value: At the pose at which the model begins, without load [rad or m].
        limits: (2,) of the command; infinite where unknown [rad or m].
    """

    name: str
    axis: Array
    slides: bool
    servo: float = 0.0
    stiffness: float = 0.0
    stiffest: float = 0.0
    leader: tuple[str, float, float] | None = None
    value: float = 0.0
    limits: tuple[float, float] = (-np.inf, np.inf)

    @property
    def armature(self) -> float:
        """Inertia of the joint itself, that bounds its pace [kg·m² or kg]."""
        return max(self.servo, self.stiffest, self.stiffness) / PACE**2

    @property
    def damping(self) -> float:
        """Of its spring, or of the servo, critical [N·m·s/rad or N·s/m]."""
        if self.servo:
            return 2.0 * self.servo / PACE
        return REST * max(self.stiffest, self.stiffness)


@dataclass(frozen=True, eq=False)
class Body:
    """One body; the first is the ground, in axes of the base frame, and has no joint.

    Attributes:
        name: The URDF link that it is, or a name of its own.
        parent: Index of the body that carries it; -1 for the ground.
        placement: (4, 4) joint frame in the parent's frame, all joints at zero [m].
        mass, centre, inertia: [kg], (3,) [m], and (3, 3) about the centre [kg·m²]; zero mass where
            the model knows none.
    """

    name: str
    parent: int
    placement: Array
    joint: Joint | None
    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class Tied:
    """A spring of a weighted sum of joint values, relaxed at zero [N·m/rad or N/m]."""

    weights: Mapping[str, float]
    stiffness: float


@dataclass(frozen=True, eq=False)
class MovingArm:
    """A whole robot that can be driven.

    Attributes:
        name, actuated: Of the robot, and its actuated joints in their order.
        bodies: Carriers before what they carry.
        frames: Every other frame: (name, index of its body, (4, 4) placement on it).
        sites: The same for the frames at which loads may act.
        shapes: Index of the body, (4, 4) placement on it, and the shape.
        springs: Springs between joints.
        gravity: (3,) base axes [m/s²]; zero where the robot states no mass.
        held: Joints that neither a motor nor another joint moves → where they are built in.
    """

    name: str
    actuated: tuple[str, ...]
    bodies: tuple[Body, ...]
    frames: tuple[tuple[str, int, Array], ...]
    sites: tuple[tuple[str, int, Array], ...]
    shapes: tuple[tuple[int, Array, Visual], ...]
    springs: tuple[Tied, ...]
    gravity: Array
    held: Mapping[str, float]

    def __post_init__(self) -> None:
        for k, body in enumerate(self.bodies):
            if (body.joint is None) != (k == 0) or not body.parent < k:
                raise ValueError("bodies stand behind their carriers, and all but the first move")

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All joints, in the order of the bodies."""
        return tuple(body.joint for body in self.bodies if body.joint is not None)

    @property
    def motors(self) -> tuple[Joint, ...]:
        """Joints that servos hold, in the order of the robot's actuated joints."""
        found = {joint.name: joint for joint in self.joints if joint.servo}
        return tuple(found[name] for name in self.actuated)

    @property
    def heavy(self) -> bool:
        """Does anything weigh?"""
        return bool(self.gravity.any())
