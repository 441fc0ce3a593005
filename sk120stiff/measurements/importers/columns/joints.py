"""Which columns are the robot's joints: by name, by number, or as linear expressions of them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, listed, meant
from sk120stiff.measurements.importers.columns.compound_groups import groups_of, shown
from sk120stiff.measurements.importers.columns.not_taken import (
    NO_JOINTS,
    own_places,
    robot_poses,
)
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.told import Told, quantity, texts, unit_of
from sk120stiff.measurements.table.joint_map import Linear, parse_linear

_OPERATOR = re.compile(r"[-+*/()]")


@dataclass(frozen=True, eq=False)
class JointColumns:
    """Joint values, and how they are written.

    Attributes:
        values: (N, n) rad or m, in the order of the actuated joints.
        written: Header and cells of each column that is written.
        mapping: Joint → expression of those columns, where they are not the joints themselves.
        taken: The columns they come from.
        said: What was taken for which joint, in sentences.
    """

    values: Array
    written: tuple[tuple[str, tuple[str, ...]], ...]
    taken: tuple[Column, ...]
    mapping: dict[str, str] = field(default_factory=dict)
    said: tuple[str, ...] = ()

    @property
    def sums(self) -> tuple[list[str], Array, Array]:
        """Names of m columns, their shares (n, m) in each joint, and the joints' zeros (n,)."""
        names = [unit_of_header(column.header)[0] for column in self.taken]
        if not self.mapping:
            return names, np.eye(len(names)), np.zeros(len(names))
        terms = [parse_linear(text, "--joints").terms for text in self.mapping.values()]
        words = list(dict.fromkeys(name for own in terms for name in own if name))
        shares = [[own.get(word, 0.0) for word in words] for own in terms]
        return names, np.array(shares), np.array([own.get("", 0.0) for own in terms])


def joint_columns(
    sheet: Sheet, told: Told, actuated: tuple[str, ...], prismatic: tuple[str, ...]
) -> JointColumns:
    """The joints of a robot in a sheet.

    Raises:
        InputError: A joint has no column, or `told.joints` names another number or unknown ones.
    """
    kinds = {name: "length" if name in prismatic else "angle" for name in actuated}
    if any(_OPERATOR.search(t) and _lookup(sheet, t) is None for t in told.joints or ()):
        return _expressed(sheet, told, told.joints or (), kinds)
    columns = _as_told(sheet, told.joints, actuated) if told.joints else _found(sheet, actuated)
    values, written = [], []
    for joint, column in zip(actuated, columns, strict=True):
        unit = unit_of(sheet, column, kinds[joint], told)
        values.append(quantity(sheet, column, kinds[joint], unit))
        written.append((f"{joint}[{unit}]", texts(column)))
    names = [unit_of_header(c.header)[0] for c in columns]
    pairs = [f"{name} is {joint}" for name, joint in zip(names, actuated, strict=True)]
    said = () if tuple(names) == actuated else (f"Joint columns: {', '.join(pairs)}.",)
    return JointColumns(np.column_stack(values), tuple(written), tuple(columns), said=said)


def _numbered(sheet: Sheet) -> dict[int, Column]:
    return {int(c.meaning[6:]): c for c in sheet.columns if c.meaning.startswith("joint ")}


def _lookup(sheet: Sheet, name: str) -> Column | None:
    for column in (*sheet.columns, *sheet.spare):
        if name in (column.header, unit_of_header(column.header)[0]):
            return column
    match = re.fullmatch(r"[qQjJ]_?(\d+)", name)
    return _numbered(sheet).get(int(match[1])) if match else None


def _found(sheet: Sheet, actuated: tuple[str, ...]) -> list[Column]:
    """The numbered columns, from 1 or from 0 on."""
    numbered = _numbered(sheet)
    n = len(actuated)
    robot = f"The actuated joints are {', '.join(actuated)}."
    poses = [] if numbered else robot_poses(sheet) or own_places(sheet)
    if poses:
        raise InputError(
            f"this file holds poses of the robot in space ({listed(poses)}) or what an instrument "
            "read, and no joint values" + _may_be(sheet, n),
            where=str(sheet.path),
            remedy=f"{NO_JOINTS}: beside the readings, or with --joints-file FILE."
            f"{_in_sheets(sheet)} {robot}",
        )
    if not numbered:
        raise InputError(
            "this file holds no joint values" + _may_be(sheet, n),
            where=str(sheet.path),
            remedy="Give the file that does: --joints-file FILE; or name its columns with "
            f"--joints.{_in_sheets(sheet)} {robot}",
        )
    start = 0 if 0 in numbered else 1
    names = [unit_of_header(c.header)[0] for c in (*numbered.values(), *sheet.spare)]
    for k, joint in enumerate(actuated, start):
        if k not in numbered:
            headers = listed([c.header for c in numbered.values()])
            raise InputError(
                f"the joint {joint!r} has no column 'q{k}'{meant(joint, names)}",
                where=str(sheet.path),
                remedy=f"Joints were found in {headers}. Name "
                "the columns as the joints, or q1, q2, ..., or give their names with --joints. "
                + robot,
            )
    over = [c.header for k, c in numbered.items() if k >= start + n]
    if over:
        raise InputError(
            f"{', '.join(over)}: joints by their names, which the robot does not have",
            where=str(sheet.path),
            remedy=f"{robot} Give the robot that was measured, or name the columns of its joints "
            "with --joints.",
        )
    return [numbered[k] for k in range(start, start + n)]


def _in_sheets(sheet: Sheet) -> str:
    """How to name another sheet of the workbook, as a sentence with a blank before it."""
    others = [item[len("sheet ") :] for item in sheet.unused if item.startswith("sheet ")]
    if not others:
        return ""
    return (
        f" Of the other sheets here ({listed(others)}) say which has them: --sheet "
        f"'joints={others[0]}'."
    )


def _may_be(sheet: Sheet, joints: int) -> str:
    """Composed headers of joints of which none was chosen, in words; empty where none are."""
    headers = [c.header for c in sheet.spare]
    groups = [g for g in groups_of(headers, joints=joints) if g.family == "joint"]
    return f"; these may each be: {listed(shown(groups, headers), 'or')}" if groups else ""


def _as_told(sheet: Sheet, told: tuple[str, ...], actuated: tuple[str, ...]) -> list[Column]:
    _refuse_count(told, actuated)
    columns = []
    for joint, name in zip(actuated, told, strict=True):
        column = _lookup(sheet, name)
        if column is None:
            raise _no_column(sheet, name, joint)
        columns.append(column)
    return columns


def _refuse_count(told: tuple[str, ...], actuated: tuple[str, ...]) -> None:
    if len(told) != len(actuated) or len(set(told)) != len(told):
        raise InputError(
            f"{len(set(told))} columns for {len(actuated)} joints",
            where="--joints",
            remedy="Name one column for each joint, in their order. The actuated joints are "
            f"{', '.join(actuated)}.",
        )


def _no_column(sheet: Sheet, name: str, joint: str) -> InputError:
    names = [unit_of_header(c.header)[0] for c in (*sheet.columns, *sheet.spare)]
    return InputError(
        f"the joint {joint!r} has no column {name!r}{meant(name, names)}",
        where=str(sheet.path),
        remedy=f"Columns are {', '.join(names)}; numbered joints are also q1, q2, ...",
    )


def _expressed(
    sheet: Sheet, told: Told, expressions: tuple[str, ...], kinds: dict[str, str]
) -> JointColumns:
    """Joints as linear expressions; the columns are written as they are, the mapping beside."""
    _refuse_count(expressions, tuple(kinds))
    expressions, spelt = _in_one_word(sheet, expressions)
    raw: dict[str, tuple[Column, Array, str]] = {}
    values = []
    for (joint, kind), text in zip(kinds.items(), expressions, strict=True):
        linear = _linear(sheet, text, joint)
        total = np.full(len(sheet.lines), linear.terms.get("", 0.0))
        for name, share in linear.terms.items():
            if not name:
                continue
            if name not in raw:
                column = _lookup(sheet, spelt.get(name, name))
                if column is None:
                    raise _no_column(sheet, name, joint)
                unit = unit_of(sheet, column, kind, told)
                raw[name] = (column, quantity(sheet, column, kind, unit), unit)
            total += share * raw[name][1]
        values.append(total)
    return JointColumns(
        np.column_stack(values),
        tuple((f"{name}[{unit}]", texts(column)) for name, (column, _, unit) in raw.items()),
        tuple(column for column, _, _ in raw.values()),
        dict(zip(kinds, expressions, strict=True)),
        (f"Joints: {', '.join(f'{j} = {t}' for j, t in zip(kinds, expressions, strict=True))}.",),
    )


def _linear(sheet: Sheet, text: str, joint: str) -> Linear:
    """A sum of columns, or what is wrong with it and which columns there are."""
    try:
        return parse_linear(text, f"--joints, {joint}")
    except InputError as error:
        names = ", ".join(unit_of_header(c.header)[0] for c in (*sheet.columns, *sheet.spare))
        remedy = f"{error.remedy} Columns are {names}."
        raise InputError(error.what, where=error.where, remedy=remedy) from None


def _in_one_word(
    sheet: Sheet, expressions: tuple[str, ...]
) -> tuple[tuple[str, ...], dict[str, str]]:
    """Expressions in which headers like ``J 2`` are one word, ``J_2``; and these words' headers.

    A header may be written with its unit or without, and with any number of blanks.
    """
    columns = (*sheet.columns, *sheet.spare)
    names = {c.header for c in columns} | {unit_of_header(c.header)[0] for c in columns}
    spelt: dict[str, str] = {}
    for name in sorted(names, key=len, reverse=True):
        blanks = r"\s+".join(map(re.escape, name.split()))
        whole = re.compile(rf"(?<!\w){blanks}(?!\w)")
        number = not re.match(r"[^\W\d]", name)
        if name.isidentifier() or number or not any(map(whole.search, expressions)):
            continue
        word, own = re.sub(r"\W+", "_", unit_of_header(name)[0]), _lookup(sheet, name)
        while _lookup(sheet, spelt.get(word, word)) not in (None, own):  # another column's
            word += "_"
        spelt[word] = name
        expressions = tuple(whole.sub(word, text) for text in expressions)
    return expressions, spelt
