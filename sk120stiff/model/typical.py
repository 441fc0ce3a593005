"""What is usual of an arm: springs to start with, and values that none has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Geometric, Imposed, effect
from sk120stiff.errors import listed
from sk120stiff.model.model import Model, joint_spring_model
from sk120stiff.model.parameter import Parameter
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_joints, arm_length

TYPICAL = "typical of an arm of this size, not measured"

WIND_UP = 3e-3  # rad by which a geared joint turns under its largest torque
SHIFT = 1e-4  # m by which a slide shifts under its largest force
TOLD = 4  # values that no arm has, one by one
LEAST_LEVER = 0.1  # share of the arm's length that the shortest lever counts for
BELIEVABLE = 10.0  # factor from what the size says, beyond which a stated effort is a placeholder

RULE = (
    f"A joint whose URDF states an effort winds up {1e3 * WIND_UP:g} mrad under it (a slide: "
    f"{1e3 * SHIFT:g} mm), as gears of servo drives do. Without one, or where it is more than "
    f"{BELIEVABLE:g} times off, the arm's size counts: 1e6 N*m/rad at an arm of 2.87 m, with the "
    "cube of its length, and in proportion to the lever from the joint to the tool."
)


def typical_model(robot: Robot) -> Model:
    """A spring in every actuated joint, from the arm's size and its stated efforts (see `RULE`).

    An order of magnitude to plan and to start an identification with. A gear is dimensioned by the
    stress in its teeth and bearings, so all wind up by a few milliradians at their largest torque,
    whatever their size; which size a joint has goes with its torque.
    """
    model = joint_spring_model(robot, typical_stiffness(robot))
    parameters = tuple(replace(p, origin=TYPICAL) for p in model.parameters)
    return replace(model, parameters=parameters, provenance={"springs": f"{TYPICAL}. {RULE}"})


def typical_stiffness(robot: Robot) -> Array:
    """(n,) stiffness [N·m/rad or N/m] to two digits, since it knows no more."""
    levers = _levers(robot)
    found = np.empty(robot.n)
    for k, name in enumerate(robot.actuated):
        spec = effect(robot, "joint_springs", name).parameters[0]
        usual = spec.public(spec.typical)
        if not robot.prismatic[k]:
            usual *= max(levers[k], LEAST_LEVER)
        wound = robot.efforts[k] / (SHIFT if robot.prismatic[k] else WIND_UP)
        stated = usual / BELIEVABLE <= wound <= usual * BELIEVABLE
        found[k] = float(f"{wound if stated else usual:.1e}")
    return found


def typical_parameters(model: Model) -> tuple[Parameter, ...]:
    """Parameters of a model that nobody measured."""
    return tuple(p for p in model.parameters if p.origin.startswith(TYPICAL))


def implausible_geometry(model: Model) -> tuple[Parameter, ...]:
    """Parameters by which the arm is another than any that is built to its drawing.

    Where a marker sits, and where an instrument stands, is nobody's drawing.
    """
    return tuple(
        p
        for p in model.parameters
        if isinstance(p.effect, Geometric | Imposed)
        and not (isinstance(p.effect, Geometric) and p.effect.of_marker)
        and abs(p.internal) > p.spec.plausible
    )


def told_implausible(parameters: Sequence[Parameter]) -> str:
    """What to think of values that no arm has, and to do first."""
    values = listed([f"{p.name} = {p.value:.3g} {p.spec.unit}" for p in parameters], most=TOLD)
    return (
        f"More than is plausible: {values}. The zero of a joint is elsewhere, another cause hides "
        "behind it, or the fit found no better way: make sure before you use this model."
    )


def _levers(robot: Robot) -> Array:
    """(n,) length of the arm beyond each actuated joint, over that of the whole arm."""
    joints, whole = arm_joints(robot), arm_length(robot)
    beyond = {joint.name: sum(j.length for j in joints[joint.index :]) for joint in joints}
    return np.array([beyond.get(name, whole) / whole if whole else 1.0 for name in robot.actuated])
