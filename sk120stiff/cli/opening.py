"""Opening what the command line names, and saying which defaults were taken."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.cli.frame import note
from sk120stiff.errors import InputError, warn
from sk120stiff.files import will_write
from sk120stiff.robot import Robot, find_robot, is_dh_table, load_robot
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

    Raises:
        InputError: One of the two is an input, or cannot be written.
    """
    from sk120stiff.measurements.files.writing import check_name

    if out is not None:
        check_name(out)
        will_write(out)
        will_write(out.with_suffix(".yaml"))


def open_robot(source: str, base: str | None, tool: str | None) -> Robot:
    """Load a robot, or that of a model; frames that nobody named are told on stderr."""
    from sk120stiff.model import read_model

    file = model_file(source)
    if file is not None:
        return read_model(file, base=base, tool=tool).robot
    robot = load_robot(source, base=base, tool=tool)
    described = find_robot(source).description
    if base is None and described.base_frame is None:
        note(f"Base frame: {robot.base_frame} (choose another with --base FRAME).")
    if tool is None and described.tool_frame is None:
        about = f"{robot.tool_frame} {robot.choice.about_tool}"
        note(f"Tool frame: {about}. Choose another with --tool FRAME.")
        if robot.choice.fingers:
            note(f"Held still as fingers: {', '.join(robot.choice.fingers)}.")
    return robot


def open_model(
    named: str,
    path: Path | None = None,
    *,
    base: str | None = None,
    tool: str | None = None,
) -> Model:
    """The model that the words of a command line mean: those of a robot or of a model.

    Args:
        named: ROBOT or MODEL. A model file knows its robot; a robot has the model beside its
            `robot.yaml`, or else springs typical of its size, which is told.
        path: What --model names, if anything: it is put on the robot of `named`.
        base, tool: Frames in the place of the robot's own.
    """
    from sk120stiff.model import base_model, read_model

    file = model_file(named)
    if path is None:
        model = (
            base_model(open_robot(named, base, tool))
            if file is None
            else read_model(file, base=base, tool=tool)
        )
        return tell_doubts(model)
    return model_for(open_robot(named, base, tool), path)


def model_for(robot: Robot, path: str | Path) -> Model:
    """The model that --model or MODEL names, on a robot that is known already."""
    from sk120stiff.model import base_model, read_model

    file = model_file(path)
    if file is not None:
        return tell_doubts(read_model(file, robot))
    named = find_robot(str(path))
    if not _same_joints(str(path), robot):
        raise InputError(
            f"this is another robot than {robot.name}",
            where=str(path),
            remedy="Give a model of that robot, or the robot itself.",
        )
    beside = named.model_file
    return tell_doubts(base_model(robot) if beside is None else read_model(beside, robot))


def _same_joints(named: str, robot: Robot) -> bool:
    try:
        other = load_robot(named, base=robot.base_frame, tool=robot.tool_frame)
    except InputError:  # it has no such frames
        return False
    return other.actuated == robot.actuated


def model_file(named: str | Path) -> Path | None:
    """The model file that a word of the command line means; None where it means a robot.

    That is a YAML file other than `robot.yaml`, or a folder that holds a `model.yaml` and no robot.
    """
    path = Path(named)
    if path.suffix.lower() in (".csv", ".html", ".json", ".zarr") and not is_dh_table(path):
        raise InputError(
            "this is no robot and no model file",
            where=str(named),
            remedy="Give a .urdf, a .xacro, a DH table (.csv), a folder with robot.yaml, a bundled "
            "name, or a model file (.yaml).",
        )
    if path.suffix.lower() in (".yaml", ".yml") and path.name != "robot.yaml":
        return path
    held = path / "model.yaml"
    return held if held.is_file() and not (path / "robot.yaml").exists() else None


def tell_doubts(model: Model) -> Model:
    """The model, after a warning where nobody measured its values, or no arm has such ones."""
    from sk120stiff.model import implausible_geometry, told_implausible, typical_parameters

    if assumed := typical_parameters(model):
        places = ", ".join(dict.fromkeys(p.effect.where for p in assumed))
        warn(
            f"The springs of {places} are typical of an arm of this size, not measured: results "
            "are orders of magnitude. Identify them (sk120stiff identify), or give --model."
        )
    if beyond := implausible_geometry(model):
        warn(told_implausible(beyond))
    return model


def pose_of(robot: Robot, text: str | None, option: str = "--pose") -> Array:
    """Actuated coordinates (n,) [rad or m] from an option; the rest pose without it."""
    if text is None:
        return robot.rest
    a = parse_pose(text, robot.actuated, robot.kinds, where=option)
    slack = 1e-9  # a limit itself, written in degrees, is within the limits
    for k in np.flatnonzero((a < robot.lower - slack) | (a > robot.upper + slack)):
        low, here, high = robot.lower[k], a[k], robot.upper[k]
        if not robot.prismatic[k]:
            low, here, high = np.degrees((low, here, high))
        warn(
            f"{robot.actuated[k]} stands at {here:g} {'m' if robot.prismatic[k] else 'deg'}, "
            f"beyond its limits {low:g} .. {high:g}."
        )
    return a


def frame_at(robot: Robot, at: str | None) -> str:
    """The frame that --at names, the tool frame without it.

    Raises:
        InputError: The robot has no such frame.
    """
    frame = at or robot.tool_frame
    robot.tree.body(frame, where="--at")
    return frame


def wrench_of(text: str | None) -> Array:
    """Wrench (6,) [N, N·m] from --wrench; no load where nothing is given."""
    return np.zeros(6) if text is None else parse_wrench(text, where="--wrench")


def open_data(path: Path) -> Opened:
    """Measurements, and the robot that their YAML file names.

    Raises:
        InputError: The data cannot be read, name no robot, or do not fit it.
    """
    from sk120stiff.cli.tables import progress_bar
    from sk120stiff.measurements import read_measurements

    with progress_bar("reading"):
        data = read_measurements(path)
    if data.robot is None:
        raise InputError(
            "the measurements do not say which robot they are of",
            where=str(path),
            remedy=f"Write 'robot: ...' (a name or a path) into {path.with_suffix('.yaml')}.",
        )
    try:
        robot = open_robot(data.robot, data.base_frame, data.tool_frame)
    except InputError as error:
        if error.where not in (None, data.robot):
            raise
        place = f"{path.with_suffix('.yaml')}: {error.where}" if error.where else None
        where = place or str(path.with_suffix(".yaml"))
        raise InputError(error.what, where=where, remedy=error.remedy) from error
    robot = robot.under(data.gravity)
    return Opened(data.with_joints(robot.actuated, robot.kinds), robot)


def start_model(robot: Robot, path: Path | None) -> Model:
    """The model to start an identification with: that of --model, else the robot's own."""
    from sk120stiff.model import base_model, read_model, typical_parameters

    if path is not None:
        file = model_file(path)
        return base_model(robot) if file is None else read_model(file, robot)
    known = base_model(robot)
    if typical_parameters(known):
        note(
            "No model was given: a spring in every actuated joint is assumed (give one with "
            "--model)."
        )
    return known


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

    Raises:
        InputError: Not three finite numbers, or all zero.
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
