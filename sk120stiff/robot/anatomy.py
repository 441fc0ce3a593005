"""The arm's parts by the names a user knows, with the place of each in the kinematic chain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.robot.loops.coupling import LoopCoupling
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.rotations import frame_about

_JOINTS: WeakKeyDictionary[Robot, tuple[ArmJoint, ...]] = WeakKeyDictionary()
_SAMPLES: WeakKeyDictionary[Robot, dict[tuple[int, int], Array]] = WeakKeyDictionary()
CLEAR_OF_DEAD_POINTS = 0.02  # see `LoopCoupling.closes`
SHORTEST_LINK = 1e-3  # m; what is shorter has no length to bend along
WHOLE_ARM = 4  # joints that turn: more than a wrist has


@dataclass(frozen=True, eq=False)
class ArmJoint:
    """A joint of the chain from base to tool.

    Attributes:
        name: URDF name.
        link: The URDF link that it moves.
        index: Position in the chain.
        actuated: Position among the actuated joints, or None for a coupled one.
        revolute: Turns rather than slides.
        axis: (3,) its direction in its own frame.
        along: (3,) from its origin to the next joint's origin (the tool's, for the last), own frame
            [m].
        placement: (4, 4) its frame in that of the joint before, or of the base, for the first.
    """

    name: str
    link: str
    index: int
    actuated: int | None
    revolute: bool
    axis: Array
    along: Array
    placement: Array

    @property
    def length(self) -> float:
        """Length of the link it moves [m]."""
        return float(np.linalg.norm(self.along))

    @cached_property
    def directions(self) -> tuple[Array, Array, Array]:
        """Three unit directions in the joint frame: along the link, and two across it.

        The second one is normal to the joint axis wherever the link leaves the axis.
        """
        along = self.along / self.length if self.length > SHORTEST_LINK else self.axis
        across = np.cross(self.axis, along)
        if np.linalg.norm(across) < 1e-6:
            across = frame_about(along)[:, 0]
        across = across / np.linalg.norm(across)
        return along, across, np.cross(along, across)

    def tilt_axes(self) -> tuple[Array, Array]:
        """Two unit directions normal to the joint axis: as far along the link as can be, across."""
        return _normal_to(self.axis, self.along)

    def tilt_axes_on(self, carrier: ArmJoint | None) -> tuple[Array, Array]:
        """The same by the link that carries the joint, in the frame of the joint before.

        On the base (None) that is as far along its x axis as can be, in the base's frame.
        """
        along = np.eye(3)[0] if carrier is None else carrier.along
        return _normal_to(self.placement[:3, :3] @ self.axis, along)


def _normal_to(axis: Array, along: Array) -> tuple[Array, Array]:
    flat = along - axis * (axis @ along)
    if np.linalg.norm(flat) < SHORTEST_LINK:
        flat = np.eye(3)[np.argmin(np.abs(axis))]
        flat = flat - axis * (axis @ flat)
    flat = flat / np.linalg.norm(flat)
    return flat, np.cross(axis, flat)


def arm_joints(robot: Robot) -> tuple[ArmJoint, ...]:
    """Joints from base to tool, coupled ones included; worked out once for a robot."""
    known = _JOINTS.get(robot)
    if known is None:
        known = _JOINTS[robot] = _on_the_way(robot)
    return known


def _on_the_way(robot: Robot) -> tuple[ArmJoint, ...]:
    chain = robot.mechanism().chain
    position = {name: k for k, name in enumerate(robot.actuated)}
    return tuple(
        ArmJoint(
            name=name,
            link=robot.document.by_name[name].child,
            index=k,
            actuated=position.get(name),
            revolute=bool(chain.revolute[k]),
            axis=chain.axes[k],
            along=chain.placements[k + 1][:3, 3],
            placement=chain.placements[k],
        )
        for k, name in enumerate(chain.names)
    )


def arm_length(robot: Robot) -> float:
    """Stretched length of the arm from its first joint to the tool [m], slides at full travel.

    A slide that carries a whole arm is its rail: how far that goes says nothing of the arm.
    """
    joints = arm_joints(robot)
    total = sum(joint.length for joint in joints)
    for k, joint in enumerate(joints):
        if joint.revolute or joint.actuated is None:
            continue
        carries = sum(other.revolute for other in joints[k:])
        travel = np.abs([robot.lower[joint.actuated], robot.upper[joint.actuated]]).max()
        if carries < WHOLE_ARM and np.isfinite(travel):
            total += float(travel)
    return total


def sample_poses(robot: Robot, count: int, seed: int = 0) -> Array:
    """(count, n) random coordinates within limits and two rad or metres of a natural pose.

    The same question to the same robot has the same answer, and is worked out once.

    That is the start of a robot with closed loops, else zero or the middle of limits without it.

    Raises:
        Refusal: The loops can hardly be closed anywhere near their start.
    """
    known = _SAMPLES.setdefault(robot, {})
    if (count, seed) not in known:
        known[count, seed] = _drawn(robot, count, np.random.default_rng(seed))
    return known[count, seed].copy()


def _drawn(robot: Robot, count: int, rng: np.random.Generator) -> Array:
    low, high = np.maximum(robot.lower, -1e6), np.minimum(robot.upper, 1e6)
    middle = np.clip(0.0, low, high)
    if isinstance(robot.coupling, LoopCoupling):
        middle = robot.coupling.start[: robot.n]
    for reach in (2.0, 1.0, 0.5, 0.2, 0.05, 0.01):
        least, most = np.maximum(low, middle - reach), np.minimum(high, middle + reach)
        drawn = rng.uniform(np.minimum(least, most), most, (4 * count, robot.n))
        drawn = drawn[robot.closes(drawn, CLEAR_OF_DEAD_POINTS)]
        if len(drawn) >= count:
            return np.asarray(drawn[:count])
    raise Refusal(
        "the closed loops can hardly be closed anywhere near their start",
        where=robot.name,
        remedy="Give another pose under 'start:' of the closures in robot.yaml.",
    )


def free_joints(robot: Robot) -> tuple[str, ...]:
    """Joints on the way to the tool that a motor drives or a closed loop determines."""
    joints = arm_joints(robot)
    return tuple(j.name for j in joints if j.actuated is not None or j.name in robot.dependent)


def arm_links(robot: Robot) -> tuple[ArmJoint, ...]:
    """Joints whose link is long enough to bend, twist or have the wrong length."""
    return tuple(joint for joint in arm_joints(robot) if joint.length > SHORTEST_LINK)


def last_link(robot: Robot) -> str:
    """The link behind the last joint: what yields there is the flange and what is bolted to it."""
    return arm_joints(robot)[-1].link


def arm_joint(robot: Robot, name: str) -> ArmJoint:
    """The joint of that name, or the joint that moves the link of that name."""
    return next(joint for joint in arm_joints(robot) if name in (joint.name, joint.link))


def carrier_of(robot: Robot, name: str) -> ArmJoint | None:
    """The joint whose link carries the joint of that name; None: the base does."""
    index = arm_joint(robot, name).index
    return arm_joints(robot)[index - 1] if index else None


def passed_on(robot: Robot, link: ArmJoint) -> tuple[tuple[int, float], ...]:
    """Coupled joints at the far end of a link that follow its rotation about the joint axis.

    Where a later joint of the chain mimics the joint that moves `link` about a parallel axis, a
    rod ties it to that link's direction. The rod does not know why the link turned: a bend in the
    plane of the linkage is passed on just as a turn of the motor.
    """
    rules = robot.followers
    chain = robot.mechanism().chain
    return tuple(
        (int(chain.coordinates[k]), rules[name].multiplier)
        for k, name in enumerate(chain.names)
        if k > link.index and name in rules and rules[name].driver == link.name
    )
