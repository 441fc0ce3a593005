"""Aliases as they follow from the build of an arm, before anything is measured or computed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.effects.base import Alias, Effect, Elastic, Geometric, LinearElastic
from sk120stiff.effects.catalogue import CATALOGUE, Catalogue, all_effects
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import sample_poses

SAME = 1e-6  # rad between two directions in the space of twists


def declared_aliases(robot: Robot, catalogue: Catalogue = CATALOGUE) -> tuple[Alias, ...]:
    """Aliases that follow from how the arm is built, without looking at any reading.

    Two compliances about one axis, or two errors along one slide, are one wherever they sit, if at
    every pose they move the tool alike. What effects know of themselves (`Effect.aliases`) comes on
    top.
    """
    effects = all_effects(robot, catalogue=catalogue)
    found = [
        Alias(group[0], other)
        for kind in (Elastic, Geometric)
        for group in _about_one_axis(robot, [e for e in effects if isinstance(e, kind)])
        for other in group[1:]
    ]
    for item in effects:
        found.extend(item.aliases(robot))
    return tuple(found)


def _about_one_axis(robot: Robot, effects: Sequence[Effect]) -> list[list[str]]:
    """Groups of parameters whose coordinates have parallel unit twists at all poses."""
    chosen = [
        e
        for e in effects
        if isinstance(e, Geometric) or (isinstance(e, LinearElastic) and e.one_axis_each)
    ]
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
