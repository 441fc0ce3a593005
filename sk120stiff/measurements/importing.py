"""A calibration file of marker positions becomes `Measurements`, with what was assumed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.figaroh import (
    Told,
    joint_columns,
    loads,
    marker_columns,
    quantity,
    refuse_other_joints,
    unit_of,
)
from sk120stiff.measurements.rows import rows_of_one_pose
from sk120stiff.measurements.table import Table, read_table


@dataclass(frozen=True)
class Imported:
    """What a calibration file holds.

    Args:
        measurements: `displacement` holds positions [m], `wrench` the load less the lightest one of
            the pose, so that the lightest rows are the zero readings: write it with
            ``as_positions=True``.
        assumed: What the file does not say and was taken to be so, in sentences.
        differences: Rows with a load other than the lightest of their pose, masked rows not
            counted.
        useful_poses: Poses that have such a row and a zero reading for it.
        identifiable: What can be identified from the file, in sentences.
    """

    measurements: Measurements
    assumed: tuple[str, ...]
    differences: int
    useful_poses: int
    identifiable: str


def read_figaroh(
    path: str | os.PathLike[str],
    actuated: Sequence[str],
    *,
    prismatic: Sequence[str] = (),
    length: str | None = None,
    angle: str | None = None,
    load: str | None = None,
    wrench: ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    marker: int | None = None,
    point: ArrayLike | None = None,
) -> Imported:
    """Read marker positions ``x1,y1,z1`` and joint columns, with or without loads.

    Rows with the same joint values are one pose. At each pose the rows with the lightest load are
    the zero readings of the others; loads become differences to it.

    Args:
        path: The CSV file. Headers may carry a unit in brackets.
        actuated, prismatic: The robot's actuated joints, and those of them that slide.
        length, angle, load: Units where headers carry none; load also ``"kg"`` for a column
            ``payload``.
        wrench: (6,) what the column ``load`` counts, N and N·m, base axes.
        joints: Columns of the actuated joints in their order, where they have other names.
        marker: Which marker, where there are several.
        point: (3,) where the marker sits in the tool frame, m; its origin by default.

    Raises:
        InputError: A missing or ambiguous column, a unit that nobody said, or a cell that is no
            number.
    """
    table = read_table(Path(path))
    number, marked = marker_columns(table, marker)
    columns = joint_columns(table, actuated, joints)
    told = Told(length, angle, load)
    kinds = tuple("length" if name in prismatic else "angle" for name in actuated)
    values = []
    for name, kind in zip(columns, kinds, strict=True):
        unit = unit_of(table, name, kind, length if kind == "length" else angle)
        values.append(quantity(table, name, kind, unit))
    q = np.column_stack(values)
    positions = np.column_stack(
        [quantity(table, n, "length", unit_of(table, n, "length", length)) for n in marked]
    )
    W, load_columns, said = loads(
        table, told, None if wrench is None else np.asarray(wrench, dtype=np.float64)
    )
    use = _use(table)
    pose = table.cells["pose"] if "pose" in table.headers else rows_of_one_pose(q)
    differences, paired, offset = _pair(np.array(pose), W, use)
    assumed = [
        f"Marker {number} is measured in axes of the base frame (of a tracker turned against it "
        "the displacements would be turned too).",
        "The marker and the load sit at the origin of the tool frame."
        if point is None
        else "The load acts at the marker.",
        *said,
    ]
    units_told = [
        f"{what} in {unit}"
        for what, unit in (("lengths", length), ("joint angles", angle), ("loads", load))
        if unit is not None
    ]
    if units_told:
        assumed.append(f"Units, as told: {', '.join(units_told)}.")
    if columns != tuple(actuated):
        pairs = zip(columns, actuated, strict=True)
        assumed.append(f"Joint columns: {', '.join(f'{c} is {a}' for c, a in pairs)}.")
    if "pose" not in table.headers:
        assumed.append("Rows with the same joint values are one pose.")
    if offset:
        assumed.append(
            f"At {offset} poses the lightest load is not zero: the load of a row is its difference "
            "to the lightest of its pose."
        )
    taken = {*marked, *columns, *load_columns, "pose", "use"}
    left = [header for name, header in table.headers.items() if name not in taken]
    refuse_other_joints(table, [name for name in table.headers if name not in taken], actuated)
    if left:
        assumed.append(f"Not taken over: {', '.join(left)}.")
    measurements = Measurements(
        path=table.path,
        pose=tuple(pose),
        joint_names=tuple(actuated),
        joint_kinds=kinds,
        joints=q,
        wrench=differences,
        displacement=positions,
        point=np.zeros(3) if point is None else np.asarray(point, dtype=np.float64),
        zero="shared",
        use=use,
        line=np.array(table.lines),
        source=f"imported from {table.path.name}",
        notes=tuple(assumed),
    )
    useful = len({measurements.pose[i] for i in np.flatnonzero(paired)})
    count = int(paired.sum())
    words = _identifiable(count, useful, len(measurements.poses))
    return Imported(measurements, tuple(assumed), count, useful, words)


def _use(table: Table) -> Mask:
    if "use" not in table.headers:
        return np.ones(len(table.lines), dtype=np.bool_)
    values = table.numbers("use")
    bad = (values != 0.0) & (values != 1.0)
    if bad.any() or not values.any():
        row = int(np.argmax(bad))
        raise InputError(
            "the column use masks every row" if not bad.any() else "use is neither 1 nor 0",
            where=table.place("use", row),
            remedy="Write 0 to mask the row, 1 to use it.",
        )
    used: Mask = values == 1.0
    return used


def _pair(pose: NDArray[np.str_], W: Array, use: Mask) -> tuple[Array, Mask, int]:
    """Loads less the lightest one of their pose; rows in use that differ from it; poses shifted."""
    differences, shifted = W.copy(), 0
    for label in np.unique(pose):
        rows = np.flatnonzero(pose == label)
        among = rows[use[rows]] if use[rows].any() else rows
        force, moment = (np.linalg.norm(W[among, k : k + 3], axis=1) for k in (0, 3))
        lightest = W[among[np.lexsort((moment, force))[0]]]
        differences[rows] -= lightest
        shifted += bool(lightest.any())
    return differences, use & np.any(differences != 0.0, axis=1), shifted


def _identifiable(count: int, useful: int, poses: int) -> str:
    if count == 0:
        return (
            f"No pose of the {poses} was read under two different loads. As positions they show "
            "the geometry of the arm, and springs as far as its weight and payload bend it: "
            "'identify' and 'explain' take them so, registered in the tracker's own axes with "
            "'position: {frame: unknown}'."
        )
    text = (
        f"{count} rows at {useful} of {poses} poses differ in load from the lightest row of their "
        f"pose: {3 * count} displacements, from which springs and other elastic effects can be "
        "identified; 'identify' says which of them these poses and loads show."
    )
    if useful < poses:
        text += (
            f" The other {poses - useful} poses show stiffness through the arm's weight alone; "
            "they are left out."
        )
    return text
