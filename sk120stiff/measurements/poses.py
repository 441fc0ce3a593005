"""Rows of one pose have one set of joint values."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from sk120stiff import units
from sk120stiff.arrays import Array, Index, Integers
from sk120stiff.errors import InputError, meant

_ARTICLE = {"angle": "an angle", "length": "a length"}
NEXT = "next_"  # begins the labels of poses to measure next
# Joint values of one pose that differ by less are the same value written twice.
SAME_JOINT = 1e-9  # rad or m


def rows_by_label(labels: NDArray[np.integer]) -> list[Index]:
    """Rows of each label that occurs, in ascending order of the label.

    One sort serves all labels: looking for each on its own would cost rows times labels.
    """
    if not len(labels):
        return []
    order = np.argsort(labels, kind="stable")
    ends = np.flatnonzero(np.diff(labels[order])) + 1
    return np.split(order, ends)


def labels_to_come(known: Sequence[str], count: int) -> tuple[str, ...]:
    """Labels of poses to measure next, none of them taken: readings of a round before have some."""
    numbers = (label.removeprefix(NEXT) for label in known if label.startswith(NEXT))
    last = max((int(number) for number in numbers if number.isdecimal()), default=0)
    return tuple(f"{NEXT}{last + 1 + k}" for k in range(count))


def rows_at_rest(values: Array, within: float | Array) -> list[Index]:
    """Rows in turn at which joints, or loads, (N, n) stay within so much of the first of them.

    Args:
        values: (N, n) in SI.
        within: Difference that is none, of all columns or of each (n,).
    """
    starts = [0]
    for k in range(1, len(values)):
        if (np.abs(values[k] - values[starts[-1]]) > within).any():
            starts.append(k)
    return np.split(np.arange(len(values)), starts[1:])


def refuse_differing_joints(
    pose: Sequence[str],
    pose_index: Integers,
    joints: Array,
    names: Sequence[str],
    kinds: Sequence[str],
    lines: Integers,
    file: str | None,
    allowed: float = SAME_JOINT,
) -> None:
    """Compare every row with the first row of its pose.

    Args:
        pose, pose_index: N labels, and (N,) their numbers in the order of the first row.
        joints, names, kinds: (N, n) values in SI, and each column's name and kind (angle or
            length).
        lines, file: (N,) line numbers (0: none) and the file, for the message.
        allowed: Difference that is none [rad or m].

    Raises:
        InputError: Two rows of a pose differ in a joint.
    """
    _, first = np.unique(pose_index, return_index=True)
    differs = np.abs(joints - joints[first][pose_index]) > allowed
    if not differs.any():
        return
    row, column = (int(k) for k in np.argwhere(differs)[0])
    start = int(first[pose_index[row]])
    kind = kinds[column]
    unit = units.KINDS[kind][1][0]
    here, there = units.from_si(joints[[row, start], column], unit, kind)
    place = [file, f"line {lines[row]}" if lines[row] else None, f"column {names[column]}"]
    raise InputError(
        f"the pose {pose[row]!r} has {here:.9g} {unit} here, but {there:.9g} {unit} "
        + (f"in line {lines[start]}" if lines[start] else "in its first row"),
        where=", ".join(part for part in place if part),
        remedy="Rows of one pose have the same joint values: "
        "correct the value, or give the row a pose label of its own.",
    )


def refuse_strange_joints(
    columns: Sequence[str],
    names: Sequence[str],
    others: Collection[str],
    listed: str,
    file: str | None,
) -> None:
    """Raise an `InputError` where a column is no actuated joint.

    Args:
        columns: The joint columns.
        names: The actuated joints.
        others: Further columns that may be there.
        listed, file: The sentence that lists the joints, and the file, for the message.
    """
    strange = [name for name in columns if name not in {*names, *others}]
    if not strange:
        return
    as_many = len(strange) == len(set(names) - set(columns)) > 1
    by_order = "'sk120stiff import' takes columns in the order of the joints. "
    own = f"column {strange[0]}"
    raise InputError(
        f"no actuated joint is called {strange[0]!r}{meant(strange[0], names)}",
        where=f"{file}, {own}" if file else own,
        remedy=f"{listed} {by_order if as_many else ''}A column that is no joint is kept as a note "
        "when its header has no unit in brackets.",
    )


def refuse_joint_column(
    name: str,
    kind: str | None,
    names: Sequence[str],
    kinds: Sequence[str],
    others: Sequence[str],
    listed: str,
    file: str | None,
) -> None:
    """Raise an `InputError` where an actuated joint has no column, or one of another kind.

    Args:
        name, kind: The joint, and whether it takes an angle or a length; None: as the file says.
        names, kinds, others: The joint columns, their kinds, and the columns that are notes.
        listed, file: The sentence that lists the joints, and the file, for the message.
    """
    header = f"{name}[{'mm' if kind == 'length' else 'deg'}]"
    if name not in names:
        as_written = next((key for key in others if key.startswith(name)), None)
        what = f"the joint {name!r} has no column"
        if as_written is not None:
            what = f"the column {as_written!r} is a joint without a unit that is known"
        raise InputError(
            what,
            where=file,
            remedy=f"Add the column {header}; no joint value is assumed. {listed}"
            if as_written is None
            else f"Write its header as {header}.",
        )
    written = kinds[names.index(name)]
    if kind is not None and written != kind:
        raise InputError(
            f"the joint {name!r} takes {_ARTICLE[kind]}, its column holds {_ARTICLE[written]}",
            where=f"{file}, column {name}" if file else f"column {name}",
            remedy=f"Write its header as {header}.",
        )
