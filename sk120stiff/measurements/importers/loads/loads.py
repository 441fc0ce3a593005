"""What pressed on the robot in each row: forces, a payload, or a count of a load."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sk120stiff import units
from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.compound_groups import groups_of, shown
from sk120stiff.measurements.importers.columns.compound_headers import of_a_sensor
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.told import Told, numbers, quantity, unit_of
from sk120stiff.measurements.poses import rows_by_label
from sk120stiff.measurements.table.columns import DISPLACEMENTS, FORCES, MOMENTS
from sk120stiff.robot import STANDARD_GRAVITY


@dataclass(frozen=True, eq=False)
class Loads:
    """Wrench (N, 6) [N, N·m], payload (N,) [kg] if it was one, columns it is from, its axes, and
    what was taken for granted.

    The payload is in the wrench too: its weight along -z of the base.
    """

    wrench: Array
    payload: Array | None = None
    taken: tuple[Column, ...] = ()
    frame: Literal["base", "tool", "instrument"] = "base"
    said: str = "No column holds a load: all rows are taken to be without."


def loads_of(sheet: Sheet, told: Told) -> Loads:
    """Forces ``fx fy fz`` (``mx my mz``), or ``payload`` that hangs down, or ``load`` that counts
    how many times `told.wrench` acts. Without any of them there is no load.

    A component of forces that has no column is zero, which is said; of moments in the same way.

    Raises:
        InputError: Two of the three, a force without its axis beside displacements, moments without
            forces, a component that may stand in a column of another name, a unit that nobody said,
            a sensor's own axes that nobody told, or told against no frame, or a wrench or a
            payload's place for nothing.
    """
    where = str(sheet.path)
    there = [
        kind
        for kind, names in (
            ("force columns", (*FORCES, *MOMENTS)), ("payload", ("payload",)), ("load", ("load",)),
        )
        if sheet.those(*names)
    ]  # fmt: skip
    if told.forces_rpy is not None and told.forces not in ("base", "tool"):
        raise InputError(
            "a sensor's axes are turned against those of the tool or of the base, and nobody said "
            "against which",
            where="--forces-rpy",
            remedy="Give --forces tool (or --forces base) with it.",
        )
    if len(there) > 1:
        raise InputError(
            f"the load is given twice: {' and '.join(there)}",
            where=where,
            remedy="Keep one of them.",
        )
    if told.wrench is not None and there != ["load"]:
        raise InputError(
            "--wrench says how large the load is, but no column says in which rows it acts",
            where=where,
            remedy="Add a column load: 1 in rows with the load, 0 in rows without.",
        )
    if told.forces is not None and there != ["force columns"]:
        raise InputError(
            "--forces says in which axes forces are, and no column fx, fy, fz holds any",
            where=where,
            remedy="Leave it out: a payload and --wrench are in axes of the base frame.",
        )
    if told.payload_point is not None and there != ["payload"]:
        raise InputError(
            "--payload-point says where the payload hangs, and nothing says that one does",
            where=where,
            remedy="Add a column payload[kg], or give --payload '5 kg'; where a force acts is what "
            "force.point in the YAML file says.",
        )
    W = np.zeros((len(sheet.lines), 6))
    counted, hung = sheet.get("load"), sheet.get("payload")
    if counted is not None:
        if told.wrench is None:
            raise InputError(
                "nobody said which load the column 'load' counts",
                where=sheet.place(counted),
                remedy="Give --wrench, e.g. --wrench '0,0,-490 N'.",
            )
        W += numbers(sheet, counted)[:, None] * told.wrench
        said = "The column load counts how many times --wrench acts."
        return Loads(W, None, (counted,), said=said)
    if hung is not None:
        return _hung(sheet, hung, told, W)
    if not there:
        _refuse_several_forces(sheet)
        _refuse_a_force_along_nothing(sheet)
    return _forces(sheet, told, W) if there else Loads(W)


def _refuse_several_forces(sheet: Sheet) -> None:
    """Forces of several origins, as those of two sensors: which of them acts cannot be told.

    Raises:
        InputError: There are such.
    """
    headers = [c.header for c in sheet.spare]
    groups = [group for group in groups_of(headers) if group.family == "load"]
    if len(groups) > 1:
        raise InputError(
            f"{listed(shown(groups, headers), 'or')} may be the load",
            where=str(sheet.path),
            remedy="Call those that act on the robot fx[N], fy[N], fz[N] (mx[N*m], my, mz), or "
            "take the others out.",
        )


def _refuse_a_force_along_nothing(sheet: Sheet) -> None:
    """Displacements come of a load: a column in a unit of force is one, along an axis unknown.

    Raises:
        InputError: Such a column stands beside displacements.
    """
    for column in sheet.spare if sheet.those(*DISPLACEMENTS, "gauge") else ():
        if column.unit and units.is_kind(column.unit, "force"):
            raise InputError(
                f"nothing says along which axis {column.header!r} acts",
                where=sheet.place(column),
                remedy=_towards(sheet)
                or f"Call it fx, fy or fz[{column.unit}] (axes of the base; a weight is a negative "
                "fz), or add a column direction (-Z, +X and so on) or a unit vector in columns ex, "
                "ey, ez, in axes of the base; if it is no load, take it out.",
            )


_ANCHOR = re.compile(
    r"(?:rope |seil )?(?:anchor|anker|ankerpunkt|festpunkt|fixpunkt|pulley|rolle|umlenkrolle|hook|"
    r"haken|eye|rope|seil)(?: ?(?:point|pos(?:ition)?|punkt))?[ _.]?[xyz]",
    re.IGNORECASE,
)


def _towards(sheet: Sheet) -> str:
    """What to do where columns hold the point that a rope pulls to; empty where none do."""
    names = [c.header for c in sheet.spare if _ANCHOR.fullmatch(unit_of_header(c.header)[0])]
    if len(names) < 3:
        return ""
    return (
        f"{listed(names)} look like the point that a rope pulls to. Write the direction instead, a "
        "unit vector in columns ex, ey, ez in axes of the base: (anchor - p) / |anchor - p|, where "
        "p is the point at which the rope holds the arm at that pose."
    )


def _hung(sheet: Sheet, column: Column, told: Told, W: Array) -> Loads:
    unit = unit_of(sheet, column, "force", told)
    if unit == "kg":
        mass = numbers(sheet, column)
    else:
        mass = quantity(sheet, column, "force", unit) / STANDARD_GRAVITY
    if np.any(mass < 0.0):
        raise InputError(
            "a payload is not negative",
            where=sheet.place(column, int(np.argmax(mass < 0.0))),
            remedy="Write what hangs on the robot; its weight pulls along -z of the base.",
        )
    W[:, 2] = -STANDARD_GRAVITY * mass
    said = "The payload is taken to pull along -z of the base frame."
    return Loads(W, mass, (column,), said=said)


def _forces(sheet: Sheet, told: Told, W: Array) -> Loads:
    if not sheet.those(*FORCES):
        raise InputError(
            "there are moments, and no column fx, fy, fz holds a force",
            where=str(sheet.path),
            remedy="Add the forces: fx, fy, fz; with zeros where none acted.",
        )
    groups = [FORCES, MOMENTS] if sheet.those(*MOMENTS) else [FORCES]
    missing = [name for group in groups for name in group if sheet.get(name) is None]
    if missing:
        _refuse_a_force_by_another_name(sheet, missing)
    taken = []
    for k, name in enumerate((*FORCES, *MOMENTS)):
        column, kind = sheet.get(name), "force" if k < len(FORCES) else "moment"
        if column is not None:
            W[:, k] = quantity(sheet, column, kind, unit_of(sheet, column, kind, told))
            taken.append(column)
    if told.forces is None:
        _refuse_a_sensor_without_axes(sheet, taken)
    said = {
        "base": "Forces are taken to act on the robot, in axes of the base frame; of those of a "
        "sensor on the tool say --forces tool.",
        "tool": "Forces are taken to act on the robot, in axes of the tool frame.",
        "instrument": "Forces are taken to act on the robot, in the axes in which positions stand.",
    }
    frame = told.forces or "base"
    if told.forces_rpy is not None:
        turn = ", ".join(f"{v:g}" for v in np.degrees(told.forces_rpy))
        said[frame] = (
            "Forces are taken to act on the robot, in axes of a sensor that are turned by roll, "
            f"pitch, yaw {turn} deg in the {frame} frame."
        )
    zero = f" Of {listed(missing)} there is no column: taken as zero." if missing else ""
    return Loads(W, None, tuple(taken), frame, said[frame] + zero)


def _refuse_a_sensor_without_axes(sheet: Sheet, taken: list[Column]) -> None:
    """A sensor reads in axes of its own, which turn with the tool that carries it.

    Raises:
        InputError: A header names one.
    """
    read = [c for c in taken if of_a_sensor(c.header)]
    if read:
        raise InputError(
            f"{listed([c.header for c in read])} are called as those of a sensor or of the tool, "
            "and nobody said in which axes they are",
            where=str(read[0].file or sheet.path),
            remedy="Give --forces tool if they are in axes of the tool frame, as a sensor on the "
            "tool reads; --forces base if the controller turned them into those of the base; "
            "--forces instrument if they are in those in which positions stand; --forces tool "
            "--forces-rpy '0,0,45 deg' of a sensor that is screwed on turned.",
        )


def _refuse_a_force_by_another_name(sheet: Sheet, missing: list[str]) -> None:
    """A column that is not understood may be the missing one: if it is in a unit of force or
    moment; and, where one of three alone is missing, if it holds numbers without a unit.

    Raises:
        InputError: There is such a column.
    """
    one = any(len(set(missing) & set(group)) == 1 for group in (FORCES, MOMENTS))
    known = [c for c in sheet.spare if c.unit]
    may_be = [c for c in known if any(units.is_kind(str(c.unit), k) for k in ("force", "moment"))]
    if one:
        may_be += [c for c in sheet.spare if not c.unit and all(map(is_number, c.cells))]
    if may_be:
        raise InputError(
            f"of the load {listed(missing)} {'has' if len(missing) == 1 else 'have'} no column, "
            f"and what {listed([repr(c.header) for c in may_be])} "
            f"{'is' if len(may_be) == 1 else 'are'} is not known",
            where=str(may_be[0].file or sheet.path),
            remedy=f"Call the column {missing[0]}[{may_be[0].unit or 'N'}] if it is there; else "
            "take out what is not known: a component without a column is taken as zero.",
        )


def lightest(pose: tuple[str, ...], W: Array, use: Mask) -> tuple[Array, Mask, int]:
    """Loads less the lightest one of their pose; rows in use that differ from it; poses shifted."""
    differences, shifted = W.copy(), 0
    for rows in rows_by_label(np.unique(pose, return_inverse=True)[1]):
        among = rows[use[rows]] if use[rows].any() else rows
        force, moment = (np.linalg.norm(W[among, k : k + 3], axis=1) for k in (0, 3))
        least = W[among[np.lexsort((moment, force))[0]]]
        differences[rows] -= least
        shifted += bool(least.any())
    return differences, use & np.any(differences != 0.0, axis=1), shifted
