"""Which column of a measurement file is what."""

from __future__ import annotations

import re
from dataclasses import dataclass
from difflib import get_close_matches

from sk120stiff import units
from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.table.table import Table

FORCES = ("fx", "fy", "fz")
MOMENTS = ("mx", "my", "mz")
DISPLACEMENTS = ("dx", "dy", "dz")
POSITIONS = ("x", "y", "z")
ROTATION_VECTOR = ("rx", "ry", "rz")
QUATERNION = ("qw", "qx", "qy", "qz")
TURNS = ("drx", "dry", "drz")
DIRECTIONS = ("ux", "uy", "uz")
ANCHORS = ("ax", "ay", "az")
LEVELS = ("vx", "vy", "vz")
UNCERTAINTIES = ("sx", "sy", "sz")
ZEROS = ("zero_group", "zero_count", "zero_order", "zero_time")
# Columns that are words or counts and carry no unit.
_BARE = ("pose", "order", "branch", "repeat", "use", "zero_group", "zero_count", "zero_order")
# What stands beside positions, distances and single readings; a note elsewhere.
_BESIDE = ("payload", "marker", "temperature", "series", "station")
_SINGLE = ("d", "l")
_GROUPS: dict[str, tuple[str, ...]] = {"d": DIRECTIONS, "l": ANCHORS, "inc": LEVELS}
_ABSOLUTE = (
    *TURNS, *_SINGLE, "inc", *_BESIDE, *ROTATION_VECTOR, *QUATERNION, *DIRECTIONS, *ANCHORS,
    *LEVELS,
)  # fmt: skip
_WORDS = (
    *FORCES, *MOMENTS, *DISPLACEMENTS, *POSITIONS, *UNCERTAINTIES, *_BARE, "time", "zero_time",
)  # fmt: skip


_UNITS = {
    FORCES: "N", MOMENTS: "N*m", DISPLACEMENTS: "mm", POSITIONS: "mm", UNCERTAINTIES: "um",
    ("time", "zero_time"): "s", ROTATION_VECTOR: "rad", ANCHORS: "m", _SINGLE: "mm",
    ("inc",): "deg", TURNS: "mrad",
}  # fmt: skip
_TORQUE = re.compile(r"(t|tau|torque)_?[xyz]", re.IGNORECASE)
_OTHER_DRESS = re.compile(r"(?P<name>[A-Za-z]+)\s*(?P<mark>[ (/_])(?P<unit>[^)]*)\)?")


@dataclass(frozen=True)
class Roles:
    """What the columns of a file are.

    Args:
        joints: Name of each joint column → ``"angle"`` or ``"length"``, in the file's order.
        has: The known words that are there.
        extra: Further columns, kept as notes.
        measured: `DISPLACEMENTS`, `POSITIONS`, or nothing for a plan.
        absolute: There are readings or conditions that displacements of one point do not have:
            orientations, turns, distances, single directions, payloads, several markers.
    """

    joints: dict[str, str]
    has: frozenset[str]
    extra: tuple[str, ...]
    measured: tuple[str, ...]
    absolute: bool = False


def assign_roles(
    table: Table, actuated: tuple[str, ...] = (), *, several_points: bool = False
) -> Roles:
    """Tell joint columns from loads, readings and notes.

    With `several_points` a column ``marker`` says which of them went how far under a load.

    A column that is no known word is a joint if its unit is one of angle or length, else a note.
    Names in `actuated` are joints even where they are a known word (a gantry's ``x``).

    Raises:
        InputError: A column is missing or misspelt, has a unit where none belongs, or both
            displacements and positions are given.
    """
    joints: dict[str, str] = {}
    has: set[str] = set()
    extra: list[str] = []
    standing = _standing(table, actuated, several_points)
    for name, unit in table.column_units.items():
        if name in standing and name not in actuated:
            has.add(name)
            continue
        if name in _WORDS and name not in actuated:
            has.add(name)
            if name in _BARE and unit is not None:
                raise InputError(
                    f"the column {name!r} takes no unit",
                    where=table.place(name),
                    remedy=f"Write its header as {name}.",
                )
            continue
        if name in (*TURNS, *ROTATION_VECTOR) and name not in actuated:  # of no reading of a turn
            extra.append(name)
            continue
        _refuse_misspelt(table, name, actuated)
        kind = next((k for k in ("angle", "length") if unit and units.is_kind(unit, k)), None)
        if kind is not None:
            joints[name] = kind
        else:
            extra.append(name)
    absolute = bool(has & set(_ABSOLUTE) - {"temperature", "series", "station"})
    if "pose" not in has and {"x1", "y1", "z1"} <= table.headers.keys():
        raise InputError(
            "these are marker positions of a calibration, not readings under load",
            where=f"{table.path}, line {table.header_line}",
            remedy="Convert them first: 'sk120stiff import' says what can be identified from them.",
        )
    measured = _measured(table, has)
    single = [name for name in (*_SINGLE, "inc") if name in has]
    if measured == DISPLACEMENTS and single:
        raise InputError(
            f"displacements (dx, dy, dz) and single readings ({single[0]}) stand in one file",
            where=table.place(single[0]),
            remedy="Write what a gauge read along x, y or z as dx, dy or dz and leave the other "
            "cells blank; give single readings along other directions a file of their own.",
        )
    if measured != POSITIONS and not absolute:
        _require(table, has, ("pose",))
    if has & {*FORCES, *MOMENTS} or (measured != POSITIONS and not absolute):
        _require(table, has, FORCES)
    together: tuple[tuple[str, ...], ...] = (
        *(_GROUPS[name] for name in _GROUPS if name in has),
        *(group for group in (ROTATION_VECTOR, QUATERNION) if has & set(group)),
    )
    for group in (MOMENTS, UNCERTAINTIES, measured, *together):
        if has & set(group):
            _require(table, has, group)
    if not joints:
        unitless = [n for n in extra if table.column_units[n] is None]
        if unitless:
            raise InputError(
                f"no column holds a joint value: {listed(unitless)} "
                f"{'has' if len(unitless) == 1 else 'have'} no unit",
                where=f"{table.path}, line {table.header_line}",
                remedy=f"Write the unit of a joint in its header: {unitless[0]}[deg] or "
                f"{unitless[0]}[rad]; no unit is guessed. Joints are named as in the URDF.",
            )
        raise InputError(
            "no column holds a joint value",
            where=f"{table.path}, line {table.header_line}",
            remedy="Add a column for each actuated joint, named as in the URDF, "
            "with its unit: joint_1_s[deg].",
        )
    return Roles(joints, frozenset(has), tuple(extra), measured, absolute)


def _standing(table: Table, actuated: tuple[str, ...], several_points: bool) -> frozenset[str]:
    """Words of `_ABSOLUTE` that are meant as such: beside positions or single readings.

    Beside displacements these are turns and, of several points, which marker was read.
    """
    names = table.headers.keys() - set(actuated)
    single = any(name in names and set(group) <= names for name, group in _GROUPS.items())
    if single or names & set(POSITIONS):
        return (frozenset(_ABSOLUTE) - set(TURNS)) & names
    if names & set(DISPLACEMENTS):
        return frozenset((*TURNS, "marker") if several_points else TURNS) & names
    return frozenset()


def _measured(table: Table, has: set[str]) -> tuple[str, ...]:
    displacements, positions = has & set(DISPLACEMENTS), has & set(POSITIONS)
    if displacements and positions:
        raise InputError(
            f"both displacements ({', '.join(sorted(displacements))}) "
            f"and positions ({', '.join(sorted(positions))}) are given",
            where=table.place(sorted(positions)[0]),
            remedy="Keep one kind: dx dy dz, or x y z with rows without load.",
        )
    if displacements:
        return DISPLACEMENTS
    return POSITIONS if positions else ()


def _require(table: Table, has: set[str], group: tuple[str, ...]) -> None:
    for name in group:
        if name not in has:
            together = f" {', '.join(group)} come together." if len(group) > 1 else ""
            if group in (DISPLACEMENTS, POSITIONS):
                together += " A cell stays blank where the axis was not read."
            raise InputError(
                f"the column {name!r} is missing",
                where=f"{table.path}, line {table.header_line}",
                remedy=f"Add the column {_example(name)}.{together}",
            )


def _bare(name: str) -> str:
    """``fx`` from ``fx (N)``, ``fx/N`` or ``FX_N``: the unit in another dress; else the name."""
    match = _OTHER_DRESS.fullmatch(name)
    if match and (match["mark"] != "_" or units.is_unit(match["unit"])):
        return match["name"].lower()
    return name.lower()


def _refuse_misspelt(table: Table, name: str, actuated: tuple[str, ...]) -> None:
    """A column may have any name but that of a known one with a slip in it."""
    bare = _bare(name)
    unit = table.column_units[name]
    if name not in actuated and unit and _TORQUE.fullmatch(name) and units.is_kind(unit, "moment"):
        raise InputError(
            f"the column {table.headers[name]!r} is not known (did you mean 'm{name[-1]}'?)",
            where=table.place(name),
            remedy=f"Write m{name[-1]}[{unit}], or rename the column if it is a note.",
        )
    if name in actuated or (bare not in _WORDS and table.column_units[name] is not None):
        return
    longer = [word for word in _WORDS if len(word) > 3]
    close = [bare] if bare in _WORDS else get_close_matches(bare, longer, n=1, cutoff=0.8)
    if close and close[0] not in table.headers:
        raise InputError(
            f"the column {table.headers[name]!r} is not known (did you mean {close[0]!r}?)",
            where=table.place(name),
            remedy=f"Write {_example(close[0])}, or rename the column if it is a note.",
        )


def _example(word: str) -> str:
    """The header to write for a known word."""
    unit = next((unit for group, unit in _UNITS.items() if word in group), None)
    return f"{word}[{unit}]" if unit else word
