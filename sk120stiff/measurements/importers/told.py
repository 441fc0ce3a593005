"""What people say of a file that the file does not say itself, and the units that come of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.clock import DateOrder
from sk120stiff.measurements.importers.contract import Column, Sheet

Mode = Literal["displacements", "load pairs", "positions"]
PRESCRIBED = "the format prescribes it"
_OPTIONS = {
    "length": ("--length", "m or mm"),
    "angle": ("--angle", "rad or deg"),
    "force": ("--load", "N; or kg for a payload"),
    "moment": ("a header such as", "mx[N*m]"),
}
_JOINT_LIKE = re.compile(
    r"(?:q|j|jnt|a|th|theta|axis|joint)[ _.-]?\d+(?:[ _.-]\w+)?|\w*joint[ _.-]?\w*", re.IGNORECASE
)
_NOT_A_VALUE = re.compile(
    r"tau|torque|effort|current|vel|speed|acc|temp|finger|gripper|hand", re.IGNORECASE
)


@dataclass(frozen=True)
class Told:
    """What was told; None stands for "nobody said".

    Args:
        length, angle: Unit of positions and sliding joints, and of turning joints.
        load: Of ``fx fy fz`` or of ``payload`` (there also kg).
        wrench: (6,) what the column ``load`` counts, N and N·m, base axes.
        point: (3,) where the marker sits in the tool frame, m.
        points: The same of several markers, by their names.
        payload_point: (3,) where the centre of the payload is in the tool frame, m.
        payloads: What hung on the tool [kg] by the name of the file or a pattern of names, of all
            files by ``""``.
        joints: A column, or a linear expression of columns, for each actuated joint.
        coverage: What stated uncertainties are multiples of; as their header says by default.
        forces: Axes of ``fx fy fz`` (``mx my mz``): ``"base"``, ``"tool"``, or ``"instrument"``,
            those in which the positions stand; base unless told.
        forces_rpy: (3,) roll, pitch, yaw of the sensor's axes in those of `forces`, rad.
        dates: Whether the day or the month comes first in dates like 10/09/2026.
    """

    length: str | None = None
    angle: str | None = None
    load: str | None = None
    wrench: Array | None = None
    point: Array | None = None
    points: Mapping[str, Array] = field(default_factory=dict)
    payload_point: Array | None = None
    payloads: Mapping[str, float] = field(default_factory=dict)
    joints: tuple[str, ...] | None = None
    coverage: float | None = None
    dates: DateOrder | None = None
    forces: Literal["base", "tool", "instrument"] | None = None
    forces_rpy: Array | None = None

    def of(self, kind: str) -> str | None:
        """The unit that was told for a kind."""
        return {"length": self.length, "angle": self.angle, "force": self.load}.get(kind)


def unit_of(sheet: Sheet, column: Column, kind: str, told: Told) -> str:
    """The unit of a column: that of the file, or the one that was told.

    Raises:
        InputError: Neither is there, or they differ.
    """
    said = told.of(kind)
    option, offered = _OPTIONS[kind]
    if column.unit == "SI":
        return units.KINDS[kind][0][0]
    if column.stated == PRESCRIBED and said is None:
        turns = kind == "length" and column.unit == "deg"  # a joint that slides
        return "mm" if turns else str(column.unit)
    written = None if column.stated == PRESCRIBED else column.unit
    if written is None and said is None:
        instead = column.stated.rpartition(": ")[2]  # what stands where its unit should
        raise InputError(
            f"the unit {instead} of the column {column.header!r} is not known"
            if instead
            else f"nobody said in which unit the column {column.header!r} is",
            where=sheet.place(column),
            remedy=f"Write one that is known there, or give {option} {offered} if no other column "
            "of this kind has a unit."
            if instead
            else f"Give {option} {offered}; no unit is guessed.",
        )
    if written is not None and said is not None and plain(written) != said:
        raise InputError(
            f"the file says {written} ({column.stated}), {option} says {said}",
            where=sheet.place(column),
            remedy=f"Leave {option} out where the file carries its unit.",
        )
    return plain(str(written or said))


def two_units(sheet: Sheet, one: Column, other: Column) -> InputError:
    """What is wrong with two columns that belong together."""
    return InputError(
        f"{one.header} and {other.header} have different units",
        where=str(sheet.path),
        remedy="Export both in one unit.",
    )


def plain(unit: str) -> str:
    """A unit as the headers here write it."""
    return {"°": "deg", "µm": "um", "μm": "um"}.get(unit, unit)


def numbers(sheet: Sheet, column: Column, *, unread: bool = False) -> Array:
    """(N,) as they stand there, times the factor of the column; NaN where `unread` cells are empty.

    Raises:
        InputError: A cell that is no finite number.
    """
    values = np.zeros(len(column.cells))
    for row, cell in enumerate(column.cells):
        if unread and not cell:
            values[row] = np.nan
            continue
        try:
            values[row] = float(cell)
        except ValueError:
            values[row] = np.nan
        if not np.isfinite(values[row]) or "_" in cell:
            raise InputError(
                f"{cell!r} is no number",
                where=sheet.place(column, row),
                remedy="Write a number, or leave the cell empty: "
                + ("that axis then counts as not read." if unread else "the row is then left out."),
            )
    return values * column.factor


def quantity(sheet: Sheet, column: Column, kind: str, unit: str, *, unread: bool = False) -> Array:
    """(N,) in SI; NaN where `unread` cells are empty."""
    values = numbers(sheet, column, unread=unread)
    read = np.isfinite(values)
    values[read] = units.to_si(values[read], unit, kind, where=sheet.place(column))
    return values


def texts(column: Column) -> tuple[str, ...]:
    """The cells as they are written again: digit by digit, unless a factor counts."""
    if column.factor == 1.0:
        return tuple(cell.removeprefix("+") for cell in column.cells)
    return tuple(repr(float(cell) * column.factor) for cell in column.cells)


def negated(cell: str) -> str:
    """The number of a cell with the other sign, digit by digit."""
    if not float(cell):
        return cell
    return cell[1:] if cell.startswith("-") else f"-{cell}"


def refuse_other_joints(sheet: Sheet, left: list[Column], actuated: tuple[str, ...]) -> None:
    """Refuse a file with columns that look like joints which the robot does not have.

    Raises:
        InputError: Such a column is there.
    """
    others = [
        c.header for c in left
        if _JOINT_LIKE.fullmatch(c.header) and not _NOT_A_VALUE.search(c.header)
    ]  # fmt: skip
    if others:
        raise InputError(
            f"{', '.join(others)}: joints by their names, which the robot does not have",
            where=str(sheet.path),
            remedy=f"The actuated joints are {', '.join(actuated)}. Give the robot that was "
            "measured, name the columns of its joints with --joints, or rename columns that are "
            "no joint values.",
        )
