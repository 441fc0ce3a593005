"""Which joint a numbered column is, where columns beside it hold the joints' names, as ROS has it:
``/joint_states/name[0]`` beside ``/joint_states/position[0]``."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.contract import Meanings

_NAME = re.compile(r"(?P<of>.*?)(?:\b|_)names?[\s_./]*[\[(]?(?P<number>\d+)[\])]?")
_VALUE = re.compile(r"(?P<of>.*?)(?:\b|_)positions?[\s_./]*[\[(]?(?P<number>\d+)[\])]?")


def with_joint_names(
    headers: Sequence[str],
    meanings: Sequence[tuple[str, float] | None],
    rows: Sequence[Sequence[str]],
    actuated: tuple[str, ...],
    where: str,
) -> tuple[Meanings, list[str]]:
    """Meanings with joints by the names that stand beside them; others' joints have none.

    Args:
        headers, meanings: Of the columns.
        rows: Cells below them.
        actuated: The robot's joints; where none of the names is among them, numbers count.
        where: The file, for messages.

    Returns:
        Meanings, and what the names told, in sentences.

    Raises:
        InputError: The names change from row to row.
    """
    out = list(meanings)
    named = {(m["of"], m["number"]): k for k, h in enumerate(headers) if (m := _NAME.fullmatch(h))}
    beside: dict[int, tuple[int, list[str]]] = {}  # number → its name, as a column and as cells
    for k, header in enumerate(headers):
        match = _VALUE.fullmatch(header)
        place = named.get((match["of"], match["number"])) if match else None
        if place is None:
            continue
        cells = [row[place].strip("'\" ") for row in rows if place < len(row) and row[place]]
        beside[k] = place, cells
    joints = any((known := out[k]) and known[0].startswith("joint ") for k in beside)
    if not joints and not set(actuated) & {name for _, cells in beside.values() for name in cells}:
        return out, []  # names of points, say
    told: dict[int, str] = {}
    for k, (place, cells) in beside.items():
        if len(set(cells)) > 1:
            raise InputError(
                f"{headers[place]} is {listed(sorted(set(cells))[:3])}: from row to row "
                f"{headers[k]} is of another joint",
                where=where,
                remedy="Export the messages of the arm alone: those of a gripper, or of another "
                "node, stand between them.",
            )
        told[k] = cells[0] if cells else ""
    if not set(actuated) <= set(told.values()):
        return out, []
    for k, name in told.items():
        out[k] = (f"joint {actuated.index(name) + 1}", 1.0) if name in actuated else None
    first = next(k for k, name in told.items() if name == actuated[0])
    return out, [
        f"Joints are told by the columns of their names: {headers[first]} is {actuated[0]}."
    ]
