"""Orientations beside positions: which columns they are, and how their numbers are meant.

Controllers and trackers write three angles in a dozen ways, and no header tells which. The arm
does: with the tracker placed by the positions, only one way of reading them leaves a constant turn
between tool and target, whatever the pose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from sk120stiff import units
from sk120stiff.arrays import Array, Index
from sk120stiff.measurements.importers.columns.orientations import orientation_columns
from sk120stiff.measurements.importers.contract import Column
from sk120stiff.measurements.importers.drafting import Draft
from sk120stiff.measurements.importers.holds.orientations import (
    MATRIX,
    are_orientations,
    numbers_of,
)
from sk120stiff.measurements.importers.told import Mode, Told, plain
from sk120stiff.measurements.importers.tracker.frames import stood_of
from sk120stiff.measurements.placing.registration import Registration
from sk120stiff.measurements.placing.turned import COMPUTED, FITS, mounting
from sk120stiff.measurements.table.columns import QUATERNION
from sk120stiff.robot import Robot

FEWEST = 6  # orientations that tell how they are meant
SAME = 1e-6  # rad; ways that differ by less at every pose are one
APART = 5.0  # times farther off the arm the next way of reading them has to be
QUARTERS = [*Rotation.create_group("O")]  # axes that are exchanged or of the other sign
TURNED_ROUND = "of the tracker in axes of the target"
KNOWN = {
    "zyx moved": "KUKA's A, B, C",
    "xyz fixed": "FANUC's W, P, R",
    "zyz moved": "Kawasaki's O, A, T",
}


@dataclass(frozen=True, eq=False)
class Orientation:
    """Orientations that were understood.

    Attributes:
        columns: Those of the file.
        rotation: (N, 3, 3) of the target in axes of the tracker; NaN where a cell is blank.
        way: How the numbers are meant, in words.
        off, next: Angle to the arm's (median), so and in the next best way [rad].
        turned: By how much the target is turned on the tool [rad].
        axes: Rotation vector of the axes that they are told in, against those of the positions.
    """

    columns: tuple[str, ...]
    rotation: Array
    way: str
    off: float
    next: float
    turned: float
    axes: Array = field(default_factory=lambda: np.zeros(3))

    def sentence(self) -> str:
        """What was understood."""
        told = ""
        if self.axes.any():
            about = ", ".join(f"{part:.3g}" for part in np.degrees(self.axes) + 0.0)
            told = f" in axes turned by ({about}) deg against those of the positions, and put right"
        return (
            f"Orientations {', '.join(self.columns)} are {self.way}{told}: so they are "
            f"{np.degrees(self.off):.2g} deg off the arm's (median), in the next best way "
            f"{np.degrees(self.next):.2g} deg. The target is turned by "
            f"{np.degrees(self.turned):.3g} deg on the tool, which the fit finds with all else."
        )


def understood(
    draft: Draft, robot: Robot, told: Told, mode: Mode, fitted: Registration | None, rows: Index
) -> Orientation | str | None:
    """The orientations of a draft; why they are not taken, in words; None where there are none.

    Args:
        draft: Its rows.
        robot, told: What was measured, and what was told of the file.
        mode: What its positions become.
        fitted, rows: The robot laid onto positions, and those rows (P,).
    """
    columns = orientation_columns(draft.sheet)
    if not columns:
        return None
    if mode != "positions":
        return "how far the point went is all that is used"
    if fitted is None or len(rows) < FEWEST:
        return f"fewer than {FEWEST} placed poses do not tell how they are meant"
    values = numbers_of(columns)
    if values is None:
        return "not all cells are numbers"
    whole = are_orientations(values)
    if len(columns) not in (len(QUATERNION), MATRIX):
        unit = _unit(draft, columns, told)
        if unit is None:
            return "their unit is not stated (--angle)"
        values = values * float(units.to_si(1.0, unit, "angle"))
    used = rows[whole[rows]]
    if len(used) < FEWEST:
        return f"fewer than {FEWEST} of them stand at placed poses"
    turn = fitted.turns[stood_of(draft)[used]]
    tool = Rotation.from_matrix(turn @ robot.screws(draft.joints.values[used]).rotation)
    group = np.unique(np.array(draft.mounts)[used], return_inverse=True)[1]
    count = int(group.max()) + 1
    seen = np.flatnonzero(np.isin(np.flatnonzero(whole), used))
    ways = list(_ways(values[whole]))
    found = _tried(ways, [Rotation.identity()], tool, seen, group, count)
    if found[0].off > FITS:
        least = found[0].off
        found = _tried(ways, QUARTERS, tool, seen, group, count)
        if found[0].off > FITS:
            return (
                f"in no usual way are they the arm's: {np.degrees(least):.2g} deg are left at least"
            )
    best = found[0]
    other = next(each for each in found[1:] if not _same(best, each))
    off, after = best.off, other.off
    if off < COMPUTED:
        return (
            f"they follow the robot of the URDF to {np.degrees(off):.1g} deg, nearer than any "
            "instrument: as a controller shows them, not as measured"
        )
    if after < APART * off:
        return (
            f"they can be meant as {best.way} or as {other.way}: {np.degrees(off):.2g} and "
            f"{np.degrees(after):.2g} deg are left"
        )
    rotation = np.full((len(values), 3, 3), np.nan)
    rotation[whole] = best.read.as_matrix()
    headers = tuple(c.header for c in columns)
    return Orientation(headers, rotation, best.way, off, after, best.sits, best.axes.as_rotvec())


def with_orientation(
    draft: Draft, found: Orientation | str | None, fitted: Registration | None, *, registered: bool
) -> Draft:
    """The draft with quaternions beside its positions, or with why there are none."""
    if found is None:
        return draft
    if isinstance(found, str):
        left = [f"column {column.header}: {found}" for column in orientation_columns(draft.sheet)]
        return replace(draft, unused=(*left, *draft.unused))
    rotation = found.rotation
    if registered and fitted is not None:
        rotation = fitted.turns[stood_of(draft)].swapaxes(1, 2) @ rotation
    known = np.isfinite(rotation).all(axis=(1, 2))
    cells = np.full((len(rotation), 4), "", dtype=object)
    turns = np.roll(Rotation.from_matrix(rotation[known]).as_quat(), 1, axis=1)
    cells[known] = [[f"{value:.12g}" for value in turn] for turn in turns]
    written = tuple((name, tuple(cells[:, k])) for k, name in enumerate(QUATERNION))
    return replace(draft, other=(*written, *draft.other), said=(*draft.said, found.sentence()))


class _Read(NamedTuple):
    """Orientations read in one way.

    Attributes:
        off: Angle to the arm's (median) [rad].
        way: Which, in words.
        read: (P,) of the target, axes of the positions.
        sits: By how much the target is turned on the tool [rad].
        axes: Those that they are told in, against those of the positions.
    """

    off: float
    way: str
    read: Rotation
    sits: float
    axes: Rotation


def _tried(
    ways: Sequence[tuple[str, Rotation]],
    turns: Sequence[Rotation],
    tool: Rotation,
    seen: Index,
    group: Index,
    count: int,
) -> list[_Read]:
    """Every way in every axes, that which is nearest to the arm's (P,) first.

    Args:
        ways: Names, and the orientations read so.
        turns: Axes that they may be told in.
        tool: The arm's, where they stand (P,).
        seen: Which of the orientations those are.
        group, count: Which targets sit alike.
    """
    found = []
    for (way, turned), axes in product(ways, turns):
        read = axes.inv() * turned
        sits = mounting(tool, read[seen], group, count)
        off = float(np.median(((tool * sits[group]).inv() * read[seen]).magnitude()))
        found.append(_Read(off, way, read, float(sits.magnitude().max()), axes))
    return sorted(found, key=_oddness)


def _oddness(each: _Read) -> tuple[float, bool, bool, float]:
    """How far off the arm; of ways that come to the same, the usual ones first."""
    usual = any(name in each.way for name in KNOWN.values())
    return round(each.off, 7), TURNED_ROUND in each.way, not usual, each.axes.magnitude()


def _same(one: _Read, other: _Read) -> bool:
    """Do two ways differ by how the target sits on the tool at most?"""
    between = one.read.inv() * other.read
    return float((between[0].inv() * between).magnitude().max()) < SAME


def _unit(draft: Draft, columns: Sequence[Column], told: Told) -> str | None:
    """Unit of angles: that of the file, the one that was told, or that of the joints."""
    stated = {plain(column.unit) for column in columns if column.unit}
    if not stated and told.angle is not None:
        stated = {told.angle}
    if not stated:
        joints = {header.partition("[")[2].rstrip("]") for header, _ in draft.joints.written}
        stated = joints & {"deg", "rad"}
    return stated.pop() if len(stated) == 1 else None


def _ways(values: Array) -> Iterator[tuple[str, Rotation]]:
    """Every usual way to read the numbers (M, k) of an orientation, in words, and what it gives."""
    if values.shape[1] == len(QUATERNION):
        orders = {"first": (1, 2, 3, 0), "last": (0, 1, 2, 3)}
        plainly = [
            (f"quaternions, the real part {at}", Rotation.from_quat(values[:, order]))
            for at, order in orders.items()
        ]
    elif values.shape[1] == MATRIX:
        rows = Rotation.from_matrix(values.reshape(-1, 3, 3))
        yield from (("matrices, row by row", rows), ("matrices, column by column", rows.inv()))
        return
    else:
        plainly = [("rotation vectors", Rotation.from_rotvec(values))]
        for axes in map("".join, product("xyz", repeat=3)):
            if axes[0] == axes[1] or axes[1] == axes[2]:
                continue
            for moved in (True, False):
                word = "moved" if moved else "fixed"
                like = KNOWN.get(f"{axes} {word}")
                plainly.append(
                    (
                        f"angles about the {word} axes {', '.join(axes)}"
                        + (f" (as {like})" if like else ""),
                        Rotation.from_euler(axes.upper() if moved else axes, values),
                    )
                )
    yield from plainly
    yield from ((f"{way}, {TURNED_ROUND}", r.inv()) for way, r in plainly)
