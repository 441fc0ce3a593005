"""Poses that put the measured point where people want it: by inverse kinematics, all branches."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, Refusal
from sk120stiff.measurements.table.table import read_table
from sk120stiff.model import joint_spring_model
from sk120stiff.plan import Cell, Places, feasible
from sk120stiff.robot import Robot
from sk120stiff.workspace.arm import elastic_arm
from sk120stiff.workspace.inverse import Task, middle_of, near, solve_inverse, starting_poses
from sk120stiff.workspace.path import different, read_path

STARTS = 64  # poses from which each place is sought


def places_of(file: Path, robot: Robot, cell: Cell, point: Array, axis: Array | None) -> Places:
    """Every pose found that puts the point at one of a file's places, and that can be.

    Args:
        file: x, y, z of the point, base axes; roll, pitch and yaw of the tool where these count.
        robot, cell: The arm, and what it must keep to.
        point: (3,) in the tool frame [m].
        axis: (3,) where the tool's z axis shall point, rotation about it free; None: any way, or
            that of the file.

    Raises:
        InputError: The file cannot be read, has no positions, or calls two places the same.
        Refusal: No place can be reached.
    """
    holds_loads = {"fx", "fy", "fz"} & set(read_table(file).headers)
    path = read_path(file, robot, wrench=None if holds_loads else np.zeros(6))
    if path.position is None:
        raise InputError(
            "places are positions, and the file has joints alone", where=str(file),
            remedy="Give x[mm], y[mm], z[mm] of the point; --data and --check take joints.",
        )  # fmt: skip
    called = path.table.cells.get("point") or [""] * path.count
    labels = [label or f"p{k + 1}" for k, label in enumerate(called)]
    for k, label in enumerate(labels):
        if label in labels[:k]:
            raise InputError(
                f"two places are called {label!r}",
                where=f"{file}, line {path.table.lines[k]}",
                remedy="Give each place a name of its own, or leave the column point out.",
            )
    arm = elastic_arm(joint_spring_model(robot), point=point)
    starts = starting_poses(arm, STARTS, np.clip(np.zeros(robot.n), arm.lower, arm.upper))
    found: list[Array] = []
    names: list[str] = []
    remarks: list[str] = []
    for k, label in enumerate(labels):
        many = Task(
            np.tile(path.position[k], (STARTS, 1)),
            axis=axis,
            rotation=None if path.rotation is None or axis is not None else path.rotation[k],
        )
        reached = solve_inverse(arm, many, starts)
        branches = different(near(arm, reached.a[reached.found], middle_of(arm)))
        if not len(branches):
            remarks.append(f"{label}: no pose reaches it.")
            continue
        verdict = feasible(robot, cell, branches, point=point)
        found.append(branches[verdict.ok])
        names += [label] * int(verdict.ok.sum())
        if not verdict.ok.any():
            remarks.append(
                f"{label}: of {len(branches)} poses none can be; {verdict.faults[0][0]}."
            )
    if not names:
        raise Refusal(
            f"no pose at any of the {path.count} places can be",
            where=str(file),
            remedy=" ".join(remarks[:3]),
        )
    return Places(np.concatenate(found), tuple(names), tuple(remarks))
