"""Opening what the command line names, and saying which defaults were taken."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.cli.frame import note
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.robot import Robot, find_robot, load_robot
from sk120stiff.robot.coupling import Array
from sk120stiff.units import parse_pose, parse_wrench

if TYPE_CHECKING:
    from sk120stiff.model import Model


def open_robot(source: str, base: str | None, tool: str | None) -> Robot:
    """Load a robot; frames that nobody named and repairs of the file are told on stderr."""
    robot = load_robot(source, base=base, tool=tool)
    described = find_robot(source).description
    for told, kept, option, frame in (
        (base, described.base_frame, "--base", robot.base_frame),
        (tool, described.tool_frame, "--tool", robot.tool_frame),
    ):
        if told is None and kept is None:
            note(f"{option[2:].capitalize()} frame: {frame} (choose another with {option} FRAME).")
    for finding in robot.document.warnings:
        warnings.warn(str(finding), ToolkitWarning, stacklevel=2)
    return robot


def open_model(robot: Robot, path: Path | None) -> Model:
    """The model of that file, or the one that lies beside the robot's `robot.yaml`.

    Raises
    ------
    InputError
        There is neither.
    """
    from sk120stiff.model import base_model, read_model

    model = base_model(robot) if path is None else read_model(path, robot)
    if model is None:
        first = robot.actuated[0]
        unit = "N/m" if robot.prismatic[0] else "N*m/rad"
        raise InputError(
            "no spring values are known for this robot",
            where=robot.name,
            remedy="Identify them ('sk120stiff identify DATA --out model.yaml') or write a model "
            f"and give it with --model, e.g. {{robot: {robot.source}, effects: [{{name: "
            f"joint_springs, where: {first}, parameters: {{stiffness: {{value: 1e6, "
            f"unit: {unit}}}}}}}, ...]}}.",
        )
    return model


def pose_of(robot: Robot, text: str | None) -> Array:
    """Actuated coordinates (n,) [rad or m] from --pose; zeros where nothing is given."""
    if text is None:
        return np.zeros(robot.n)
    kinds = ["length" if slides else "angle" for slides in robot.prismatic]
    return parse_pose(text, robot.actuated, kinds, where="--pose")


def wrench_of(text: str | None) -> Array:
    """Wrench (6,) [N, N·m] from --wrench; no load where nothing is given."""
    return np.zeros(6) if text is None else parse_wrench(text, where="--wrench")
