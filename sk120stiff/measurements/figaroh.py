"""Columns of calibration files as FIGAROH writes them: ``x1,y1,z1``, joint names, no units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.columns import FORCES, MOMENTS
from sk120stiff.measurements.table import Table

STANDARD_GRAVITY = 9.80665  # m/s², exact by definition
_AXES = ("x", "y", "z")
_MARKER = re.compile(r"(?:phi)?[xyz]([1-9]\d*)")
_OPTIONS = {
    "length": ("--length", "m or mm"),
    "angle": ("--angle", "rad or deg"),
    "load": ("--load", "N; or kg for a payload"),
    "moment": ("a header such as", "mx[N*m]"),
}


@dataclass(frozen=True)
class Told:
    """Units that the file itself does not give; None stands for "nobody said".

    Args:
        length, angle: Of marker coordinates and sliding joints, and of turning joints.
        load: Of ``fx fy fz`` or of ``payload`` (there also kg).
    """

    length: str | None = None
    angle: str | None = None
    load: str | None = None


def unit_of(table: Table, name: str, kind: str, told: str | None) -> str:
    """The unit of a column: that of its header, or the one that was told.

    Raises:
        InputError: Neither is there, or they differ.
    """
    written = table.column_units[name]
    option, offered = _OPTIONS[kind]
    if written is None and told is None:
        raise InputError(
            f"nobody said in which unit the column {name!r} is",
            where=table.place(name),
            remedy=f"Give {option} {offered}; no unit is guessed.",
        )
    if written is not None and told is not None and written != told:
        raise InputError(
            f"the header says {written}, {option} says {told}",
            where=table.place(name),
            remedy=f"Leave {option} out where headers carry their unit.",
        )
    return str(written or told)


def quantity(table: Table, name: str, kind: str, unit: str) -> Array:
    """A column (N,) in SI."""
    return units.to_si(table.numbers(name), unit, kind, where=table.place(name))


def marker_columns(table: Table, marker: int | None) -> tuple[int, tuple[str, ...]]:
    """The number of the marker and its three columns.

    Raises:
        InputError: No marker, an incomplete one, or several and nobody chose.
    """
    found = sorted({int(m[1]) for name in table.headers if (m := _MARKER.fullmatch(name))})
    header = f"{table.path}, line {table.header_line}"
    if not found:
        raise InputError(
            "no marker is in this file",
            where=header,
            remedy="Its position stands in the columns x1, y1, z1. "
            f"There are {', '.join(table.headers)}.",
        )
    listed = ", ".join(map(str, found))
    if marker is None and len(found) > 1:
        raise InputError(
            f"this file has the markers {listed}",
            where=header,
            remedy=f"Choose one: --marker {found[0]}. Its point is where the load acts.",
        )
    chosen = found[0] if marker is None else marker
    if chosen not in found:
        raise InputError(
            f"this file has no marker {chosen}", where=header, remedy=f"There is {listed}."
        )
    names = tuple(f"{axis}{chosen}" for axis in _AXES)
    for name in names:
        if name not in table.headers:
            raise InputError(
                f"the column {name!r} is missing",
                where=header,
                remedy=f"A marker has three columns: {', '.join(names)}.",
            )
    return chosen, names


def joint_columns(
    table: Table, actuated: Sequence[str], joints: Sequence[str] | None
) -> tuple[str, ...]:
    """The column of each actuated joint: its own name, or q1 .. qn, or as told in `joints`.

    Raises:
        InputError: A joint has no column, or `joints` names another number of columns or unknown
            ones.
    """
    header = f"{table.path}, line {table.header_line}"
    listed = f"The actuated joints are {', '.join(actuated)}."
    if joints is not None:
        columns = tuple(joints)
        if len(columns) != len(actuated) or len(set(columns)) != len(columns):
            raise InputError(
                f"{len(set(columns))} columns for {len(actuated)} joints",
                where="--joints",
                remedy=f"Name one column for each joint, in their order. {listed}",
            )
    elif any(name in table.headers for name in actuated):
        columns = tuple(actuated)
    else:
        columns = tuple(f"q{k}" for k in range(1, len(actuated) + 1))
        if columns[0] not in table.headers:
            columns = tuple(actuated)
    for column, joint in zip(columns, actuated, strict=True):
        if column not in table.headers:
            close = get_close_matches(column, table.headers, n=1)
            meant = f" (is it {close[0]!r}?)" if close else ""
            raise InputError(
                f"the joint {joint!r} has no column {column!r}{meant}",
                where=header,
                remedy="Name the columns as the joints, or q1, q2, ..., or give their names with "
                f"--joints. {listed}",
            )
    return columns


_JOINT_LIKE = re.compile(
    r"(?:q|j|jnt|a|th|theta|axis|joint)[ _.-]?\d+(?:[ _.-]\w+)?|\w*joint[ _.-]?\w*", re.IGNORECASE
)
_NOT_A_VALUE = re.compile(
    r"tau|torque|effort|current|vel|speed|acc|temp|finger|gripper|hand", re.IGNORECASE
)


def refuse_other_joints(table: Table, left: Sequence[str], actuated: Sequence[str]) -> None:
    """Refuse a file with columns that look like joints which the robot does not have.

    Args:
        table: The file.
        left: Names of the columns that nobody took.
        actuated: The robot's joints.

    Raises:
        InputError: Such a column is there.
    """
    others = [
        name for name in left if _JOINT_LIKE.fullmatch(name) and not _NOT_A_VALUE.search(name)
    ]
    if others:
        raise InputError(
            f"{', '.join(others)}: joints by their names, which the robot does not have",
            where=f"{table.path}, line {table.header_line}",
            remedy=f"The actuated joints are {', '.join(actuated)}. Give the robot that was "
            "measured, name the columns of its joints with --joints, or rename columns that are "
            "no joint values.",
        )


def loads(
    table: Table, told: Told, wrench: Array | None
) -> tuple[Array, tuple[str, ...], list[str]]:
    """Wrench (N, 6) [N, N·m] of each row, the columns it is from, and what was assumed.

    Forces ``fx fy fz`` (``mx my mz``), or ``payload`` that hangs down, or ``load`` that counts how
    many times the given `wrench` (6,) acts. Without any of them there is no load.

    Raises:
        InputError: Two of the three, an incomplete one, a unit that nobody said, or a `wrench` for
            nothing.
    """
    header = f"{table.path}, line {table.header_line}"
    there = [
        kind
        for kind, names in (
            ("force columns", (*FORCES, *MOMENTS)), ("payload", ("payload",)), ("load", ("load",)),
        )
        if any(name in table.headers for name in names)
    ]  # fmt: skip
    if len(there) > 1:
        raise InputError(
            f"the load is given twice: {' and '.join(there)}",
            where=header,
            remedy="Keep one of them.",
        )
    if wrench is not None and there != ["load"]:
        raise InputError(
            "--wrench says how large the load is, but no column says in which rows it acts",
            where=header,
            remedy="Add a column load: 1 in rows with the load, 0 in rows without.",
        )
    W = np.zeros((len(table.lines), 6))
    if not there:
        return W, (), ["No column holds a load: all rows are taken to be without."]
    if there == ["load"]:
        if wrench is None:
            raise InputError(
                "nobody said which load the column 'load' counts",
                where=table.place("load"),
                remedy="Give --wrench, e.g. --wrench '0,0,-490 N'.",
            )
        W += table.numbers("load")[:, None] * wrench
        return W, ("load",), ["The column load counts how many times --wrench acts."]
    if there == ["payload"]:
        unit = unit_of(table, "payload", "load", told.load)
        weight = (
            STANDARD_GRAVITY * table.numbers("payload")
            if unit == "kg"
            else quantity(table, "payload", "force", unit)
        )
        if np.any(weight < 0.0):
            row = int(np.argmax(weight < 0.0))
            raise InputError(
                "a payload is not negative",
                where=table.place("payload", row),
                remedy="Write what hangs on the robot; its weight pulls along -z of the base.",
            )
        W[:, 2] = -weight
        said = "The payload is taken to hang at the marker and to pull along -z of the base frame."
        return W, ("payload",), [said]
    names = [name for name in (*FORCES, *MOMENTS) if name in table.headers]
    for group in (FORCES, MOMENTS):
        missing = [name for name in group if name not in names]
        if missing and (group == FORCES or len(missing) < 3):
            raise InputError(
                f"the column {missing[0]!r} is missing",
                where=header,
                remedy=f"{', '.join(group)} come together.",
            )
    for name in names:
        kind = "force" if name in FORCES else "moment"
        unit = (
            unit_of(table, name, "load", told.load)
            if kind == "force"
            else unit_of(table, name, "moment", None)
        )
        W[:, (*FORCES, *MOMENTS).index(name)] = quantity(table, name, kind, unit)
    said = "Forces are taken to act on the robot at the marker, in axes of the base frame."
    return W, tuple(names), [said]
