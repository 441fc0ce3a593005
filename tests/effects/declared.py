"""Aliases as they follow from the build of an arm, before anything is measured or computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sk120stiff.effects import CATALOGUE, Catalogue, all_effects
from sk120stiff.effects.base import SPRINGS, AxisByAxis, Effect, Elastic, Geometric
from sk120stiff.effects.nonlinear import AT, POSITIVE, Nonlinear
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import sample_poses

SAME = 1e-6  # rad between two directions in the space of twists
PURE_FORCES = "all loads are pure forces"
LOADS_GROW = "all loads only grow"
ONE_WAY = "all loads point one way and grow with the order of the readings"


@dataclass(frozen=True)
class Alias:
    """Two names for one thing.

    Attributes:
        name: ``effect:where.parameter``, with ``[part]`` behind it where only a part is meant.
        other: Another parameter, or `SPRINGS` for all joint springs together.
        when: The kind of readings that it holds for; empty where it holds for all.
    """

    name: str
    other: str
    when: str = ""


def declared_aliases(robot: Robot, catalogue: Catalogue = CATALOGUE) -> tuple[Alias, ...]:
    """Aliases that follow from how the arm is built, without looking at any reading.

    Two compliances about one axis, or two errors along one slide, are one wherever they sit, if at
    every pose they move the tool alike. What is known of single effects (`OWN`) comes on top.
    """
    effects = all_effects(robot, catalogue=catalogue)
    found = [
        Alias(group[0], other)
        for kind in (Elastic, Geometric)
        for group in _about_one_axis(robot, [e for e in effects if isinstance(e, kind)])
        for other in group[1:]
    ]
    for item in effects:
        found.extend(own_aliases(item, robot))
    return tuple(found)


def _about_one_axis(robot: Robot, effects: Sequence[Effect]) -> list[list[str]]:
    """Groups of parameters whose coordinates have parallel unit twists at all poses."""
    chosen = [e for e in effects if isinstance(e, Geometric | AxisByAxis)]
    virtual = [joint for e in chosen for joint in e.virtual_joints(robot)]
    rigid = robot.mechanism()
    mechanism = rigid.with_virtual_joints(virtual) if virtual else rigid
    z = np.zeros((12, mechanism.n))
    z[:, : robot.n] = sample_poses(robot, 12, seed=3)
    twists = mechanism.screws(z).jacobian  # (12, 6, n_z)
    place = {name: k for k, name in enumerate([*robot.actuated, *(v.name for v in virtual)])}
    names, columns = [], []
    for e in chosen:
        for spec, coordinate in zip(e.parameters, e.coordinates(robot), strict=True):
            names.append(f"{e.id}.{spec.name}")
            columns.append(twists[:, :, place[coordinate]].reshape(-1))
    X = np.stack(columns, axis=1) if columns else np.zeros((1, 0))
    X = X / np.linalg.norm(X, axis=0)
    alike = np.sqrt(2.0 * np.clip(1.0 - np.abs(X.T @ X), 0.0, None)) < SAME
    groups: dict[int, list[str]] = {}
    for k, name in enumerate(names):
        groups.setdefault(int(np.argmax(alike[k])), []).append(name)
    return [group for group in groups.values() if len(group) > 1]


def own_aliases(item: Effect, robot: Robot) -> tuple[Alias, ...]:
    """What no reading of positions can tell from an effect, for reasons of its own."""
    if isinstance(item, Nonlinear):  # those of the straight law, of its first kind of parameters
        end = f"{AT}0" if item.full else POSITIVE
        return tuple(replace(a, name=a.name + end) for a in own_aliases(item._part, robot))
    return OWN.get(item.name, lambda _item, _robot: ())(item, robot)


def of_force_scale(item: Any, robot: Robot) -> tuple[Alias, ...]:
    """All gains together are what all compliances together are.

    A single one is, too, where its axis always lies along a slide and no other joint yields that
    way: the lift of a SCARA.
    """
    every = "+".join(spec.name for spec in item.parameters)
    found = [Alias(f"{item.id}[{every}]", SPRINGS, PURE_FORCES)]
    if item.of_rig:
        return tuple(found)
    screws = robot.screws(sample_poses(robot, 12))
    columns = screws.linear_jacobian  # (12, 3, n)
    for k, spec in enumerate(item.parameters):
        along = np.abs(np.einsum("nij,ni->nj", columns, screws.rotation[:, :, k]))
        for j in np.flatnonzero(robot.prismatic):
            if (along[:, j] > 1.0 - 1e-9).all() and np.delete(along, j, axis=1).max() < 1e-9:
                spring = f"{SPRINGS}:{robot.actuated[j]}.stiffness"
                found.append(Alias(f"{item.id}.{spec.name}", spring))
    return tuple(found)


def of_base_sliding(item: Effect, _robot: Robot) -> tuple[Alias, ...]:
    """A shift that grows with the load grows with the order where the load does."""
    return tuple(
        Alias(f"{item.id}.stiffness_{k}", f"reading_drift:tracker.rate_{k}", ONE_WAY) for k in "xyz"
    )


def of_link_bending(item: Any, robot: Robot) -> tuple[Alias, ...]:
    """A link of a parallelogram that bends in its plane shifts what the rod holds upright.

    So does the drive of that link: the direction is the same wherever the beam bends.
    """
    joints = item.virtual_joints(robot)
    bends = [robot.n + k for k, joint in enumerate(joints) if joint.name.endswith(".in_plane")]
    z = np.zeros((12, robot.n + len(joints)))
    z[:, : robot.n] = sample_poses(robot, 12)
    twists = robot.mechanism().with_virtual_joints(joints).screws(z).jacobian  # (12, 6, n_z)
    columns = twists.reshape(-1, z.shape[1])
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    alike = np.abs(columns[:, bends].T @ columns[:, : robot.n]) > 1.0 - 1e-12
    return tuple(
        Alias(f"{item.id}.EI[in_plane]", f"{SPRINGS}:{robot.actuated[j]}.stiffness")
        for j in np.flatnonzero(alike.all(axis=0))
    )


def of_reading_scale(item: Effect, _robot: Robot) -> tuple[Alias, ...]:
    """A scale is what all compliances together are."""
    return (Alias(f"{item.id}.scale", SPRINGS),)


def of_friction(item: Effect, robot: Robot) -> tuple[Alias, ...]:
    """Of an arm without weight: lost motion with the other sign, until a load is taken off.

    What the weight presses against a gear's flank never crosses the play at small loads.
    """
    if robot.total_mass > 0.0:
        return ()
    own = f"{item.id}.half_width"
    return (Alias(own, own.replace(item.name, "lost_motion"), LOADS_GROW),)


OWN: dict[str, Callable[[Any, Robot], tuple[Alias, ...]]] = {
    "force_scale": of_force_scale,
    "base_sliding": of_base_sliding,
    "link_bending": of_link_bending,
    "reading_scale": of_reading_scale,
    "friction_hysteresis": of_friction,
}
