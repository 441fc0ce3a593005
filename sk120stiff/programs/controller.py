"""Joints as the robot's controller counts them, after the key `controller` of `robot.yaml`."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.joint_map import parse_linear
from sk120stiff.robot import Robot


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
