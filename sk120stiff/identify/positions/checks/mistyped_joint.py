"""A pose that lies far off because one of its joints was written down wrongly."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from sk120stiff import units
from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.reregistration import placed_anew
from sk120stiff.measurements import Measurements
from sk120stiff.model.predicted import predict_channels

AROUND = np.linspace(-np.pi, np.pi, 72, endpoint=False)  # rad, by which a joint is tried first
FINER = 7  # times the steps between are made a fifth
FITS = 6.0  # times the gap of all others, rms, that it must come down to
KEPT = 4  # answers: terminal, report and verdict.json say the same of one calibration
ALONE = 5.0  # times more that every other joint must leave


@lru_cache(maxsize=KEPT)
def mistyped_joints(found: Calibration, readings: Measurements, most: int) -> tuple[str, ...]:
    """Joints that would explain whole poses that were set aside, a sentence for each.

    Args:
        found: The calibration that set them aside.
        readings: What was given to it.
        most: How many poses are looked at.
    """
    rows = np.flatnonzero(found.wild)
    label = np.array(readings.pose)
    own = {pose: np.flatnonzero((label == pose) & readings.use) for pose in label[rows].tolist()}
    whole = [(pose, each) for pose, each in own.items() if np.isin(each, rows).all()][:most]
    if not whole:
        return ()
    placed = placed_anew(found.model, readings)
    if placed is not None and placed.parts:  # the stations that the model knows
        readings = placed.readings
    told = ((pose, _of_pose(found, readings, each)) for pose, each in whole)
    return tuple(f"Pose {pose}: {what}." for pose, what in told if what)


def _of_pose(found: Calibration, readings: Measurements, rows: Index) -> str | None:
    """Which joint would explain the rows of a pose, in words; None: none, or several would."""
    said = readings.absolute
    if said is None or said.channels.position is None or not len(found.problem.lengths):
        return None
    whole = np.isfinite(said.channels.position[rows]).all(axis=1)
    turning = np.flatnonzero(~np.array(found.model.robot.prismatic))
    if not whole.any():
        return None
    chosen = rows[whole]
    left = {int(k): _best(found, readings, chosen, int(k)) for k in turning}
    joint = min(left, key=lambda k: left[k][0])
    rms, by = left.pop(joint)
    if rms > FITS * found.rms or min((r for r, _ in left.values()), default=np.inf) < ALONE * rms:
        return None
    name, stands = readings.joint_names[joint], float(readings.joints[chosen[0], joint])
    written, meant = (units.from_si(x, "deg", "angle") for x in (stands, stands + by))
    return f"{name} = {float(meant):.2f} deg would explain it, where it is {float(written):.6g} deg"


def _best(found: Calibration, readings: Measurements, rows: Index, k: int) -> tuple[float, float]:
    """Rms that is left with joint k elsewhere [m], and by how much [rad]."""
    tried, step = AROUND, float(AROUND[1] - AROUND[0])
    best = 0.0
    for _ in range(FINER):
        left = _left(found, readings, rows, k, tried)
        best = float(tried[int(np.argmin(left))])
        tried, step = best + step * np.linspace(-1.0, 1.0, 11), step / 5.0
    return float(left.min()), best


def _left(found: Calibration, readings: Measurements, rows: Index, k: int, by: Array) -> Array:
    """(T,) rms per axis that rows leave with joint k moved by each of T angles [m]."""
    many = readings.select(np.tile(rows, len(by)))
    joints = many.joints.copy()
    joints[:, k] += np.repeat(by, len(rows))
    labels = tuple(f"{many.pose[i]} {i // len(rows)}" for i in range(len(joints)))
    moved = replace(many, joints=joints, pose=labels, zero_group=np.arange(len(joints)))
    try:
        at = predict_channels(found.model, moved).position
    except InputError:
        return np.full(len(by), np.inf)
    read = None if moved.absolute is None else moved.absolute.channels.position
    if read is None or at is None:
        return np.full(len(by), np.inf)
    off = (read - at).reshape(len(by), len(rows), 3)
    return np.asarray(np.sqrt(np.mean(off**2, axis=(1, 2))))
