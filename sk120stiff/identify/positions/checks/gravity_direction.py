"""An arm that hangs from a ceiling or a wall while its file says that it stands on a floor.

Sag is linear in the springs' compliances and in the components of gravity. Both are fitted in
turn, from every axis of the base on, beside errors of all joint frames and waves over all joints'
angles, and no spring pushes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from sk120stiff.arrays import Array
from sk120stiff.effects import CATALOGUE, Effect
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.effects.joint_springs import JointSprings
from sk120stiff.effects.transmission_error import TransmissionError
from sk120stiff.errors import InputError, two_digits
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.beside_frames import (
    ROUNDING,
    beside_frames,
    square_within,
    without_springs,
)
from sk120stiff.identify.positions.omitted.other_causes import causes_at
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements

HALF = 0.5  # of the square of what is left, below which another direction must bring it
BEYOND_DOUBT = 10.0  # logarithm of the odds for it
AS_WELL = 1.25  # times the square that springs of either sign leave as gravity is stated
FAR = np.radians(10.0)  # rad between two directions, below which the base is no more than unlevel
ROUNDS = 30  # of fitting springs and direction in turn
CLEAR = 3.0  # logarithm of the odds from which on one of two causes is the likelier
OF_LEVEL = 2  # numbers that tell how a base is off level
NEAR_AXIS = 0.02  # components below which a direction is that of an axis


def refuse_another_gravity(found: Calibration, readings: Measurements) -> tuple[str, ...]:
    """Stop where the arm sags to another side than its file says.

    Where the file states gravity itself, a sentence tells what the sag looks like.

    Raises:
        InputError: It does, beyond doubt.
    """
    robot = found.model.robot
    size = float(np.linalg.norm(robot.gravity_in_base))
    present = set(found.problem.channels.present)
    if size == 0.0 or "inclination" in present or not present & {"position", "distance"}:
        return ()  # a level shows where gravity points itself
    sag = _Sag.of(found)
    if sag.freedom <= 0 or not sag.by_axis.any():
        return ()
    stated = robot.gravity_in_base / size
    best = sag.best()
    before, after = sag.left(stated), sag.within(best)
    odds = 0.5 * sag.freedom * np.log(before / max(after, 1e-300))
    if odds < BEYOND_DOUBT or after > AS_WELL * sag.signed(stated):
        return ()
    off = float(np.arccos(np.clip(best @ stated, -1.0, 1.0)))
    share = f"{two_digits(100.0 * float(np.sqrt(after / before)))} %"
    if off < FAR:
        other, lead = _another_cause(found, sag.left(best))
        if lead > 0.0:
            return ()  # what is not level moves what yields alone, and more is moved
        as_well = (
            f" Or else {other.id} is at work, which explains nearly as much."
            if other is not None and lead > -CLEAR
            else ""
        )
        return (
            f"The arm sags as if its base stood {np.degrees(off):.2g} deg off level: with "
            f"{_told(best, size)} springs leave {share} of the gap that they leave as it is "
            f"stated. Level the base, or write that into the YAML file.{as_well}",
        )
    if after > HALF * before:
        return ()
    if len(near := np.flatnonzero(np.abs(best) > 1.0 - NEAR_AXIS)):
        best = np.sign(best) * (np.arange(3) == near[0])
    looks = (
        f"the arm sags as if gravity were {_listed(best, size)} in axes of the base: with that "
        f"springs leave {share} of the gap that they leave as it is stated"
    )
    if readings.gravity is not None:
        return (f"{looks[0].upper()}{looks[1:]}.",)
    raise InputError(
        looks,
        where=readings.place,
        remedy=f"Hangs it from a wall or a ceiling? Write {_told(best, size)} into the YAML file; "
        f"or {_told(stated, size)}, if that is right.",
    )


def _another_cause(found: Calibration, after: float) -> tuple[Effect | None, float]:
    """The likeliest other cause, and the logarithm of its odds over a base that is not level.

    Whatever goes with the sag looks in part like that, a base that yields under it above all.

    Args:
        found: The calibration.
        after: Square of what springs leave under the gravity that explains most.
    """
    problem, model = found.problem, without_springs(found.model)
    present = [effect.id for effect in model.effects]
    causes = tuple(
        cause
        for cause in causes_at(
            model.robot, problem.load_cases, problem.measurements, present, CATALOGUE
        )
        if not isinstance(cause, JointFrame | JointSprings | TransmissionError)
    )
    sag = beside_frames(found, [lambda problem: problem], causes)
    lead, best = -np.inf, None
    for cause, block in zip(causes, sag.others, strict=True):
        pushes = [spec.lower != 0.0 for spec in cause.parameters]
        own = [own for own in (sag.along[0], block, -block[:, pushes]) if own.size]
        left = nnls(np.column_stack(own), sag.gap)[1] ** 2
        more = (block.shape[1] - OF_LEVEL) * np.log(len(found.residual))
        odds = 0.5 * (sag.freedom * np.log(after / max(left, 1e-300)) - more)
        if odds > lead:
            lead, best = float(odds), cause
    return best, lead


def _told(way: Array, size: float) -> str:
    return f"gravity: {_listed(way, size)}"


def _listed(way: Array, size: float) -> str:
    """Gravity as it is written into a file [m/s²]."""
    return f"[{', '.join(f'{round(float(v), 2) + 0.0:.3g}' for v in size * way)}]"


@dataclass(frozen=True, eq=False)
class _Sag:
    """What springs make of gravity, beside the errors of all joint frames.

    Attributes:
        by_axis: (3, r, n) readings per compliance that gravity of its size along an axis makes.
        pulled: (r, n) those that loads make beside it.
        gap: (r,) what is to be explained.
        freedom: Numbers beyond those of frames and springs.
        softest: (n,) compliances that no drive exceeds.
    """

    by_axis: Array
    pulled: Array
    gap: Array
    freedom: int
    softest: Array

    @classmethod
    def of(cls, found: Calibration) -> _Sag:
        """About the rigid arm where a calibration has placed it."""
        size = float(np.linalg.norm(found.model.robot.gravity_in_base))

        def under(way: Array) -> Callable[[PoseProblem], PoseProblem]:
            return lambda problem: replace(problem, model=problem.model.under(size * way))

        sag = beside_frames(found, [under(way) for way in (*np.eye(3), np.zeros(3))])
        by_axis = sag.along[:3] - sag.along[3]
        by_axis[np.abs(by_axis) < ROUNDING * np.abs(sag.along).max()] = 0.0
        return cls(by_axis, sag.along[3], sag.gap, sag.freedom, sag.softest)

    def best(self) -> Array:
        """(3,) unit vector along which gravity explains most."""
        ways = [self._settled(way) for way in (*np.eye(3), *-np.eye(3))]
        return min(ways, key=self.left)

    def left(self, way: Array) -> float:
        """Square of what springs leave where gravity points along a unit vector (3,)."""
        return float(nnls(self._along(way), self.gap)[1] ** 2)

    def within(self, way: Array) -> float:
        """The same with springs no softer than any drive."""
        return square_within(self._along(way), self.gap, self.softest)

    def signed(self, way: Array) -> float:
        """The same where springs may push: a balancer that lifts too much looks like one."""
        A = self._along(way)
        left = self.gap - A @ np.linalg.lstsq(A, self.gap, rcond=None)[0]
        return float(left @ left)

    def _along(self, way: Array) -> Array:
        return np.asarray(self.pulled + np.einsum("k,krn->rn", way, self.by_axis))

    def _settled(self, way: Array) -> Array:
        """The direction to which springs and gravity, fitted in turn, come from another."""
        for _ in range(ROUNDS):
            c = nnls(self._along(way), self.gap)[0]
            sides = self.by_axis @ c
            if not sides.any():
                return way
            found = np.linalg.lstsq(sides.T, self.gap - self.pulled @ c, rcond=None)[0]
            if not found.any():
                return way
            way = found / np.linalg.norm(found)
        return way
