"""Laws of torques as terms that a page without a server can follow: e = Σ size · shape(τ).

`page/engine.js` holds the same shapes; a test holds the two together.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Elastic, LinearElastic
from sk120stiff.effects.gear.friction import FrictionHysteresis
from sk120stiff.effects.gear.hardening import GearHardening
from sk120stiff.effects.gear.lost_motion import SIDES, LostMotion
from sk120stiff.effects.nonlinear import Nonlinear
from sk120stiff.model import ModelCompliance, probing_poses

Term = dict[str, Any]
SAME = 1e-9  # share by which the weight's torques on the chain may differ from the whole robot's


def law_terms(arm: ModelCompliance) -> list[Term] | None:
    """Terms of every gear and of all that yields out of proportion; None where a law is neither.

    Each has the coordinate `at`, its `kind` of shape with the torque where that one bends
    [N·m], the `side` on which it acts (0: both) and its size. Terms that `switch` take the torque
    of the load on the unloaded arm; those with `weight` stand under the arm's own weight first.
    """
    robot, assembly = arm.model.robot, arm.model.assembly
    names = [*robot.actuated, *(joint.name for joint in arm.mechanism.virtual)]
    found: list[list[Term]] = []
    for effect, part in zip(arm.model.effects, assembly.slices, strict=True):
        if not isinstance(effect, Elastic) or isinstance(effect, LinearElastic):
            continue
        terms = _terms(effect, arm.model.values[part])
        if terms is None or not _weighs_alike(arm):
            return None
        coordinates = [names.index(name) for name in effect.coordinates(robot)]
        found.append([term | {"at": coordinates[term["at"]]} for term in terms if term["size"]])
    return list(chain.from_iterable(found))


def _terms(effect: Elastic, values: Array) -> list[Term] | None:
    if isinstance(effect, Nonlinear):
        return list(chain.from_iterable(_out_of_proportion(effect, values)))
    if type(effect) is GearHardening and effect.sided:
        (extra,) = values  # of the negative part, which is half of τ − |τ|
        return [_term("line", 0.0, extra / 2), _term("size", 0.0, -extra / 2)]
    if type(effect) is GearHardening:  # a law built on it is another law
        sizes = values if effect.breaks else -values
        shapes = [("clip", T) for T in effect.breaks] or [("square", 0.0), ("cube", 0.0)]
        return [_term(*shape, size) for shape, size in zip(shapes, sizes, strict=True)]
    if type(effect) is LostMotion:
        sides = list(SIDES.values())[1:] if effect.sided else [0]
        places = [(T, side) for T in effect.flanks for side in sides]
        return [
            _term("tanh" if T else "sign", T, size, side, switch=True)
            for (T, side), size in zip(places, values, strict=True)
        ]
    if type(effect) is FrictionHysteresis and effect.start != "weighed":
        far = 2.0 if effect.start == "cycled" else 1.0  # after a cycle it slips a whole loop later
        return [
            _term("clip" if r else "sign", far * r, -h / (r or 1.0), switch=True, weight=False)
            for r, h in zip(effect.reaches, values, strict=True)
        ]
    return None


def _out_of_proportion(effect: Nonlinear, values: Array) -> Iterator[tuple[Term, Term]]:
    first, second = values.reshape(2, -1)
    for k, (c, d) in enumerate(zip(first, second, strict=True)):
        if effect.full:
            yield _term("line", 0.0, c, at=k), _term("rising", effect.full[k], d - c, at=k)
        else:
            yield _term("line", 0.0, (c + d) / 2, at=k), _term("size", 0.0, (c - d) / 2, at=k)


def _term(
    kind: str, torque: float, size: float, side: int = 0, *, switch: bool = False,
    weight: bool = True, at: int = 0,
) -> Term:  # fmt: skip
    return {"at": at, "kind": kind, "torque": float(torque), "size": float(size), "side": side,
            "switch": switch, "weight": weight}  # fmt: skip


def _weighs_alike(arm: ModelCompliance) -> bool:
    """Does the chain, which is all that the page has, weigh on the joints as the robot does?"""
    robot = arm.model.robot
    if not robot.total_mass:
        return True
    poses = probing_poses(robot)
    whole = robot.gravity_torque(poses)
    virtual = np.zeros((len(poses), len(arm.mechanism.virtual)))
    screws = arm.mechanism.screws(np.concatenate([poses, virtual], axis=1), arm.point)
    own = screws.gravity_torques(robot.gravity_in_base)[:, : robot.n]
    return bool(np.abs(own - whole).max() <= SAME * np.abs(whole).max())
