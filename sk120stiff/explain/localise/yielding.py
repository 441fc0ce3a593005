"""Places that may yield: the elastic effects of the catalogue, every parameter a free factor.

A suspect says where an arm yields, whether or not the effect that does so is among the candidates:
what the user excluded, or what fell, still shows where it lives.
"""

from __future__ import annotations

from collections.abc import Iterator
from weakref import WeakKeyDictionary

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Catalogue, Elastic, LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.model.assembly import Assembly
from sk120stiff.robot import Robot

# Every look at a gap asks anew; what is known goes with the readings.
_ASKED: WeakKeyDictionary[LoadCases, dict[Catalogue, tuple[Suspect, ...]]] = WeakKeyDictionary()


def yielding(load_cases: LoadCases, catalogue: Catalogue) -> tuple[Suspect, ...]:
    """What each elastic effect does at each place, turns and shifts apart, about the rigid arm.

    Args:
        load_cases: The N readings.
        catalogue: Of its effects those that say under what they yield.
    """
    known = _ASKED.setdefault(load_cases, {})
    if catalogue not in known:
        known[catalogue] = tuple(_yielding(load_cases, catalogue))
    return known[catalogue]


def _yielding(load_cases: LoadCases, catalogue: Catalogue) -> Iterator[Suspect]:
    robot = load_cases.robot
    assembly = Assembly(robot, _free_forms(robot, catalogue))
    z = np.zeros((load_cases.count, assembly.mechanism.n))
    z[:, : robot.n] = load_cases.a
    J = assembly.mechanism.screws(z, load_cases.point).linear_jacobian  # (N, 3, n)
    torque = assembly.mechanism.screws(z, load_cases.force_point).torques(load_cases.wrench)
    for effect, part, index in assembly.elastic:
        known = np.zeros(part.stop - part.start)
        moves = effect.by_parameter(torque[:, index], load_cases, known)
        acts = effect.by_parameter(np.ones((load_cases.count, len(index))), load_cases, known)
        turns = _turning(effect, robot)
        for what, own in (("moment", turns), ("force", ~turns)):
            if own.any():
                used = np.any(acts[:, own], axis=(0, 1))
                name = f"the {what} that {effect.yields_under.format(where=effect.where)}"
                yield _suspect(
                    name, effect, robot, J[:, :, index[own]], torque[:, index[own]],
                    moves[:, own][:, :, used],
                )  # fmt: skip


def _turning(effect: Elastic, robot: Robot) -> Mask:
    """(k,) which of an effect's coordinates turn; the others shift."""
    turns = {joint.name: joint.revolute for joint in effect.virtual_joints(robot)}
    motors = zip(robot.actuated, robot.prismatic, strict=True)
    turns |= {name: not slides for name, slides in motors}
    return np.array([turns[name] for name in effect.coordinates(robot)], dtype=bool)


def _free_forms(robot: Robot, catalogue: Catalogue) -> tuple[Elastic, ...]:
    """The effects at all their places, with as many parameters as their kind may have."""
    return tuple(
        effect.free_form()
        for kind in catalogue
        if issubclass(kind, Elastic) and kind.yields_under
        for where in kind.places(robot)
        if isinstance(effect := kind.at(robot, where, Options()), Elastic)
    )


def _suspect(
    name: str, effect: Elastic, robot: Robot, J: Array, torque: Array, moves: Array
) -> Suspect:
    """An effect's coordinates that turn, or those that shift.

    Args:
        name: Completes the sentence "The gap goes with ...".
        effect, robot: Whose it is.
        J: (N, 3, k) shift of the point by these coordinates.
        torque: (N, k) load on them [N·m or N].
        moves: (N, k, P) what they do per unit of each parameter that moves them.
    """
    _, count, free = moves.shape
    load = torque if count == free else np.zeros((0, 0))
    unit = "moment there [N·m]" if name.startswith("the moment") else "force there [N]"
    size = np.linalg.norm(torque, axis=1) / np.sqrt(count / max(free, 1))
    general = effect.special_case_of(robot)
    frees = (effect.id, *([] if general is None else [general]))
    return Suspect("place", name, J @ moves, size, unit, carried=load, frees=frees)
