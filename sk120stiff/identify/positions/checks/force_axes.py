"""Forces beside readings that have the other sign, or are stated in other axes.

A force sensor tells what the tool does to the environment as often as the reverse, reads in axes of
its own, sits on the flange turned by a quarter or an eighth, and has its columns exchanged. Springs
under the forces as they are stated then explain little, and names of the catalogue take what they
can. What springs make of a force is linear in its components, so all ways are tried at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import permutations, product

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, listed, two_digits
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.beside_frames import BesideFrames, beside_frames
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.data import Frame
from sk120stiff.measurements.sensor_axes import Rpy, axes_line
from sk120stiff.measurements.table.columns import FORCES

HALF = 0.5  # of the square of what is left, below which other axes must bring it; of all there is
BEYOND_DOUBT = 10.0  # logarithm of the odds for them
AS_GOOD = 1.05  # times the least square, within which what changes least is meant
FAR = 10.0  # deg: a sensor that is turned by less is an effect (`force_rotation`)
STEP = 5.0  # deg between the angles that are tried
FORCE, MOMENT = slice(3), slice(3, 6)  # of a wrench


def refuse_other_forces(found: Calibration, readings: Measurements) -> None:
    """Stop where springs explain the readings under other forces than were stated.

    Displacements along all axes are left to `data_checks`, which looks at more of them.

    Args:
        found: A calibration that has placed the rigid arm.
        readings: What it was fitted to.

    Raises:
        InputError: They do, beyond doubt.
    """
    if not readings.wrench.any() or "displacement" in found.problem.channels.present:
        return
    frames: tuple[Frame, Frame] = ("base", "tool")
    if readings.force_frame == "tool":
        frames = frames[::-1]
    parts = [_Stated(frame, i, j) for frame in frames for i in range(3) for j in range(3)]
    sag = beside_frames(found, [part.of for part in (_Stated(frames[0], 0, 0, 0.0), *parts)])
    if sag.freedom <= 0:
        return
    ways = list(_ways(readings.sensor_rpy))
    left = np.array([sag.square(way.along(sag)) for way in ways])
    whole, freedom = float(sag.gap @ sag.gap), sag.freedom
    enough = HALF * min(left[0], whole)
    for k in np.flatnonzero(left <= AS_GOOD * enough):
        left[k] = sag.within(ways[k].along(sag))
    least = float(left.min())
    best = min((way for way, own in zip(ways, left, strict=True) if own <= AS_GOOD * least),
               key=_Way.changes)  # fmt: skip
    odds = 0.5 * freedom * np.log(left[0] / max(least, 1e-300)) - np.log(len(ways))
    if not best.changes()[0] or odds < BEYOND_DOUBT or least > enough:
        return
    share = f"{two_digits(100.0 * float(np.sqrt(least / left[0])))} %"
    said, mend = best.words(frames, readings.sensor_rpy)
    raise InputError(
        f"the forces look stated otherwise: taken {said}, springs leave {share} of the gap that "
        "they leave as the forces stand",
        where=readings.place,
        remedy=mend,
    )


@dataclass(frozen=True, eq=False)
class _Stated:
    """One component of the forces and moments, taken to act along an axis of a frame."""

    frame: Frame
    axis: int
    column: int
    times: float = 1.0

    def of(self, problem: PoseProblem) -> PoseProblem:
        """The problem under this part of its loads."""
        readings = problem.measurements
        wrench = np.zeros(readings.wrench.shape)
        for part in (FORCE, MOMENT):
            own = readings.wrench[:, part][:, self.column]
            wrench[:, part][:, self.axis] = self.times * own
        stated = replace(readings, wrench=wrench, force_frame=self.frame)
        return replace(problem, measurements=stated)


@dataclass(frozen=True, eq=False)
class _Way:
    """How forces may be meant.

    Attributes:
        other: 1: in axes of the other frame than was stated.
        matrix: (3, 3) what is meant, by what is stated.
        angle: By how much their axes are turned about z [deg].
        sign: 1, or -1 where they are those of the robot on what it touches.
        order, signs: Which column each axis is, and of which sign.
    """

    other: int
    matrix: Array
    angle: float = 0.0
    sign: float = 1.0
    order: tuple[int, ...] = (0, 1, 2)
    signs: tuple[float, ...] = (1.0, 1.0, 1.0)

    def along(self, sag: BesideFrames) -> Array:
        """(r, n) readings per compliance under the forces taken so, weight and payload included."""
        weight, parts = sag.along[0], sag.along[1 + 9 * self.other : 10 + 9 * self.other]
        return np.asarray(weight + np.einsum("k,krn->rn", self.matrix.ravel(), parts - weight))

    def changes(self) -> tuple[int, float]:
        """How many things are otherwise than stated, and by how much they are turned."""
        turned, exchanged = abs(self.angle) >= FAR, self.order != (0, 1, 2)
        negated = sum(sign < 0.0 for sign in self.signs)
        return self.other + (self.sign < 0.0) + turned + exchanged + negated, abs(self.angle)

    def words(self, frames: tuple[Frame, Frame], rpy: Rpy | None) -> tuple[str, str]:
        """What they look like, and what mends them."""
        said, mend = [], []
        if self.sign < 0.0:
            said.append("with the other sign")
            mend.append("Negate them: the force on the robot is meant, not that of the robot.")
        if self.order != (0, 1, 2):
            looks = ", ".join(FORCES[self.order.index(k)] for k in range(3))
            said.append(f"with the columns fx, fy, fz for {looks}")
            mend.append(f"Rename the headers of the force: {looks}.")
        if turned := [f for f, sign in zip(FORCES, self.signs, strict=True) if sign < 0.0]:
            said.append(f"with {listed(turned)} of the other sign")
            mend.append(f"Negate {listed(turned)}.")
        if self.other:
            said.append(f"in axes of the {frames[self.other]}")
        turns = abs(self.angle) >= FAR
        if turns:
            said.append(f"turned by {self.angle:g} deg about z of the {frames[self.other]}")
        if self.other or turns:
            frame, turn = frames[self.other], Rotation.from_euler("z", self.angle, degrees=True)
            line = f"force: {{frame: {frame}}}"
            if turns or rpy is not None:
                line = axes_line(frame, turn, rpy)
            mend.append(f"Write '{line}' into the YAML file.")
        return " and ".join(said), " ".join(mend)


def _ways(rpy: Rpy | None) -> Iterator[_Way]:
    """As they stand first; turned about z with either sign, exchanged, single axes negated."""
    yield _Way(0, np.eye(3))
    for other, angle in product(range(2), np.arange(-180.0 + STEP, 180.0 + STEP, STEP)):
        for sign in (1.0, -1.0):
            turn = Rotation.from_euler("z", angle, degrees=True).as_matrix()
            yield _Way(other, np.asarray(sign * turn), float(angle), sign)
    sensor = Rotation.from_euler("xyz", rpy or (0.0, 0.0, 0.0)).as_matrix()
    for order, signs in product(permutations(range(3)), product((1.0, -1.0), repeat=3)):
        if order == (0, 1, 2) and len(set(signs)) == 1:
            continue
        columns = np.array(signs)[:, None] * np.eye(3)[list(order)]
        yield _Way(0, sensor @ columns @ sensor.T, order=order, signs=signs)
