"""Rotations as read against those of the placed robot: how targets are mounted, and slips."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.robot import Robot

FITS = np.radians(3.0)  # median, up to which nothing is looked for that would explain it
ASKEW = np.radians(10.0)  # median; no arm's tool is turned by more, be its zeros ever so far off
BETTER = 0.2  # of what is left, by which a slip of the pen must explain it
MOUNTED = np.radians(0.5)  # by which all are turned alike: more than joints are off
COMPUTED = np.radians(0.002)  # no arm is built, and no target reads, as well as that
CORE = 3.0  # times the median angle: what is farther off does not tell how a target sits
TRIM_ROUNDS = 3  # of a mean that leaves out what is farther


def targets_on_tool(
    robot: Robot, readings: Measurements, turn: Array
) -> tuple[Array | None, tuple[str, ...]]:
    """How the targets whose rotations were read are turned on the tool, and what is to be said.

    Args:
        turn: (N, 3, 3) base axes as the instrument sees them.

    Returns:
        Rotation vectors (G, 3) of the targets' axes in those of the tool, one for every group of
        `Absolute.groups`; None where no rotation was read, or the axes are stated to be the tool's.

    Raises:
        InputError: The rotations are not of this robot; the message says what would explain them.
    """
    said = readings.absolute
    if said is None or said.channels.rotation is None:
        return None, ()
    labels = list(dict.fromkeys(said.groups or ("",)))
    groups = np.array([labels.index(own) for own in said.groups or ("",) * readings.n_readings])
    whole = np.isfinite(said.channels.rotation).all(axis=(1, 2)) & readings.use
    if not whole.any():
        return (np.zeros((len(labels), 3)) if said.fit_axes else None), ()
    group = groups[whole]
    screws = robot.screws(readings.joints[whole])
    tool = Rotation.from_matrix(turn[whole] @ screws.rotation)
    read = Rotation.from_matrix(said.channels.rotation[whole])
    sits = mounting(tool, read, group, len(labels))
    beside = _off(tool * sits[group], read)
    if said.fit_axes:
        _refuse(beside, _slips(tool, read, group, len(labels)), readings)
        return sits.as_rotvec(), _far_off(beside)
    left = _off(tool, read)
    alike = float(sits.magnitude().max())
    if left < FITS:
        told = (
            f"The target seems to sit turned by {np.degrees(alike):.3g} deg on the tool: rotations "
            f"are {np.degrees(left):.2g} deg off (median), {np.degrees(beside):.2g} deg but for "
            "that. Write 'rotation: {axes: target}' into the YAML file: the fit then finds it."
        )
        return None, (told,) if alike > MOUNTED and beside < BETTER * left else ()
    slips = chain(_slips(tool, read), [(beside, *_own_axes(alike))] if beside < FITS else [])
    _refuse(left, slips, readings)
    return None, _far_off(left, beside)


def _far_off(left: float, beside: float | None = None) -> tuple[str, ...]:
    """What is said of rotations that nothing but the arm itself explains."""
    if left < FITS:
        return ()
    alike = (
        ""
        if beside is None
        else f", {np.degrees(beside):.2g} deg but for a turn that all have in common ('rotation: "
        "{axes: target}' lets the fit find that)"
    )
    return (
        f"Rotations are {np.degrees(left):.2g} deg off those of the placed robot (median){alike}: "
        "so far off are arms whose joints were never calibrated.",
    )


def mounting(tool: Rotation, read: Rotation, group: Index, count: int) -> Rotation:
    """How each of `count` targets is turned on the tool: a mean of what is not far off (robust)."""
    out = []
    for k in range(count):
        own = tool[group == k].inv() * read[group == k]
        kept = own
        for _ in range(TRIM_ROUNDS if len(own) else 0):
            mean = kept.mean()
            angle = (mean.inv() * own).magnitude()
            kept = own[angle <= max(CORE * float(np.median(angle)), 1e-12)]
        out.append(kept.mean() if len(own) else Rotation.identity())
    return Rotation.concatenate(out)


def _refuse(left: float, slips: Iterable[tuple[float, str, str]], readings: Measurements) -> None:
    """Stop where rotations are not this robot's: a slip explains them, or no arm is so far off.

    Raises:
        InputError: They are not; the message says what would explain them.
    """
    if left < FITS:
        return
    told = (
        "the tool's rotations are not those of the placed robot: they are "
        f"{np.degrees(left):.3g} deg off (median)"
    )
    where = readings.place
    best = min(slips, key=lambda item: item[0])
    if best[0] < min(BETTER * left, FITS):
        raise InputError(f"{told}. {best[1]}", where=where, remedy=best[2])
    if left < ASKEW:
        return
    raise InputError(
        told,
        where=where,
        remedy="Give the axes of the tool frame in those of the instrument, as a rotation vector "
        "rx, ry, rz or a quaternion qw, qx, qy, qz; of angles about three axes 'sk120stiff import' "
        "finds which they are. Or leave these columns out.",
    )


def _off(one: Rotation, other: Rotation) -> float:
    """Median angle between rotations [rad]."""
    return float(np.median((one.inv() * other).magnitude()))


def _slips(
    tool: Rotation, read: Rotation, group: Index | None = None, count: int = 0
) -> Iterator[tuple[float, str, str]]:
    """What is left with one slip mended [rad], what it is, and the remedy.

    With `group` targets may be turned on the tool, each as it likes.
    """

    def left(mended: Rotation) -> float:
        if group is None:
            return _off(tool, mended)
        return _off(tool * mounting(tool, mended, group, count)[group], mended)

    yield (
        left(read.inv()),
        "They look inverted: the instrument's axes in those of the tool.",
        "Change the signs of rx, ry, rz, or of qx, qy, qz.",
    )
    yield (
        left(Rotation.from_quat(np.roll(read.as_quat(), 1, axis=1))),
        "The scalar part of the quaternions looks written last.",
        "Put it first, under qw.",
    )
    yield (
        left(Rotation.from_rotvec(np.degrees(read.as_rotvec()))),
        "They look like radians, not degrees.",
        "Write [rad] in the headers of rx, ry, rz.",
    )


def _own_axes(angle: float) -> tuple[str, str]:
    return (
        f"All are turned by the same {np.degrees(angle):.1f} deg against the tool frame: the "
        "target has axes of its own.",
        "Write 'rotation: {axes: target}' into the YAML file: the fit then finds how it is turned.",
    )
