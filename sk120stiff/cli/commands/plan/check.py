"""`sk120stiff plan --check FILE`: what is wrong with each row of a plan, whoever made it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.cli.cell import assumed_at_work, at_work, opened_cell
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data, open_model
from sk120stiff.cli.tables import table
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.table.settings import find_settings
from sk120stiff.measurements.table.table import read_table
from sk120stiff.model import joint_spring_model
from sk120stiff.plan import Cell, assumptions, feasible, jumps
from sk120stiff.plan.rig import HANGING
from sk120stiff.robot import Robot
from sk120stiff.units import parse_values
from sk120stiff.workspace import elastic_arm, joints_along, read_path


class _Rows(NamedTuple):
    """What is held against the cell: N rows with their lines and labels.

    Attributes:
        a: (N, n) [rad or m].
        wrench: (N, 6) at `force_point`, base axes [N, N·m].
        point, force_point: (3,) in the tool frame [m].
        assumed: Sentences about what was taken for granted.
        otherwise: How to drive another way.
    """

    robot: Robot
    cell: Cell
    lines: tuple[int, ...]
    poses: tuple[str, ...]
    a: Array
    wrench: Array
    point: Array
    force_point: Array
    assumed: tuple[str, ...]
    otherwise: str


def checked(
    path: Path,
    model: Path | None,
    point: str | None,
    given: Path | None,
    stated: Callable[[Cell], Cell],
) -> Answer:
    """Every row that is used held against the cell, and the joints' straight way to the next one.

    What stands in the way between two rows is told, not refused: there may be another way.

    Args:
        path: The plan, readings, or a path by joints.
        model: The arm of a path; plans and readings name theirs.
        point: --point, where a path's load acts and its positions are meant.
        given: The file of --cell.
        stated: Puts floor and box of the command line into a cell.
    """
    is_path = find_settings(path) is None and "pose" not in read_table(path).headers
    used = _path(path, model, point, given, stated) if is_path else _read(path, given, stated)
    verdict = feasible(
        used.robot, used.cell, used.a, used.wrench,
        point=used.point, force_point=used.force_point,
    )  # fmt: skip
    rows = [
        {"line": int(line), "pose": pose, "ok": bool(ok), "faults": list(faults)}
        for line, pose, ok, faults in zip(
            used.lines, used.poses, verdict.ok, verdict.faults, strict=True
        )
    ]
    bad = [row for row in rows if not row["ok"]]
    met = jumps(used.robot, used.cell, used.a, point=used.point)
    ways: list[dict[str, object]] = [
        {
            "lines": [rows[k]["line"] for k in (way.row, way.row + 1)],
            "poses": [used.poses[k] for k in (way.row, way.row + 1)],
            "meets": way.words,
        }
        for way in met
    ]
    document = {
        "robot": used.robot.name,
        "cell": used.cell.source or None,
        "rows": rows,
        "feasible": len(rows) - len(bad),
        "jumps": ways,
        "assumed": used.assumed,
    }
    said: list[object] = [f"{len(rows) - len(bad)} of {len(rows)} rows can be driven and held."]
    if bad:
        lines = [
            (r["line"], r["pose"], text) for r in bad for text in verdict.faults[rows.index(r)]
        ]
        said.insert(0, table("What is wrong", ["line", "pose", "fault"], lines))
    if ways:
        said.append(
            table(
                "Not straight from one to the next",
                ["from line", "to line", "on the way"],
                [(*(rows[k]["line"] for k in (way.row, way.row + 1)), way.words) for way in met],
            )
        )
        said.append(f"Joints that go straight meet something {len(ways)} times; {used.otherwise}")
    return Answer(document, [*said, *used.assumed], exit_code=int(bool(bad)))


def _read(path: Path, given: Path | None, stated: Callable[[Cell], Cell]) -> _Rows:
    """A plan or readings."""
    data, robot = open_data(path)
    cell = stated(opened_cell(robot, given, path))
    used = data.masked()
    at = used.point
    if used.absolute is not None:
        at = used.absolute.point[0]
        if not used.wrench.any():
            cell = replace(cell, rig=HANGING)
    when = used.order if used.order is not None else used.time
    if when is not None:  # as it was driven
        used = used.select(np.argsort(when, kind="stable"))
    load_cases = load_cases_of(robot, used)
    return _Rows(
        robot, cell, tuple(used.line), used.pose, load_cases.a, load_cases.wrench,
        at, load_cases.force_point, assumptions(robot, cell, at),
        "drive around it by hand, or let 'sk120stiff plan --program FILE' find order and way.",
    )  # fmt: skip


def _path(
    path: Path, model: Path | None, point: str | None, given: Path | None,
    stated: Callable[[Cell], Cell],
) -> _Rows:  # fmt: skip
    """A path by joints: at work, so neither rig nor tracker is asked."""
    if model is None:
        raise InputError(
            "nothing says of which arm this is",
            where=str(path),
            remedy="Give --model model.yaml for a path by joints. Plans and readings have a column "
            f"pose, and name their robot in {path.with_suffix('.yaml').name} (robot: ...).",
        )
    robot = open_model(str(model)).robot
    at, _ = points_of(None, point)
    found = read_path(path, robot)
    if found.joints is None:
        raise InputError(
            "the path is given by positions alone, which an arm takes up in many postures",
            where=str(path),
            remedy="Let 'sk120stiff posture' or 'compensate' choose the joints; check that.",
        )
    a = found.joints
    if "command_x" not in found.table.headers:  # else its positions are those under load
        a = joints_along(found, elastic_arm(joint_spring_model(robot), point=at))
    cell = stated(at_work(opened_cell(robot, given, path)))
    called = found.table.cells.get("point") or ("",) * found.count
    assumed = (
        f"Loads act at {1e3 * at[0]:g}, {1e3 * at[1]:g}, {1e3 * at[2]:g} mm in {robot.tool_frame}.",
        *assumed_at_work(robot, cell),
    )
    return _Rows(
        robot, cell, found.table.lines, called, a, found.wrench, at, at, assumed,
        "put points between these two, or choose another posture.",
    )  # fmt: skip


def points_of(known: Measurements | None, text: str | None) -> tuple[Array, Array]:
    """(3,) measured and loaded point in the tool frame [m]: of --point, else of readings."""
    if text is not None:
        values = parse_values(text, "length", where="--point", like="0,50,120 mm")
        return values, values
    if known is not None:
        at = known.point if known.absolute is None else known.absolute.point[0]
        return at, known.force_point
    return np.zeros(3), np.zeros(3)
