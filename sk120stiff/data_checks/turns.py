"""Turns of the tool beside its displacements: do they go with the same arm, as they are stated?

Whatever yields under a load moves the point and turns the tool: the compliances that explain the
displacements explain the turns as well, up to those that displacements do not show. So turns of
another frame, sign, unit or kind of angle are told as slips in displacements are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.data_checks.one_marker import of_one_marker
from sk120stiff.data_checks.passive import passive
from sk120stiff.data_checks.sheet import Sheet, sheet_of
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot, Screws
from sk120stiff.robot.rotations import crossed, rotation_vector

CLEARER = 1.7  # times as much that is left without the correction, as of displacements
SOUND = 0.75  # share explained once turns are right
NONE = 0.3  # share below which turns are not of this arm, noise or not
MANY = 300  # readings that suffice
SPARE = 6  # numbers beyond the compliances that it takes to judge
VECTOR = (
    "Write the rotation vector from the tool's axes without load to those with it; or where the "
    "point stood and how the tool was turned under each load:"
)
UNITS = (
    (np.pi / 180.0, "degrees labelled rad"),
    (180.0 / np.pi, "radians labelled deg"),
    (1e-3, "mrad labelled rad, or urad labelled mrad"),
    (1e3, "rad labelled mrad, or mrad labelled urad"),
    (np.pi / 180.0 * 1e3, "degrees labelled mrad"),
)


@dataclass(frozen=True)
class TurnSlip:
    """What looks wrong in turns.

    Attributes:
        said: In words, without a full stop.
        remedy: What mends it.
        certain: No other cause looks like it.
    """

    said: str
    remedy: str
    certain: bool


def turn_slip(robot: Robot, measurements: Measurements) -> TurnSlip | None:
    """What looks written down wrongly in turns beside sound displacements, or None."""
    said = measurements.absolute
    if said is None or said.channels.turn is None or said.channels.displacement is None:
        return None
    read = np.isfinite(said.channels.turn).all(axis=1)
    used = measurements.use & read & measurements.wrench.any(axis=1)
    if 3 * int(used.sum()) < robot.n + SPARE:
        return None
    rows = np.flatnonzero(used)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), MANY)).astype(np.intp)]
    own = of_one_marker(measurements.select(rows))
    sheet, turn = sheet_of(robot, own), said.channels.turn[rows]
    if sheet is None or len(own.pose) != len(rows) or not turn.any() or not sheet.exists():
        return None
    moved, turned = sheet.columns(), sheet.turning_columns()

    def share(turns: Array) -> float:
        """Of the squares of turns, explained by what explains displacements and turns together."""
        return _explained(moved, sheet.measured, turned, turns)

    now = share(turn)
    best = max(_corrections(sheet, turn), key=lambda each: share(each[0]))
    after = share(best[0])
    by = f"(the arm's springs and bearings could then explain {after:.3g} of the turns' squares"
    if after >= SOUND and 1.0 - now > CLEARER * (1.0 - after):
        return TurnSlip(f"{best[1]} {by}, as they stand {now:.3g})", best[2], certain=True)
    if now >= NONE:
        return None
    return TurnSlip(
        "drx, dry, drz do not go with the displacements: what explains these explains "
        f"{now:.0%} of the turns' squares",
        "They should be the rotation vector from the tool's axes without load to those with it, in "
        "the axes of the displacements; rename the columns to leave them out.",
        certain=False,
    )


def _explained(moved: Array, d: Array, turned: Array, turns: Array) -> float:
    """Share of the squares of turns (N, 3) that compliances explain beside displacements."""
    known = np.isfinite(d)
    sizes = rms(d[known]), rms(turns)
    columns = np.concatenate([moved / sizes[0], turned / sizes[1]])
    both = np.concatenate([d / sizes[0], turns / sizes[1]])
    left = passive(columns, both)
    alone = passive(moved, d)
    unexplained = left.left * left.count - (1.0 - alone.share) * int(known.sum())
    return max(1.0 - max(unexplained, 0.0) / turns.size, 0.0)


def _corrections(sheet: Sheet, turn: Array) -> Iterator[tuple[Array, str, str]]:
    """Turns without a slip, what it was, and what mends it."""
    at = sheet.at()
    yield (
        -turn,
        "drx, dry, drz look inverted: from the tool's axes with the load to those without",
        "Change their signs.",
    )
    for factor, slip in UNITS:
        yield factor * turn, f"drx, dry, drz look like {slip}", "Mend their headers."
    there, other, write = np.swapaxes(at.rotation, 1, 2), "base", "in the axes of the displacements"
    if sheet.displacement_frame == "base":
        there, other = at.rotation, "tool"
    yield (
        np.einsum("nij,nj->ni", there, turn),
        f"drx, dry, drz look as if they were given in {other} axes",
        f"Turn them, row by row, so that they are {write}.",
    )
    for order in ([1, 0, 2], [2, 1, 0], [0, 2, 1], [1, 2, 0], [2, 0, 1]):
        names = ", ".join(f"dr{'xyz'[k]}" for k in order)
        yield (
            turn[:, order],
            f"drx, dry, drz look like {names}",
            "Rename the headers of the turns.",
        )
    if sheet.displacement_frame == "base":
        yield (
            np.einsum("nij,nj->ni", _of_roll_pitch_yaw(at), turn),
            "drx, dry, drz look like differences of roll, pitch and yaw",
            f"{VECTOR} x y z beside qw qx qy qz, which 'sk120stiff import' makes of roll, pitch "
            "and yaw.",
        )
        yield (
            np.einsum("nij,nj->ni", _of_vectors(at), turn),
            "drx, dry, drz look like differences of rotation vectors",
            f"{VECTOR} x y z beside rx[rad] ry[rad] rz[rad].",
        )


def _of_roll_pitch_yaw(at: Screws) -> Array:
    """(N, 3, 3) small turns, base axes, per change of the angles in R = Rz(yaw) Ry(pitch) Rx."""
    R = at.rotation
    yaw, pitch = np.arctan2(R[:, 1, 0], R[:, 0, 0]), np.arcsin(np.clip(-R[:, 2, 0], -1.0, 1.0))
    zero, one = np.zeros_like(yaw), np.ones_like(yaw)
    by_yaw = np.stack([zero, zero, one], axis=1)
    by_pitch = np.stack([-np.sin(yaw), np.cos(yaw), zero], axis=1)
    by_roll = np.stack(
        [np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)], axis=1
    )
    return np.stack([by_roll, by_pitch, by_yaw], axis=2)


def _of_vectors(at: Screws) -> Array:
    """(N, 3, 3) small turns, base axes, per change of the rotation vector of the tool's axes."""
    v = rotation_vector(at.rotation)
    angle = np.linalg.norm(v, axis=1)[:, None, None]
    K = crossed(v)
    small = angle < 1e-6
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) + first * K + second * (K @ K)
