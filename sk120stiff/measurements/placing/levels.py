"""Where gravity points to, told by inclinations alone, and slips that they may hold.

A level lies along a direction v of the tool, and the sine of its angle above the horizon is
-(R v)·g, with R the tool's axes and g the unit vector along which gravity points: linear in g. What
bends is of milliradians, and what a slip brings is of a radian.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import permutations, product

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.table.columns import LEVELS
from sk120stiff.robot import Robot

FITS = 0.1  # rad rms: what no arm is off that is as its URDF and its file state it
BETTER = 0.2  # of what is left, by which a slip of the pen must explain it
WILD = 0.2  # of the rows, that may be wild
FEWEST = 6  # inclinations from which on slips are told
SLACK = 0.1  # of its length, that a direction of gravity which is found may be off
NEAR_AXIS = 0.02  # components below which a direction is that of an axis


@dataclass(frozen=True, eq=False)
class _Levels:
    """K sines of angles above the horizon (K,), directions (K, 3) in tool axes, joints (K, n)."""

    robot: Robot
    a: Array
    level: Array
    sine: Array

    def along(self) -> Array:
        """(K, 3) directions in axes of the base."""
        R = self.robot.screws(self.a).rotation
        return np.asarray(np.einsum("kij,kj->ki", R, self.level))

    def left(self, down: Array) -> float:
        """Rms angle [rad] that is left where gravity points along a unit vector (3,)."""
        return _rms(np.arcsin(self.sine) - np.arcsin(np.clip(-self.along() @ down, -1.0, 1.0)))


def refuse_other_levels(robot: Robot, readings: Measurements) -> None:
    """Stop where inclinations are not those of this arm as it is stated to stand.

    Args:
        robot: With gravity as it is stated.
        readings: Rows with and without inclinations.

    Raises:
        InputError: They are off by more than any arm; the message says which slip would explain it.
    """
    said = readings.absolute
    size = float(np.linalg.norm(robot.gravity_in_base))
    if said is None or said.channels.inclination is None or said.channels.level is None or not size:
        return
    rows = np.flatnonzero(np.isfinite(said.channels.inclination) & readings.use)
    if len(rows) < FEWEST:
        return
    angle, level = said.channels.inclination[rows], said.channels.level[rows]
    levels = _Levels(robot, readings.joints[rows], level, np.sin(angle))
    down = robot.gravity_in_base / size
    left = levels.left(down)
    if left <= FITS:
        return
    where = readings.place
    told = (
        "these inclinations are not those of this arm as it is stated to stand: "
        f"{left:.2g} rad rms are left, the worst fifth apart"
    )
    least = min(FITS, BETTER * left)
    for rms, what, remedy in (*_of_gravity(levels, size), *_of_axes(levels, down),
                              *_of_joints(levels, down)):  # fmt: skip
        if rms < least:
            raise InputError(
                f"{told}. {what}: then {1e3 * rms:.2g} mrad are left",
                where=where,
                remedy=remedy,
            )
    off = np.abs(angle - np.arcsin(np.clip(-levels.along() @ down, -1.0, 1.0)))
    worst = listed([str(readings.line[rows[k]]) for k in np.argsort(-off)[:3]])
    raise InputError(
        told,
        where=f"{where}, worst in lines {worst}",
        remedy="Check where gravity points to in axes of the base, the sign of inc (up is "
        "positive), the directions vx, vy, vz in axes of the tool, and units, zeros, signs "
        "and order of the joint columns.",
    )


_Slip = tuple[float, str, str]  # rms that is left with it mended [rad], what it is, the remedy


def _of_gravity(levels: _Levels, size: float) -> Iterator[_Slip]:
    """Gravity elsewhere; the opposite way it is the sign of the angles as well."""
    A = levels.along()
    found, _, rank, _ = np.linalg.lstsq(A, -levels.sine, rcond=1e-3)
    length = float(np.linalg.norm(found))
    if rank < 3 or abs(length - 1.0) > SLACK:
        return
    best = np.asarray(found / length, dtype=np.float64)
    if len(near := np.flatnonzero(np.abs(best) > 1.0 - NEAR_AXIS)):
        best = np.asarray(np.sign(best) * (np.arange(3) == near[0]))
    line = f"gravity: [{', '.join(f'{v + 0.0:.3g}' for v in np.round(size * best, 2))}]"
    stated = levels.robot.gravity_in_base / size
    remedy = (
        f"Hangs the arm from a ceiling or a wall, or stands it askew? Write '{line}' into the YAML "
        "file."
    )
    if best @ stated < -1.0 + NEAR_AXIS:
        remedy += (
            " If it stands as stated, the level counts down as positive: negate inc. The two are "
            "one to these readings."
        )
    yield levels.left(best), f"Gravity looks as if it were {line[9:]} in axes of the base", remedy


def _of_axes(levels: _Levels, down: Array) -> Iterator[_Slip]:
    """vx, vy, vz exchanged, or of other signs."""
    tried = []
    for order, signs in product(permutations(range(3)), product((1.0, -1.0), repeat=3)):
        mended = levels.level[:, list(order)] * signs
        changes = (order != (0, 1, 2)) + sum(sign < 0.0 for sign in signs)
        rms = replace(levels, level=mended).left(down)
        tried.append((round(rms, 3), changes, rms, order, signs))
    _, _, rms, order, signs = min(tried)
    said, mend = [], []
    if order != (0, 1, 2):
        looks = ", ".join(LEVELS[order.index(k)] for k in range(3))
        said.append(f"the columns vx, vy, vz look like {looks}")
        mend.append(f"Rename the headers: {looks}.")
    if turned := [v for v, sign in zip(LEVELS, signs, strict=True) if sign < 0.0]:
        said.append(f"{listed(turned)} {'looks' if len(turned) == 1 else 'look'} negated")
        mend.append(f"Negate {listed(turned)}.")
    if said:
        what = " and ".join(said)
        yield rms, what[0].upper() + what[1:], " ".join(mend)


def _of_joints(levels: _Levels, down: Array) -> Iterator[_Slip]:
    """One joint that counts the other way, or all of them in another unit."""
    robot, turns = levels.robot, ~np.array(levels.robot.prismatic)
    for name, own in zip(robot.actuated, np.eye(robot.n), strict=True):
        rms = replace(levels, a=levels.a * (1.0 - 2.0 * own)).left(down)
        yield rms, f"{name} looks as if it counted the other way", f"Negate the column {name}."
    for factor, was, unit in (
        (np.pi / 180.0, "degrees, not radians", "deg"),
        (180.0 / np.pi, "radians, not degrees", "rad"),
    ):
        rms = replace(levels, a=np.where(turns, factor, 1.0) * levels.a).left(down)
        yield rms, f"The joint angles look like {was}", f"Write [{unit}] in their headers."


def _rms(values: Array) -> float:
    """Without the largest ones: single rows that are wild are set aside by the fit."""
    kept = np.sort(values**2)[: max(int((1.0 - WILD) * len(values)), 1)]
    return float(np.sqrt(np.mean(kept)))
