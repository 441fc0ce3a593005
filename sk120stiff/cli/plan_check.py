"""`sk120stiff plan --check FILE`: what is wrong with each row of a plan, whoever made it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sk120stiff.cli.cell import opened_cell
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import open_data
from sk120stiff.cli.tables import table
from sk120stiff.effects import load_cases_of
from sk120stiff.plan import Cell, assumptions, feasible


def checked(path: Path, given: Path | None, stated: Callable[[Cell], Cell]) -> Answer:
    """Every row that is used held against the cell.

    Args:
        path: The plan, or readings.
        given: The file of --cell.
        stated: Puts floor and box of the command line into a cell.
    """
    data, robot = open_data(path)
    cell = stated(opened_cell(robot, given, path))
    used = data.masked()
    load_cases = load_cases_of(robot, used)
    verdict = feasible(
        robot, cell, load_cases.a, load_cases.wrench,
        point=used.point, force_point=used.force_point,
    )  # fmt: skip
    rows = [
        {"line": int(line), "pose": pose, "ok": bool(ok), "faults": list(faults)}
        for line, pose, ok, faults in zip(
            used.line, used.pose, verdict.ok, verdict.faults, strict=True
        )
    ]
    bad = [row for row in rows if not row["ok"]]
    assumed = assumptions(robot, cell, used.point)
    document = {
        "robot": robot.name,
        "cell": cell.source or None,
        "rows": rows,
        "feasible": len(rows) - len(bad),
        "assumed": assumed,
    }
    said: list[object] = [f"{len(rows) - len(bad)} of {len(rows)} rows can be driven and held."]
    if bad:
        lines = [
            (r["line"], r["pose"], text) for r in bad for text in verdict.faults[rows.index(r)]
        ]
        said.insert(0, table("What is wrong", ["line", "pose", "fault"], lines))
    return Answer(document, [*said, *assumed], exit_code=int(bool(bad)))
