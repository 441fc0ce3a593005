"""Forces beside positions that have the other sign, or are stated in other axes.

A force sensor tells what the tool does to the environment as often as the reverse, reads in axes of
its own, and sits on the flange turned by a quarter or an eighth. Springs under the forces as they
are stated then explain little, and names of the catalogue take what they can.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, two_digits
from sk120stiff.identify.absolute.beside_frames import BesideFrames, beside_frames
from sk120stiff.identify.absolute.calibrate import Calibration
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.data import Frame
from sk120stiff.measurements.sensor_axes import Rpy, axes_line

HALF = 0.5  # of the square of what is left, below which other axes must bring it
BEYOND_DOUBT = 10.0  # logarithm of the odds for them
AS_GOOD = 1.05  # times the least square, within which what changes least is meant
FAR = 10.0  # deg: a sensor that is turned by less is an effect (`force_rotation`)
STEP = 5.0  # deg between the angles that are tried
FORCE, MOMENT = slice(3), slice(3, 6)  # of a wrench
ABOUT_Z = np.array(  # turns about z: what goes with the cosine, with the sine, and with neither
    [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ]
)


def refuse_other_forces(found: Calibration, readings: Measurements) -> None:
    """Stop where springs explain the positions under other forces than were stated.

    Args:
        found: A calibration that has placed the rigid arm.
        readings: What it was fitted to.

    Raises:
        InputError: They do, beyond doubt.
    """
    if not readings.wrench.any() or "position" not in found.problem.channels.present:
        return
    frames: tuple[Frame, Frame] = ("base", "tool")
    if readings.force_frame == "tool":
        frames = frames[::-1]
    parts = [_Stated(frame, turn) for frame in frames for turn in (*ABOUT_Z, 0.0 * ABOUT_Z[0])]
    sag = beside_frames(found, [part.of for part in parts])
    if sag.freedom <= 0:
        return
    ways = [_Way(0, 0.0, 1.0)] + [
        _Way(k, angle, sign)
        for k in range(2)
        for angle in np.arange(-180.0 + STEP, 180.0 + STEP, STEP)
        for sign in (1.0, -1.0)
    ]
    left = np.array([sag.square(way.along(sag)) for way in ways])
    least = float(left.min())
    best = min((way for way, own in zip(ways, left, strict=True) if own <= AS_GOOD * least),
               key=_Way.changes)  # fmt: skip
    odds = 0.5 * sag.freedom * np.log(left[0] / max(least, 1e-300))
    if not best.changes()[0] or odds < BEYOND_DOUBT or least > HALF * left[0]:
        return
    share = f"{two_digits(100.0 * float(np.sqrt(least / left[0])))} %"
    said, mend = best.words(frames, readings.sensor_rpy)
    raise InputError(
        f"the forces look stated otherwise: {said}, springs leave {share} of the gap that they "
        "leave as the forces stand",
        where=readings.place,
        remedy=mend,
    )


@dataclass(frozen=True, eq=False)
class _Stated:
    """A part of the forces and moments, taken to be stated in axes of a frame."""

    frame: Frame
    part: Array

    def of(self, problem: PoseProblem) -> PoseProblem:
        """The problem under this part of its loads."""
        readings = problem.measurements
        wrench = np.hstack([readings.wrench[:, own] @ self.part.T for own in (FORCE, MOMENT)])
        stated = replace(readings, wrench=wrench, force_frame=self.frame)
        return replace(problem, measurements=stated)


@dataclass(frozen=True)
class _Way:
    """How forces may be meant.

    Attributes:
        other: 1: in axes of the other frame than was stated.
        angle: By how much their axes are turned about z [deg].
        sign: 1, or -1 where they are those of the robot on what it touches.
    """

    other: int
    angle: float
    sign: float

    def along(self, sag: BesideFrames) -> Array:
        """(r, n) readings per compliance under the forces taken so, weight and payload included."""
        cosine, sine, neither, weight = sag.along[4 * self.other : 4 * self.other + 4]
        turn = np.radians(self.angle)
        whole = np.cos(turn) * (cosine - weight) + np.sin(turn) * (sine - weight)
        return np.asarray(weight + self.sign * (whole + neither - weight))

    def changes(self) -> tuple[int, float]:
        """How many things are otherwise than stated, and by how much they are turned."""
        turned = abs(self.angle) >= FAR
        return self.other + (self.sign < 0.0) + turned, abs(self.angle)

    def words(self, frames: tuple[Frame, Frame], rpy: Rpy | None) -> tuple[str, str]:
        """What they look like, and what mends them."""
        axes = f"axes of the {frames[self.other]}"
        said, mend = [], []
        if self.sign < 0.0:
            said.append("with the other sign")
            mend.append("Negate them: the force on the robot is meant, not that of the robot.")
        if self.other:
            said.append(f"in {axes}")
        turned = abs(self.angle) >= FAR
        if turned:
            said.append(f"turned by {self.angle:g} deg about z of the {frames[self.other]}")
        if self.other or turned:
            frame, turn = frames[self.other], Rotation.from_euler("z", self.angle, degrees=True)
            line = f"force: {{frame: {frame}}}"
            if turned or rpy is not None:
                line = axes_line(frame, turn, rpy)
            mend.append(f"Write '{line}' into the YAML file.")
        return f"taken {' and '.join(said)}", " ".join(mend)
