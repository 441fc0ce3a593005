"""Corrected joints as a program: controller's axes, placements, speeds, and the header.

How the controller counts joints says the key `controller` of `robot.yaml`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.table.joint_map import parse_linear
from sk120stiff.programs.controller import controller_frame, is_elsewhere, places
from sk120stiff.programs.language import Language
from sk120stiff.programs.program import Program
from sk120stiff.robot import Robot
from sk120stiff.workspace import LoadedPath


def speeds(path: LoadedPath, feed: float, rapid: float) -> Array:
    """(N,) speed on the way to each point [m/s]; `feed` where the file says nothing."""
    said = np.where(np.isnan(path.feed), feed, path.feed)
    return np.where(path.rapid, rapid, said)


def build(
    language: Language,
    out: Path,
    path: LoadedPath,
    robot: Robot,
    a: Array,
    *,
    frame: str | None,
    part: Array,
    feed: float,
    rapid: float,
    by_joints: bool,
    given: Mapping[str, str],
    facts: Sequence[str],
    date: str,
) -> Program:
    """The program of corrected joints (N, n) [rad or m].

    Args:
        frame: Whose places are written; the tool frame by default.
        part: (4, 4) part in the base: the frame of the places where the language has one.
        feed, rapid: Speeds where the path states none, and of rapid moves [m/s].
        given: Settings of the language that somebody has made.
        facts: Sentences for the header: model, data, branch.

    Raises:
        InputError: A setting that the language does not have, or axes that are none.
    """
    settings = language.with_defaults(with_pulses(language, robot, given))
    axes, slides, values = controller_axes(robot, a)
    in_part = language.in_part_frame(settings)
    place = places(robot, a, frame, part if in_part else None)
    told = [f"{key}={value or 'none'}" for key, value in settings.items()]
    header = [
        *facts,
        f"Places: frame {frame or robot.tool_frame} in "
        + ("the part's frame" if in_part else places_in(robot))
        + "; the controller's tool and frame must be the same.",
        f"Joints: {convention(robot)}.",
        f"Speeds: {60e3 * feed:g} mm/min where the path says none, rapid moves {60e3 * rapid:g} "
        "mm/min.",
        *(["Settings: " + "; ".join(told) + "."] if told else []),
        *language.remarks(settings),
    ]
    return Program(
        name=out.stem,
        header=tuple(header),
        axes=axes,
        slides=slides,
        joints=values,
        position=place[:, :3, 3],
        rotation=place[:, :3, :3],
        speed=speeds(path, feed, rapid),
        rapid=path.rapid,
        lines=np.array(path.table.lines, dtype=np.intp),
        by_joints=by_joints,
        settings=settings,
        date=date,
    )


def places_in(robot: Robot) -> str:
    """The frame in which places are stated that are not in the part's, in words."""
    if is_elsewhere(robot):
        return f"the frame {controller_frame(robot)}, the controller's own base"
    return f"the robot's frame {robot.base_frame}"


def with_pulses(language: Language, robot: Robot, given: Mapping[str, str]) -> dict[str, str]:
    """The settings that are given, with the pulses that the robot knows of where they count."""
    known = robot.controller.pulses_per_degree
    if "pulses" in language.settings and known:
        return {"pulses": ",".join(f"{x:.12g}" for x in known), **given}
    return dict(given)


def controller_axes(robot: Robot, a: Array) -> tuple[tuple[str, ...], tuple[bool, ...], Array]:
    """Names of the axes, which of them slide, and their values (N, m) at joints (N, n).

    Raises:
        InputError: An axis is no linear expression of the robot's joints.
    """
    rule = robot.controller.axes
    if not rule:
        return robot.actuated, robot.prismatic, a
    slides, columns = [], []
    for name, text in rule.items():
        where = f"robot.yaml, controller.axes.{name}"
        linear = parse_linear(text, where)
        joints = [joint for joint in linear.terms if joint]
        unknown = [joint for joint in joints if joint not in robot.actuated]
        if unknown or not joints:
            raise InputError(
                f"{unknown[0]!r} is no actuated joint" if unknown else "no joint moves this axis",
                where=where,
                remedy=f"Joints are: {', '.join(robot.actuated)}.",
            )
        kinds = {robot.prismatic[robot.actuated.index(joint)] for joint in joints}
        if len(kinds) > 1:
            raise InputError(f"{text!r} adds angles to lengths", where=where)
        value = np.full(len(a), linear.terms.get("", 0.0))
        for joint in joints:
            value += linear.terms[joint] * a[:, robot.actuated.index(joint)]
        slides.append(kinds.pop())
        columns.append(value)
    return tuple(rule), tuple(slides), np.column_stack(columns)


def convention(robot: Robot) -> str:
    """How joint values are counted, in words."""
    rule = robot.controller.axes
    if not rule:
        return (
            "joint values are those of the URDF; zeros and signs of the controller must be the "
            "same, else write 'controller: axes:' into robot.yaml"
        )
    return "axes: " + "; ".join(f"{name} = {text}" for name, text in rule.items())
