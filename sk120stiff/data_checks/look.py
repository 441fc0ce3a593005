"""What readings say against themselves, before any spring is fitted: the one place that decides.

Whoever works with readings asks here. Slips of the pen are told with what mends them; readings that
no passive arm can have given, and a stated uncertainty that they contradict, are refused.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.data_checks.efforts import efforts_doubt
from sk120stiff.data_checks.one_marker import of_one_marker
from sk120stiff.data_checks.passive import Passive
from sk120stiff.data_checks.scale import Scale, scale_doubt
from sk120stiff.data_checks.search import SPARE, Slip, as_it_stands, find_slip
from sk120stiff.data_checks.sheet import sheet_of
from sk120stiff.data_checks.turns import TurnSlip, turn_slip
from sk120stiff.data_checks.wild import HALF
from sk120stiff.errors import Refusal, ToolkitWarning, short
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.robot import Robot

NOISY = 3.0  # stated uncertainties that may be left before noise is no excuse
OVERSTATED = 3.0  # times what is left, where a stated uncertainty exceeds the readings too


@dataclass(frozen=True)
class DataChecks:
    """What looks wrong in readings.

    Attributes:
        slip: What was written down wrongly beyond doubt, or None.
        scale: Everything yields far too much or too little, or None.
        limits: Readings beyond the joint limits, in a sentence, or None.
        efforts: Loads beyond what the motors hold, in a sentence, or None.
        turns: Turns that are not those of the displacements, or None.
    """

    slip: Slip | None = None
    scale: Scale | None = None
    limits: str | None = None
    efforts: str | None = None
    turns: TurnSlip | None = None

    @property
    def sentences(self) -> tuple[str, ...]:
        """All of it as warnings."""
        found = [None if self.slip is None else f"{self.slip.said}. {self.slip.remedy}"]
        found += [None if self.turns is None else f"{self.turns.said}. {self.turns.remedy}"]
        found += [None if self.scale is None else f"{self.scale.sentence}."]
        found += [self.limits, self.efforts]
        return tuple(said for said in found if said is not None)

    def refuse_to_explain(self, where: str) -> None:
        """Stop before a cause is sought for what is no cause.

        Raises:
            Refusal: A slip of the pen, or a unit that can only be wrong.
        """
        remedy = "No cause is sought before this is settled."
        if self.slip is not None:
            raise Refusal(self.slip.said, where=where, remedy=f"{self.slip.remedy} {remedy}")
        if self.turns is not None and self.turns.certain:
            raise Refusal(self.turns.said, where=where, remedy=f"{self.turns.remedy} {remedy}")
        if self.scale is not None and self.scale.certain:
            raise Refusal(self.scale.sentence, where=where, remedy=remedy)


def look(model: Model, measurements: Measurements) -> DataChecks:
    """What looks wrong in readings that a model is held against.

    Args:
        model: Its robot decides; its springs are only asked for the scale of everything.
        measurements: Readings; masked ones are left out, and a plan has nothing wrong.
    """
    whole, measurements = measurements, of_one_marker(measurements)
    slip = find_slip(model.robot, measurements)
    scale = None if slip is not None else scale_doubt(model, measurements)
    robot = model.robot
    efforts = None if slip is not None else efforts_doubt(robot, measurements)
    turns = None if slip is not None else turn_slip(robot, whole)
    return DataChecks(slip, scale, limits_doubt(robot, measurements), efforts, turns)


def refuse_slips(model: Model, measurements: Measurements) -> DataChecks:
    """Stop before a cause is sought for what is no cause; what is in doubt is told and returned.

    Raises:
        Refusal: As `refuse_unbelievable`, or as `DataChecks.refuse_to_explain`.
    """
    doubts = look(model, measurements)
    refuse_unbelievable(doubts, model, measurements)
    doubts.refuse_to_explain(str(measurements.path or "the measurements"))
    for said in doubts.sentences:
        warnings.warn(said, ToolkitWarning, stacklevel=5)
    return doubts


def refuse_unbelievable(doubts: DataChecks, model: Model, measurements: Measurements) -> None:
    """Stop where fitting springs would only put a number on nonsense.

    Raises:
        Refusal: No passive arm explains half of the readings and their noise does not excuse it, or
            the stated uncertainty is larger than the readings and than anything they show, or most
            joints stand turns beyond their limits.
    """
    _refuse_turns_beyond(doubts, model.robot, measurements)
    sheet = sheet_of(model.robot, of_one_marker(measurements))
    if sheet is None or not sheet.exists() or not sheet.moves:
        return
    where = str(measurements.path or "the measurements")
    found = as_it_stands(sheet).found
    stated = measurements.noise.sigma
    _refuse_overstated(found, sheet.measured, stated, where)
    excused = stated is not None and found.left < (NOISY * stated) ** 2
    if found.share >= HALF or excused or found.count < model.robot.n + SPARE:
        return
    size, left = (_length(np.sqrt(x)) for x in (found.left / (1.0 - found.share), found.left))
    remedy = (
        "Check that every row's joints, load and reading belong together (sorted, shifted or "
        "shuffled columns), the frames, the units, and that the robot is the right one."
    )
    if doubts.slip is not None:
        remedy = f"It looks as if: {doubts.slip.said}. {doubts.slip.remedy}"
    raise Refusal(
        f"whatever its springs and bearings, this arm explains only {found.share:.0%} of these "
        f"readings ({size} rms per axis, of which {left} remain)",
        where=where,
        remedy=remedy,
    )


def _refuse_turns_beyond(doubts: DataChecks, robot: Robot, measurements: Measurements) -> None:
    """Joints more than a turn beyond their limits at most readings: they are in another unit."""
    joints = measurements.with_joints(robot.actuated, robot.kinds).joints[measurements.use]
    away = np.maximum(robot.lower - joints, joints - robot.upper)
    turns = np.isfinite(away) & (away > 2.0 * np.pi) & ~np.array(robot.prismatic)
    if not len(joints) or turns.any(axis=1).mean() <= HALF:
        return
    raise Refusal(
        f"at {int(turns.any(axis=1).sum())} of {len(joints)} readings joints stand more than a "
        f"turn beyond their limits, {robot.actuated[int(turns.sum(axis=0).argmax())]} first",
        where=str(measurements.path or "the measurements"),
        remedy="Check the unit in the headers of the joint columns, [deg] or [rad]."
        if doubts.slip is None
        else f"It looks as if: {doubts.slip.said}. {doubts.slip.remedy}",
    )


def _refuse_overstated(
    found: Passive, measured: np.ndarray, stated: float | None, where: str
) -> None:
    """A σ above the readings that scatter far less than it: its unit is wrong."""
    if stated is None:
        return
    size = rms(measured)
    above = stated > size and OVERSTATED * np.sqrt(found.left) < stated
    if above or stated > np.nanmax(np.abs(measured)):
        raise Refusal(
            f"the stated uncertainty of one reading, {_length(stated)}, is larger than the "
            f"readings themselves ({_length(size)} rms per axis)",
            where=where,
            remedy="Check noise: {sigma: ..., unit: ...} in the YAML file beside the readings, and "
            "the unit of the readings; without a sigma it is estimated.",
        )


def _length(metres: float) -> str:
    """A length in the unit in which it is easily read."""
    for unit, size in (("m", 1.0), ("mm", 1e-3)):
        if metres >= size:
            return f"{metres / size:.3g} {unit}"
    return f"{short(metres * 1e6)} µm"


FAR = 0.05  # share of a joint's range, beyond which a pose is no matter of calibration


def limits_doubt(robot: Robot, measurements: Measurements) -> str | None:
    """A sentence where readings were taken far beyond the robot's joint limits; or None."""
    joints = measurements.with_joints(robot.actuated, robot.kinds).joints[measurements.use]
    slack = FAR * np.where(np.isfinite(robot.upper - robot.lower), robot.upper - robot.lower, 0.0)
    out = (joints < robot.lower - slack - 1e-9) | (joints > robot.upper + slack + 1e-9)
    if not out.any():
        return None
    parts = []
    for k in np.flatnonzero(out.any(axis=0)):
        worst = joints[out[:, k], k]
        worst = worst[np.argmax(np.abs(worst - 0.5 * (robot.lower[k] + robot.upper[k])))]
        low, here, high = robot.lower[k], worst, robot.upper[k]
        if not robot.prismatic[k]:
            low, here, high = np.degrees((low, here, high))
        unit = "m" if robot.prismatic[k] else "deg"
        parts.append(f"{robot.actuated[k]} stands at {here:.4g} {unit} ({low:.4g} .. {high:.4g})")
    return (
        f"{int(out.any(axis=1).sum())} of {len(joints)} readings stand beyond the joint limits: "
        f"{', '.join(parts)}. Check the unit, the zero and the order of the joint columns."
    )
