"""The path that `compensate` is given, with what the command line says of part, tool and load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, listed, warn
from sk120stiff.programs import READERS
from sk120stiff.programs.bad_targets import least_turn
from sk120stiff.programs.placing import TOOL_DOWN, part_frame, placed, tool_rotation
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import rotation_from_rpy
from sk120stiff.units import parse_size, parse_wrench
from sk120stiff.workspace import LoadedPath, read_path

CHORD = "10 um"
STEP = "50 mm"  # between points the correction goes straight, and off by the square of the way
FREE_TOOL = (
    "The tool's orientation is free: it is not stated, and stays near that of the point before."
)


class LoadAxes(StrEnum):
    """In which axes loads are stated."""

    base = "base"
    tool = "tool"


@dataclass(frozen=True)
class PathOptions:
    """Options as they were written; None where nobody gave them."""

    frame: str | None
    wrench: str | None
    load_axes: LoadAxes
    tool_rpy: str | None
    chord: str | None
    step: str | None


class OpenedPath(NamedTuple):
    """A path in base axes.

    Attributes:
        path: The points.
        part: (4, 4) where its axes lie in the base.
        facts: Sentences about what was assumed.
        turned: The path with the tool turned about its own axis [rad], where that is free.
    """

    path: LoadedPath
    part: Array
    facts: tuple[str, ...]
    turned: Callable[[float], LoadedPath] | None = None


def open_path(file: Path, robot: Robot, options: PathOptions) -> OpenedPath:
    """Read a CSV path, G-code or APT, by the ending of its name.

    Raises:
        InputError: It cannot be read, or an option does not fit it.
    """
    part = np.eye(4) if options.frame is None else part_frame(options.frame)
    wrench = None if options.wrench is None else parse_wrench(options.wrench, where="--wrench")
    load = "that of the file" if wrench is None else f"{options.wrench} at every point"
    lies = "that of the base" if options.frame is None else options.frame
    facts: tuple[str, ...] = (
        f"Part's frame: {lies}.",
        f"Load: {load}, {options.load_axes.value} axes.",
    )
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        for option, value in (("--tool-rpy", options.tool_rpy), ("--chord", options.chord),
                              ("--step", options.step)):  # fmt: skip
            if value is not None:
                raise InputError(
                    "this belongs to a machining program, and the path is a CSV file",
                    where=option,
                    remedy="Paths in G-code end in .nc, .ngc, .tap, … and APT in .apt, .cls.",
                )
        moved = None if options.frame is None else part
        read_in = read_path(file, robot, wrench=wrench, part=moved)
        if read_in.joints is None and read_in.rotation is None:
            facts = (*facts, FREE_TOOL)
        return OpenedPath(read_in, part, facts)
    if wrench is None:
        raise InputError(
            "a machining program holds no load",
            where=str(file),
            remedy="Give the load at all its points: --wrench '0,0,-490 N'.",
        )
    chord = parse_size(options.chord or CHORD, "length", where="--chord", like=CHORD)
    step = parse_size(options.step or STEP, "length", where="--step", like="10 mm")
    tool = tool_rotation(options.tool_rpy or TOOL_DOWN)
    read = reader(file, chord=chord, step=step)
    if read.left_out:
        words = [f"{word} (line {line})" for word, line in read.left_out.items()]
        warn(f"words that do not move the tool are not carried over: {listed(words, most=12)}")
    for sentence in read.assumed:
        warn(sentence.removesuffix("."))
    said = (
        FREE_TOOL
        if tool is None
        else f"Tool in the part's axes: roll, pitch, yaw {options.tool_rpy or TOOL_DOWN}"
        + (", turned to the axis that the path states." if read.axis is not None else ".")
    )
    arcs = (
        f"Arcs: chords within {options.chord or CHORD}. Straight feed moves: points at most "
        f"{options.step or STEP} apart."
    )

    def turned(angle: float) -> LoadedPath:
        about = None if tool is None else tool @ rotation_from_rpy(np.array([0.0, 0.0, angle]))
        return placed(read, part, about, wrench)

    free = options.tool_rpy is None
    assumed = (*facts, *read.assumed, said, arcs)
    return OpenedPath(turned(0.0), part, assumed, turned if free else None)


def with_joints(
    opened: OpenedPath, robot: Robot, find: Callable[[LoadedPath], Array]
) -> tuple[OpenedPath, Array]:
    """The path with its joints (N, n), the tool turned about its axis where that is needed.

    A machining program leaves that turn open.

    Args:
        find: Joints of a path; refuses where a point cannot be reached.

    Raises:
        Refusal: A point cannot be reached, however the tool is turned.
    """
    if opened.turned is None:
        return opened, find(opened.path)
    degrees, path, a = least_turn(robot, opened.turned, find)
    said = f"The tool is turned by {degrees} deg about its axis, which keeps joints from "
    facts = (*opened.facts, f"{said}their limits.") if degrees else opened.facts
    return opened._replace(path=path, facts=facts), a
