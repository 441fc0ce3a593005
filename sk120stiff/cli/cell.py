"""The option `--cell`, and the file that is taken without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.plan import Cell, assumed_around, read_cell
from sk120stiff.plan.rig import Rig
from sk120stiff.robot import Robot

CellOption = Annotated[
    Path | None,
    typer.Option(
        "--cell",
        metavar="YAML",
        help="What stands around the arm, its rig and its tracker (docs/FILES.md).",
        show_default="cell.yaml beside the file or the robot, else guesses that are printed",
    ),
]
NAME = "cell.yaml"


def opened_cell(robot: Robot, given: Path | None, *beside: Path | None) -> Cell:
    """The cell of `--cell`, else the `cell.yaml` beside one of some files or the robot, else none.

    Raises:
        InputError: The file is not there or holds what it may not.
    """
    if given is not None:
        if not given.is_file():
            raise InputError(
                "there is no such file",
                where=f"--cell {given}",
                remedy="Name a YAML file as docs/FILES.md shows it (floor: -0.8 m, obstacles, rig, "
                "tracker), or leave the option out.",
            )
        return read_cell(given, robot)
    folders = [path if path.is_dir() else path.parent for path in beside if path is not None]
    if robot.document.path is not None:
        folders.append(robot.document.path.parent)
    for folder in folders:
        if (folder / NAME).is_file():
            return read_cell(folder / NAME, robot)
    return Cell()


def at_work(cell: Cell) -> Cell:
    """At work, not measured: neither the rig nor the tracker is asked.

    Without a file: what the URDF says alone, and nothing kept clear of what is only guessed.
    """
    if cell.source:
        return replace(cell, rig=Rig(), tracker=None)
    return replace(
        cell, clearance=0.0, angle_margin=0.0, slide_margin=0.0, effort_share=1.0, pedestal=0.0
    )


def assumed_at_work(robot: Robot, cell: Cell) -> tuple[str, ...]:
    """What `at_work` asks of a posture, and what it takes for granted, in sentences."""
    margins = [f"{np.rad2deg(cell.angle_margin):g} deg"]
    if any(robot.prismatic):
        margins.append(f"{1e3 * cell.slide_margin:g} mm")
    around = f"or what {cell.source} states around it" if cell.source else "(there is no cell.yaml)"
    said = [
        f"Asked of every posture: joint limits with {' or '.join(margins)} to spare, motors at "
        f"{100 * cell.effort_share:g} % of their effort at most, {1e3 * cell.clearance:g} mm "
        f"between the arm and itself {around}."
    ]
    if cell.tool is None:
        said.append("The tool has no shape: it may touch.")
    return (*said, *assumed_around(robot, cell))


def height_words(
    heights: Array, labels: Sequence[str], floor: float, *, give: str = "--floor"
) -> str:
    """How low the arm comes, and what the floor is.

    Args:
        heights: (N,) of the lowest part that moves, base frame [m].
        labels: (N,) what the rows are called.
        floor: Height of the floor there [m]; none where it is not finite.
        give: What states a floor.
    """
    row = int(np.argmin(heights))
    text = f"The arm's lowest point is {1e3 * heights[row]:.0f} mm high (base frame, {labels[row]})"
    if not np.isfinite(floor):
        return f"{text}: give {give} if that is too low."
    return f"{text}, the floor {1e3 * floor:.0f} mm."
