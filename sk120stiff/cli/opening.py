"""Opening what the command line names, and saying which defaults were taken."""

from __future__ import annotations

import shlex
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sk120stiff.cli.frame import note
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.files import will_write
from sk120stiff.robot import Robot, find_robot, load_robot
from sk120stiff.robot.coupling import Array
from sk120stiff.units import parse_pose, parse_wrench

if TYPE_CHECKING:
    from sk120stiff.measurements import Measurements
    from sk120stiff.model import Model


class Opened(NamedTuple):
    """Measurements and their robot."""

    data: Measurements
    robot: Robot


def declare_readings(out: Path | None) -> None:
    """Declare readings as an output, with the YAML file that is written beside them.

    Raises
    ------
    InputError
        One of the two is an input, or cannot be written.
    """
    from sk120stiff.measurements.writing import check_name

    if out is not None:
        check_name(out)
        will_write(out)
        will_write(out.with_suffix(".yaml"))


def open_robot(source: str, base: str | None, tool: str | None) -> Robot:
    """Load a robot; frames that nobody named are told on stderr."""
    robot = load_robot(source, base=base, tool=tool)
    described = find_robot(source).description
    if base is None and described.base_frame is None:
        note(f"Base frame: {robot.base_frame} (choose another with --base FRAME).")
    if tool is None and described.tool_frame is None:
        note(f"Tool frame: {robot.choice.about_tool}. Choose another with --tool FRAME.")
        if robot.choice.fingers:
            note(f"Held still as fingers: {', '.join(robot.choice.fingers)}.")
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


def pose_of(robot: Robot, text: str | None, option: str = "--pose") -> Array:
    """Actuated coordinates (n,) [rad or m] from an option; the rest pose without it."""
    if text is None:
        return robot.rest
    kinds = ["length" if slides else "angle" for slides in robot.prismatic]
    a = parse_pose(text, robot.actuated, kinds, where=option)
    slack = 1e-9  # a limit itself, written in degrees, is within the limits
    for k in np.flatnonzero((a < robot.lower - slack) | (a > robot.upper + slack)):
        low, here, high = robot.lower[k], a[k], robot.upper[k]
        if not robot.prismatic[k]:
            low, here, high = np.degrees((low, here, high))
        warnings.warn(
            f"{robot.actuated[k]} stands at {here:g} {'m' if robot.prismatic[k] else 'deg'}, "
            f"beyond its limits {low:g} .. {high:g}.",
            ToolkitWarning,
            stacklevel=2,
        )
    return a


def wrench_of(text: str | None) -> Array:
    """Wrench (6,) [N, N·m] from --wrench; no load where nothing is given."""
    return np.zeros(6) if text is None else parse_wrench(text, where="--wrench")


def open_data(path: Path, base: str | None = None, tool: str | None = None) -> Opened:
    """Measurements, and the robot that their YAML file names.

    Raises
    ------
    InputError
        The data cannot be read, name no robot, or do not fit it.
    """
    from sk120stiff.measurements import read_measurements

    data = read_measurements(path)
    if data.robot is None:
        raise InputError(
            "the measurements do not say which robot they are of",
            where=str(path),
            remedy=f"Write 'robot: ...' (a name or a path) into {path.with_suffix('.yaml')}.",
        )
    try:
        robot = open_robot(data.robot, base or data.base_frame, tool or data.tool_frame)
    except InputError as error:
        if error.where not in (None, data.robot):
            raise
        place = f"{path.with_suffix('.yaml')}: {error.where}" if error.where else None
        where = place or str(path.with_suffix(".yaml"))
        raise InputError(error.what, where=where, remedy=error.remedy) from error
    kinds = ["length" if slides else "angle" for slides in robot.prismatic]
    return Opened(data.with_joints(robot.actuated, kinds), robot)


def start_model(robot: Robot, path: Path | None) -> Model:
    """The model of that file, else the robot's own, else a spring in every actuated joint."""
    from sk120stiff.model import base_model, joint_spring_model, read_model

    if path is not None:
        return read_model(path, robot)
    known = base_model(robot)
    if known is not None:
        return known
    note("No model was given: a spring in every actuated joint is assumed (give one with --model).")
    return joint_spring_model(robot)


def provenance(path: Path, data: Measurements) -> dict[str, str]:
    """Where a result comes from: command line, data and their hash, version, date."""
    from datetime import UTC, datetime

    from sk120stiff import __version__

    return {
        "command": " ".join(["sk120stiff", *(shlex.quote(word) for word in sys.argv[1:])]),
        "data": str(path),
        "data_hash": f"sha256:{data.data_hash}",
        "version": str(__version__),
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
    }


def direction_of(text: str, option: str) -> Array:
    """(3,) unit vector of text like ``0,0,-1``; it has no unit.

    Raises
    ------
    InputError
        Not three finite numbers, or all zero.
    """
    try:
        vector = np.array([float(part) for part in text.replace(",", " ").split()])
    except ValueError as error:
        raise InputError(f"{text!r} is no direction", where=option) from error
    length = float(np.linalg.norm(vector))
    if vector.shape != (3,) or not np.isfinite(length) or length == 0.0:
        raise InputError(
            f"{text!r} is no direction", where=option, remedy="Write three numbers: 0,0,-1."
        )
    return np.asarray(vector / length)
