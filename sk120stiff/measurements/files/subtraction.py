"""The displacement of each row: as written, or its position minus the zero reading of its pose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Zero
from sk120stiff.measurements.poses import SAME_JOINT
from sk120stiff.measurements.table.columns import POSITIONS, ZEROS, Roles
from sk120stiff.measurements.table.rows import Rows, counts
from sk120stiff.measurements.table.table import Table
from sk120stiff.measurements.zero import find_zero_readings, group_by_run


@dataclass(frozen=True)
class Displacements:
    """Displacements of the K rows that have one, and the zero readings they subtract.

    The fields are those of `Measurements`; `rows` (K,) says which of the file's rows they are,
    `notes` what was decided.
    """

    rows: Integers
    displacement: Array | None
    zero: Zero
    group: Integers
    count: Integers
    order: Array | None
    time: Array | None
    use: Mask
    notes: tuple[str, ...]
    zero_joints: Array | None = None


def displacements(table: Table, roles: Roles, rows: Rows, zero: Zero) -> Displacements:
    """Read them off, or subtract the zero readings where positions are given.

    Raises:
        InputError: A pose without a zero reading, no loaded row, or a zero column that does not
            fit.
    """
    if roles.measured == POSITIONS:
        return _from_positions(table, roles, rows, zero)
    return _as_written(table, roles, rows, zero)


def _as_written(table: Table, roles: Roles, rows: Rows, zero: Zero) -> Displacements:
    found = as_written(rows, zero)
    told: dict[str, Any] = {}
    if "zero_group" in roles.has:
        told["group"] = counts(table, "zero_group", 0)
    if "zero_count" in roles.has:
        told["count"] = counts(table, "zero_count", 1).astype(np.int64)
    if "zero_order" in roles.has:
        told["order"] = table.numbers("zero_order", allow_blank=True)
    if "zero_time" in roles.has:
        told["time"] = table.quantity("zero_time", "time", allow_blank=True)
    return replace(found, **told)


def as_written(rows: Rows, zero: Zero) -> Displacements:
    """Displacements as rows state them, of whose zero readings no column tells anything."""
    count = len(rows.pose)
    order = time = None
    if zero != "separate":
        order, time = (_mean_without_load(rows, when) for when in (rows.order, rows.time))
    use, notes = rows.use, []
    if rows.measured is not None:
        # Such a row is the zero reading minus itself: exact by construction, so it tells nothing,
        # and a fit would take it for a reading without noise.
        largest = np.nanmax(np.abs(rows.measured), axis=1, initial=-1.0)  # -1: nothing was read
        empty = use & ~rows.loaded & (largest == 0.0)
        if empty.any() and not empty[use].all():
            use = use & ~empty
            notes.append(
                f"{int(empty.sum())} rows without load and with a displacement of exactly zero "
                "are zero readings minus themselves; they are masked."
            )
    if zero == "unknown" and rows.measured is not None:
        notes.append("Nobody said whether the rows of a pose share a zero reading.")
    return Displacements(
        rows=np.arange(count),
        displacement=rows.measured,
        zero=zero,
        group=np.arange(count) if zero == "separate" else rows.pose_index,
        count=np.ones(count, dtype=np.int64),
        order=order,
        time=time,
        use=use,
        notes=tuple(notes),
    )


def undisplaced(rows: Rows, filled: Mask) -> Displacements:
    """Rows of where a marker stands: nothing is subtracted; those without a reading are masked.

    Where no row has one they are a plan.
    """
    count = len(rows.pose)
    idle = int((rows.use & ~filled).sum())
    notes = (f"{idle} rows hold no reading; they are masked.",) if idle else ()
    if not filled.any():
        filled, notes = np.ones_like(filled), ("No row holds a reading: these are poses to go to.",)
    return Displacements(
        rows=np.arange(count),
        displacement=None,
        zero="separate",
        group=np.arange(count),
        count=np.ones(count, dtype=np.int64),
        order=None,
        time=None,
        use=rows.use & filled,
        notes=notes,
    )


def _mean_without_load(rows: Rows, when: Array | None) -> Array | None:
    """Mean order or time of the rows without load of each row's pose; None where there is none."""
    if when is None or rows.loaded.all():
        return None
    return find_zero_readings(rows.pose_index, rows.loaded, rows.use).mean(when)


def _from_positions(table: Table, roles: Roles, rows: Rows, zero: Zero) -> Displacements:
    for name in ZEROS[1:]:
        if name in roles.has:
            raise InputError(
                f"the column {name!r} belongs to displacements, not to positions",
                where=table.place(name),
                remedy="Leave it out: rows without load say it.",
            )
    if rows.measured is None:
        raise ValueError("positions are missing")
    if "zero_group" in roles.has:
        group = _given_groups(table, rows)
    elif zero == "separate":
        group = group_by_run(rows.pose_index, rows.loaded, rows.use, rows.clock)
    else:
        group = rows.pose_index
    axes = np.isfinite(rows.measured).sum(axis=1)
    copies = _copied_zeros(rows, group)
    found = find_zero_readings(group, rows.loaded, rows.use & ~copies, axes)
    orphans = np.flatnonzero(rows.loaded & (found.count == 0))
    if orphans.size:
        first = int(orphans[0])
        raise InputError(
            f"the pose {rows.pose[first]!r} has no row without load to subtract",
            where=table.place("x", first),
            remedy="Add a row with fx = fy = fz = 0 for this pose; its x y z are the zero reading. "
            "If the columns hold displacements already, name them dx dy dz.",
        )
    kept = np.flatnonzero(rows.loaded)
    used = found.count[kept]
    notes = [
        f"{int(found.counted.sum())} rows without load are the zero readings of the "
        f"{kept.size} loaded rows, each the mean of {_span(used)}."
    ]
    if copies.any():
        notes.append(
            f"{int(copies.sum())} rows without load repeat others of their pose to the last digit: "
            "a zero reading that was written down again counts once."
        )
    lesser = find_zero_readings(group, rows.loaded, rows.use & ~copies).counted & ~found.counted
    if lesser.any():
        notes.append(
            f"{int(lesser.sum())} rows without load lack an axis that others of their pose have; "
            "they are left out."
        )
    idle = [p for p in dict.fromkeys(rows.pose) if p not in {rows.pose[i] for i in kept}]
    if idle:
        notes.append(f"Without a loaded row, and so without effect: pose {', '.join(idle)}.")
    if not rows.use[kept].any():
        raise InputError(
            "every loaded row is masked",
            where=table.place("use"),
            remedy="Write 1 in the rows to be used.",
        )
    return Displacements(
        rows=kept,
        displacement=(rows.measured - found.mean(rows.measured))[kept],
        zero="shared",
        group=np.unique(group[kept], return_inverse=True)[1],
        count=used,
        order=None if rows.order is None else found.mean(rows.order)[kept],
        time=None if rows.time is None else found.mean(rows.time)[kept],
        use=rows.use[kept],
        notes=tuple(notes),
        zero_joints=found.mean(rows.joints)[kept] if jitter(rows) > SAME_JOINT else None,
    )


def _copied_zeros(rows: Rows, group: Integers) -> Mask:
    """(N,) rows without load that repeat one of their zero reading to the last digit.

    Sheets with columns for both write the unloaded position beside every load. Rows that the file
    itself tells apart, by order, time or repeat, are readings of their own.
    """
    copied = np.zeros(len(rows.pose), dtype=bool)
    if rows.measured is None or any(x is not None for x in (rows.order, rows.time, rows.repeat)):
        return copied
    known: set[tuple[int, bytes]] = set()
    for row in np.flatnonzero(~rows.loaded & rows.use & np.isfinite(rows.measured).all(axis=1)):
        key = int(group[row]), rows.measured[row].tobytes()
        copied[row] = key in known
        known.add(key)
    return copied


def jitter(rows: Rows) -> float:
    """Largest difference of a joint value from the first one of its pose [rad or m]."""
    _, first = np.unique(rows.pose_index, return_index=True)
    return float(np.abs(rows.joints - rows.joints[first][rows.pose_index]).max(initial=0.0))


def _given_groups(table: Table, rows: Rows) -> Integers:
    _, first, group = np.unique(
        counts(table, "zero_group", 0), return_index=True, return_inverse=True
    )
    crossing = np.flatnonzero(rows.pose_index != rows.pose_index[first][group])
    if crossing.size:
        row = int(crossing[0])
        raise InputError(
            f"the zero group {table.cells['zero_group'][row]} joins the poses "
            f"{rows.pose[first[group[row]]]!r} and {rows.pose[row]!r}",
            where=table.place("zero_group", row),
            remedy="A zero reading belongs to one pose.",
        )
    return group


def _span(counts_used: Integers) -> str:
    low, high = int(counts_used.min()), int(counts_used.max())
    return f"{low}" if low == high else f"{low} to {high}"
