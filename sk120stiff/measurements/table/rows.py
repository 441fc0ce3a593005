"""What the cells of known columns mean: labels, flags, branches, counts, loads, uncertainties."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Integers, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.poses import SAME_JOINT
from sk120stiff.measurements.table.columns import FORCES, MOMENTS, UNCERTAINTIES, Roles
from sk120stiff.measurements.table.joint_map import mapped_joints
from sk120stiff.measurements.table.table import Table

SMALLEST_SIGMA = 1e-15  # m; its inverse square still is a number to compute with
_FLAGS = {"1": True, "0": False, "true": True, "false": False, "1.0": True, "0.0": False}


@dataclass(frozen=True)
class Rows:
    """All N rows of a file in SI, before any zero reading is subtracted.

    Args:
        pose: N labels; `pose_index` (N,) numbers them in the order of their first row.
        joints: (N, n) rad or m.
        wrench: (N, 6) N and N·m; `loaded` (N,) is True where any component is not zero.
        measured: (N, 3) displacements or positions, m, NaN where blank; None in a plan.
        sigma: (N, 3) m, NaN where blank, or None.
        order, time, branch, repeat: (N,) or None.
        use: (N,) False where masked.
    """

    pose: tuple[str, ...]
    pose_index: Integers
    joints: Array
    wrench: Array
    loaded: Mask
    measured: Array | None
    sigma: Array | None
    order: Array | None
    time: Array | None
    branch: tuple[str, ...] | None
    repeat: Integers | None
    use: Mask

    @property
    def clock(self) -> Array:
        """(N,) order or time of the rows; where neither is there, as they stand in the file."""
        known = next((c for c in (self.order, self.time) if c is not None), None)
        return np.arange(float(len(self.pose))) if known is None else known


def read_rows(
    table: Table, roles: Roles, mapping: Mapping[str, str | float], place: str
) -> tuple[Rows, dict[str, str], tuple[str, ...]]:
    """Turn cells into numbers; joints as `mapping` makes them of columns, their kinds, and the
    columns that only feed others.

    Raises:
        InputError: A cell that its column cannot hold, with line and column.
    """
    count = len(table.lines)
    kinds, joints, spare = mapped_joints(table, roles.joints, mapping, place)
    pose = _labels(table) if "pose" in roles.has else rows_of_one_pose(joints)
    position = {label: k for k, label in enumerate(dict.fromkeys(pose))}
    wrench = np.zeros((count, 6))
    if FORCES[0] in roles.has:
        wrench[:, :3] = table.quantities(FORCES, "force")
    if MOMENTS[0] in roles.has:
        wrench[:, 3:] = table.quantities(MOMENTS, "moment")
    loaded = np.any(wrench != 0.0, axis=1)
    measured = None
    if roles.measured:
        measured = table.quantities(roles.measured, "length", allow_blank=True)  # not read
    rows = Rows(
        pose=pose,
        pose_index=np.array([position[label] for label in pose], dtype=np.int64),
        joints=joints,
        wrench=wrench,
        loaded=loaded,
        measured=measured,
        sigma=_uncertainties(table) if UNCERTAINTIES[0] in roles.has else None,
        order=table.numbers("order") if "order" in roles.has else None,
        time=table.quantity("time", "time") if "time" in roles.has else None,
        branch=_branches(table, loaded) if "branch" in roles.has else None,
        repeat=counts(table, "repeat", 0) if "repeat" in roles.has else None,
        use=_flags(table) if "use" in roles.has else np.ones(count, dtype=np.bool_),
    )
    return rows, kinds, spare


def rows_of_one_pose(joints: Array) -> tuple[str, ...]:
    """P1, P2, ... in the order in which sets of joint values first appear."""
    firsts: dict[bytes, str] = {}
    same = np.round(joints / SAME_JOINT).astype(np.int64)
    return tuple(firsts.setdefault(row.tobytes(), f"P{len(firsts) + 1}") for row in same)


def counts(table: Table, name: str, least: int) -> Integers:
    """A column (N,) of whole numbers that are at least `least`."""
    values = table.numbers(name)
    bad = (values != np.round(values)) | (values < least) | (values > 2**53)
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        raise InputError(
            f"{table.cells[name][row]!r} is not a whole number from {least} up",
            where=table.place(name, row),
            remedy="Count in whole numbers.",
        )
    return values.astype(np.int64)


def _labels(table: Table) -> tuple[str, ...]:
    for row, label in enumerate(table.cells["pose"]):
        if not label or label.startswith("#"):
            raise InputError(
                "the pose label is empty" if not label else f"{label!r} reads as a comment",
                where=table.place("pose", row),
                remedy="Give every row a label; rows of one pose have the same.",
            )
    return table.cells["pose"]


def _flags(table: Table) -> Mask:
    values = []
    for row, cell in enumerate(table.cells["use"]):
        if cell.lower() not in _FLAGS:
            raise InputError(
                f"{cell!r} is neither 1 nor 0",
                where=table.place("use", row),
                remedy="Write 0 to mask the row, 1 to use it.",
            )
        values.append(_FLAGS[cell.lower()])
    use = np.array(values, dtype=np.bool_)
    if not use.any():
        raise InputError(
            "every row is masked",
            where=table.place("use"),
            remedy="Write 1 in the rows to be used.",
        )
    return use


def _branches(table: Table, loaded: Mask) -> tuple[str, ...]:
    for row, cell in enumerate(table.cells["branch"]):
        if cell not in ("load", "unload") and not (cell == "" and not loaded[row]):
            raise InputError(
                f"{cell!r} is neither load nor unload",
                where=table.place("branch", row),
                remedy="Write load while the force grows, unload while it shrinks.",
            )
    return table.cells["branch"]


def _uncertainties(table: Table) -> Array:
    values = table.quantities(UNCERTAINTIES, "length", allow_blank=True)
    if np.any(values < SMALLEST_SIGMA):
        row, column = (int(k) for k in np.argwhere(values < SMALLEST_SIGMA)[0])
        name = UNCERTAINTIES[column]
        raise InputError(
            f"a standard uncertainty of {table.cells[name][row]} is not positive"
            + (f" (below {SMALLEST_SIGMA:g} m)" if values[row, column] > 0.0 else ""),
            where=table.place(name, row),
            remedy="Write the standard uncertainty of the reading, or leave the three columns out.",
        )
    return values
