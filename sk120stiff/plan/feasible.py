"""Poses at which an arm can stand and loads that its motors can hold, as far as the URDF tells.

No collision check: the floor is a height, the base column a cylinder, the arm a line through the
origins of its joints. What nobody stated (efforts, masses, a floor) is not guessed but told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError, Refusal
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_joints, arm_length

# Of the stretched arm: the base, and half a link's thickness, which the line through the joints
# lacks. A UR10 has 0.10 m and 0.06 m on 1.75 m (0.09), a Panda 0.10 m and 0.06 m on 1.3 m (0.12).
COLUMN_RADIUS = 0.12
NEAR_THE_SHOULDER = 2.0  # radii along the arm within which it belongs to the shoulder
ALONG_A_LINK = 4  # points at which a link is looked at
SHARE_OF_EFFORT = 0.9  # of a motor's effort that a push to be held may ask for
PLACEHOLDER = 0.5  # share of poses whose weight alone is too much: then no such motors are built in


@dataclass(frozen=True, eq=False)
class Column:
    """What the arm stands on: a cylinder about the first joint's axis, from the shoulder down.

    It has a round top and no lower end, so it holds a pedestal of any height too.

    Attributes:
        shoulder: (3,) the second joint's place on the axis, base frame [m].
        down: (3,) unit vector along the axis, away from the arm.
        radius: [m]
    """

    shoulder: Array
    down: Array
    radius: float

    def holds(self, points: Array) -> Mask:
        """(...,) which of the points (..., 3) [m] lie inside."""
        from_top = points - self.shoulder
        below = np.maximum(from_top @ self.down, 0.0)
        return np.asarray(
            np.linalg.norm(from_top - below[..., None] * self.down, axis=-1) < self.radius
        )


def base_column(robot: Robot) -> Column | None:
    """The column of an arm whose first joint turns; None for others and for very short chains."""
    joints = arm_joints(robot)
    if len(joints) < 3 or not joints[0].revolute:
        return None
    screws = robot.screws(robot.rest)
    axis, foot, second = screws.axes[0], screws.origins[0], screws.origins[1]
    shoulder = foot + ((second - foot) @ axis) * axis
    towards_base = -(shoulder @ axis)  # the base frame's origin lies this far along the axis
    radius = COLUMN_RADIUS * arm_length(robot)
    if abs(towards_base) < 0.1 * radius:  # the base frame sits at the shoulder: its -z is down
        towards_base = -axis[2] or -1.0
    return Column(shoulder, np.sign(towards_base) * axis, radius)


def clear_of(column: Column, robot: Robot, a: Array, point: Array) -> Mask:
    """(N,) poses at which nothing beyond the shoulder lies in the column: elbow, wrist, tool."""
    line = _centre_line(robot, a, point)  # (N, k, 3), shoulder to point
    from_shoulder = np.cumsum(np.linalg.norm(np.diff(line[0], axis=0), axis=1))
    free = np.ones(len(a), dtype=bool)
    for k, reach in enumerate(from_shoulder):
        start, end = line[:, k], line[:, k + 1]
        length = float(np.linalg.norm(end[0] - start[0]))
        for share in np.arange(1, ALONG_A_LINK + 1) / ALONG_A_LINK:
            if reach - (1.0 - share) * length < NEAR_THE_SHOULDER * column.radius:
                continue
            free &= ~column.holds(start + share * (end - start))
    return free


def lowest_points(robot: Robot, a: Array, point: Array) -> Array:
    """(N,) height of the lowest of all moving links' origins and of the point, base frame [m]."""
    heights = [robot.screws(a, point=point).position[:, 2]]
    heights += [robot.placement(a, frame)[:, 2, 3] for frame in _moving_frames(robot)]
    return np.asarray(np.min(heights, axis=0))


def effort_limits(robot: Robot) -> Array:
    """(n,) largest efforts of the actuated joints [N·m or N]; infinite where none is stated."""
    stated = {joint.name: joint.effort for joint in robot.document.joints}
    return np.array([stated.get(name) or np.inf for name in robot.actuated])


def holdable_share(robot: Robot, a: Array, wrench: Array, point: Array, efforts: Array) -> Array:
    """(N,) largest factor on the loads, at most one, that the motors hold beside the arm's weight.

    Args:
        robot: The robot.
        a, wrench: (N, n) poses and (N, 6) loads at `point` of the tool frame, base axes [N, N·m].
        point: (3,) [m].
        efforts: (n,) what the motors may be asked for [N·m or N].

    Returns:
        (N,) zero where the weight alone is too much.
    """
    load = robot.screws(a, point=point).torques(wrench)
    weight = np.zeros_like(a)
    if robot.total_mass > 0.0:
        unique, inverse = np.unique(a, axis=0, return_inverse=True)
        weight = robot.gravity_torque(unique)[inverse.reshape(-1)]
    room = np.where(load > 0.0, efforts - weight, efforts + weight)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(np.abs(load) > 0.0, room / np.abs(load), np.inf)
    share = np.where(np.abs(weight) > efforts, 0.0, share)
    return np.asarray(np.clip(share.min(axis=1), 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Held:
    """Loads that the motors can hold.

    Attributes:
        rows: Those of the candidates that remain.
        wrench: (K, 6) their loads, scaled down where need be [N, N·m].
        remarks: What was done and what nobody stated, in sentences.
    """

    rows: Index
    wrench: Array
    remarks: tuple[str, ...]


def held_loads_of(robot: Robot, a: Array, wrench: Array, point: Array) -> Held:
    """Scale loads (N, 6) at poses (N, n) to what the efforts of the URDF allow.

    Raises:
        Refusal: The motors cannot hold the arm's weight at any of the poses.
    """
    every = np.arange(len(a))
    efforts = effort_limits(robot)
    known = np.isfinite(efforts)
    if not known.any():
        said = "The URDF states no efforts: that the motors can hold these loads was not checked."
        return Held(every, wrench, (said,))
    share = holdable_share(robot, a, wrench, point, SHARE_OF_EFFORT * efforts)
    fallen = share == 0.0
    if fallen.mean() > PLACEHOLDER:
        raise Refusal(
            f"at {100 * fallen.mean():.0f} % of the poses the efforts of the URDF cannot even hold "
            "the arm's own weight",
            where=robot.name,
            remedy='Correct effort or masses in the URDF; effort="0" says that it is not known.',
        )
    remarks = []
    if not known.all():
        names = ", ".join(np.array(robot.actuated)[~known])
        remarks.append(f"The URDF states no effort of {names}: not checked there.")
    if robot.total_mass == 0.0:
        remarks.append("The URDF states no masses: the arm's own weight is not counted.")
    rows = every[~fallen]
    size = np.linalg.norm(wrench[rows, :3], axis=1)
    # Rounded down to three digits: a scale that is set by hand, and never above what is allowed.
    digit = 10.0 ** (np.floor(np.log10(np.maximum(share[rows] * size, 1e-300))) - 2)
    kept = np.where(share[rows] < 1.0, np.floor(share[rows] * size / digit) * digit / size, 1.0)
    scaled = wrench[rows] * kept[:, None]
    if (share[rows] < 1.0).any():
        sizes = size * kept
        remarks.append(
            f"Of {size.max():.3g} N the motors hold {sizes.min():.3g} to {sizes.max():.3g} N, "
            f"as the pose allows: no joint gives more than {100 * SHARE_OF_EFFORT:.0f} % of its "
            "effort in the URDF, the arm's weight included."
        )
    return Held(rows, scaled, tuple(remarks))


def _centre_line(robot: Robot, a: Array, point: Array) -> Array:
    """(N, k, 3) origins of the joints from the second one on, then the point [m]."""
    screws = robot.screws(a, point=point)
    tool = robot.screws(a).position
    ends = np.stack([tool, screws.position], axis=1)
    return np.concatenate([screws.origins[:, 1:], ends], axis=1)


def _moving_frames(robot: Robot) -> tuple[str, ...]:
    """Links that some joint moves against the base frame."""
    body, _ = robot.tree.body(robot.base_frame)
    return tuple(
        frame
        for frame in robot.frames
        if _is_carried(robot, frame) and robot.tree.body(frame)[0] != body
    )


def _is_carried(robot: Robot, frame: str) -> bool:
    try:
        robot.tree.path(robot.base_frame, frame)
    except InputError:
        return False
    return True
