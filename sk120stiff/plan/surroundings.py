"""The solids of a cell, what of it is guessed, and what readings tell of it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.effects import load_cases_of
from sk120stiff.measurements import Measurements
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.efforts import unknown_efforts
from sk120stiff.plan.rig import like
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_joints, arm_length
from sk120stiff.robot.collision import Scene, turret
from sk120stiff.robot.rotations import homogeneous
from sk120stiff.robot.solids import Solid, capsule_between

# Of the stretched arm: the base a UR10 stands on has 0.06 of it, that of a Panda 0.08.
PEDESTAL_RADIUS = 0.08
PEDESTAL_SPARES = 2  # the first two links may touch it: they turn on it
TOOL_RADIUS = 0.01  # of the stretched arm; the rod that a tool is taken for
JUST_BELOW = 1e-4  # m; so that what was measured passes itself
UP = np.array([0.0, 0.0, 1.0])


def scene_of(robot: Robot, cell: Cell, point: ArrayLike | None = None) -> Scene:
    """The robot among the solids of a cell; a tool that nobody described is a rod to the point."""
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    return _scene(robot, cell, tuple(at.tolist()))


def assumptions(robot: Robot, cell: Cell, point: ArrayLike | None = None) -> tuple[str, ...]:
    """What is taken for granted of readings because nobody stated it, in sentences."""
    said = []
    if cell.tracker is None:
        said.append("No tracker was given: its line of sight was not asked for.")
    if cell.rig.words == "any direction":
        said.append("No rig was given: loads may have any direction.")
    return (*said, *assumed_around(robot, cell, point))


def assumed_around(robot: Robot, cell: Cell, point: ArrayLike | None = None) -> tuple[str, ...]:
    """What is taken for granted of the arm and what stands around it, in sentences."""
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    said = [*cell.told]
    if not np.isfinite(cell.floor):
        said.append("No floor was given: poses may go below the ground.")
    if cell.pedestal is None:
        solid = _pedestal(robot, cell)
        said.append(
            "The first joint does not turn: what the arm stands on is not kept clear."
            if solid is None
            else f"The arm is taken to stand on a pedestal of {1e3 * solid.size[0]:.0f} mm radius."
        )
    if cell.tool is None and at.any():
        radius = TOOL_RADIUS * arm_length(robot)
        said.append(
            f"The tool is taken for a rod of {1e3 * radius:.0f} mm radius from flange to point."
        )
    if not cell.obstacles:
        said.append("No obstacles were given.")
    return (*said, *scene_of(robot, cell, at).remarks, *unknown_efforts(robot))


def cell_from_data(robot: Robot, cell: Cell, a: Array, wrench: Array, point: ArrayLike) -> Cell:
    """A cell with floor and rig as readings had them, where nobody stated others.

    What was measured could be driven, so it lies above the floor and its loads could be brought.
    """
    said = []
    if not np.isfinite(cell.floor):
        heights = scene_of(robot, cell, point).lowest(np.unique(a, axis=0), UP)
        floor = float(heights.min()) - cell.clearance - JUST_BELOW
        cell = replace(cell, floor=floor)
        said.append(f"The floor is taken to lie at {1e3 * floor:.0f} mm: no reading went lower.")
    if cell.rig.words == "any direction":
        rig = replace(like(np.asarray(wrench)[:, :3]), steps=cell.rig.steps)
        cell = replace(cell, rig=rig)
        said.append(f"Loads are taken to come from {rig.words}.")
    return replace(cell, told=(*cell.told, *said))


def as_measured(robot: Robot, cell: Cell, known: Measurements) -> Cell:
    """The cell with floor and directions as readings had them, where it says nothing of them."""
    load_cases = load_cases_of(robot, known)
    return cell_from_data(robot, cell, load_cases.a, load_cases.wrench, known.point)


def lowest_points(robot: Robot, a: Array, point: ArrayLike, cell: Cell | None = None) -> Array:
    """(N,) height of the lowest part that moves, base frame [m]."""
    return scene_of(robot, cell or Cell(), point).lowest(a, UP)


@lru_cache(maxsize=16)
def _scene(robot: Robot, cell: Cell, point: tuple[float, ...]) -> Scene:
    fixed = [*cell.obstacles]
    pedestal = _pedestal(robot, cell)
    if pedestal is not None:
        fixed.append(pedestal)
    if np.isfinite(cell.floor):
        T = homogeneous((0.0, 0.0, cell.floor))
        spares = turret(robot, UP)
        fixed.append(Solid("floor", robot.base_frame, T, "plane", spares=spares))
    carried = cell.tool or ()
    if cell.tool is None and any(point):
        radius = TOOL_RADIUS * arm_length(robot)
        carried = (capsule_between("tool", robot.tool_frame, np.zeros(3), np.array(point), radius),)
    return Scene(robot, fixed=fixed, carried=carried, clearance=cell.clearance)


def _pedestal(robot: Robot, cell: Cell) -> Solid | None:
    """A round pillar about the first joint's axis, from the shoulder down, as far as the arm goes.

    None for arms whose first joint does not turn, and for very short chains.
    """
    joints = arm_joints(robot)
    if cell.pedestal == 0.0 or len(joints) < 3 or not joints[0].revolute:
        return None
    screws = robot.screws(robot.rest)
    axis, foot, second = screws.axes[0], screws.origins[0], screws.origins[1]
    shoulder = foot + ((second - foot) @ axis) * axis
    length = arm_length(robot)
    radius = PEDESTAL_RADIUS * length if cell.pedestal is None else cell.pedestal
    towards_base = -(shoulder @ axis)  # the base frame's origin lies this far along the axis
    if abs(towards_base) < 0.1 * radius:  # the base frame sits at the shoulder: its -z is down
        towards_base = -axis[2] or -1.0
    down = np.sign(towards_base) * axis
    top = shoulder + radius * down  # its round top ends at the shoulder
    return capsule_between(
        "pedestal", robot.base_frame, top, top + length * down, radius, PEDESTAL_SPARES
    )
