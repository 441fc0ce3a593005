"""Rotations of the tool against those of the placed robot: units, order and direction."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.robot import Robot

FITS = np.radians(3.0)  # median; no arm's tool is turned by more
BETTER = 0.2  # of what is left, by which a slip of the pen must explain it


def refuse_other_turns(robot: Robot, readings: Measurements, turn: Array) -> None:
    """Refuse rotations that are not of this robot's tool; the message says what would explain them.

    Args:
        turn: (3, 3) base axes as the instrument sees them.

    Raises:
        InputError: They are far from those of the tool frame.
    """
    said = readings.absolute
    if said is None or said.channels.rotation is None:
        return
    whole = np.isfinite(said.channels.rotation).all(axis=(1, 2)) & readings.use
    if not whole.any():
        return
    screws = robot.screws(readings.joints[whole])
    tool = Rotation.from_matrix(turn @ screws.rotation)
    read = Rotation.from_matrix(said.channels.rotation[whole])
    left = _off(tool, read)
    if left < FITS:
        return
    angle = f"{np.degrees(left):.3g} deg"
    told = f"the tool's rotations are not those of the placed robot: they are {angle} off (median)"
    where = str(readings.path or "measurements")
    best = min(_slips(tool, read), key=lambda item: item[0])
    if best[0] < min(BETTER * left, FITS):
        raise InputError(f"{told}. {best[1]}", where=where, remedy=best[2])
    raise InputError(
        told,
        where=where,
        remedy="Give the axes of the tool frame in those of the instrument, as a rotation vector "
        "rx, ry, rz or a quaternion qw, qx, qy, qz; or leave these columns out.",
    )


def _off(one: Rotation, other: Rotation) -> float:
    """Median angle between rotations [rad]."""
    return float(np.median((one.inv() * other).magnitude()))


def _slips(tool: Rotation, read: Rotation) -> Iterator[tuple[float, str, str]]:
    """What is left with one slip mended [rad], what it is, and the remedy."""
    yield (
        _off(tool, read.inv()),
        "They look inverted: the instrument's axes in those of the tool.",
        "Change the signs of rx, ry, rz, or of qx, qy, qz.",
    )
    yield (
        _off(tool, Rotation.from_quat(np.roll(read.as_quat(), 1, axis=1))),
        "The scalar part of the quaternions looks written last.",
        "Put it first, under qw.",
    )
    yield (
        _off(tool, Rotation.from_rotvec(np.degrees(read.as_rotvec()))),
        "They look like radians, not degrees.",
        "Write [rad] in the headers of rx, ry, rz.",
    )
    beyond = (tool.inv() * read).mean()
    yield (
        _off(tool * beyond, read),
        f"All are turned by the same {np.degrees(beyond.magnitude()):.1f} deg against the tool "
        "frame: the target has axes of its own.",
        "Add a frame with the target's axes to the URDF and name it as tool_frame, or leave the "
        "rotations out.",
    )
