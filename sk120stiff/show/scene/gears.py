"""Laws of gears as terms that a page without a server can follow: e = Σ size · shape(τ).

`page/engine.js` holds the same shapes; a test holds the two together.
"""

from __future__ import annotations

from itertools import chain
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Elastic, LinearElastic
from sk120stiff.effects.gear.friction import FrictionHysteresis
from sk120stiff.effects.gear.hardening import GearHardening
from sk120stiff.effects.gear.lost_motion import SIDES, LostMotion
from sk120stiff.model import ModelCompliance, probing_poses

Term = dict[str, Any]
SAME = 1e-9  # share by which the weight's torques on the chain may differ from the whole robot's


def gear_terms(arm: ModelCompliance) -> list[Term] | None:
    """Terms of every gear; None where a law is none of them.

    Each has the coordinate `at`, its `kind` of shape with the torque where that one bends
    [N·m], the `side` on which it acts (0: both) and its size. Terms that `switch` take the torque
    of the load on the unloaded arm; those with `weight` stand under the arm's own weight first.
    """
    robot, assembly = arm.model.robot, arm.model.assembly
    found: list[list[Term]] = []
    for effect, part in zip(arm.model.effects, assembly.slices, strict=True):
        if not isinstance(effect, Elastic) or isinstance(effect, LinearElastic):
            continue
        terms = _terms(effect, arm.model.values[part])
        if terms is None or not _weighs_alike(arm):
            return None
        at = robot.actuated.index(effect.where)
        found.append([{"at": at, **term} for term in terms if term["size"]])
    return list(chain.from_iterable(found))


def _terms(effect: Elastic, values: Array) -> list[Term] | None:
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
    if type(effect) is FrictionHysteresis:
        return [
            _term("clip" if r else "sign", r, -h / (r or 1.0), switch=True, weight=False)
            for r, h in zip(effect.reaches, values, strict=True)
        ]
    return None


def _term(
    kind: str, torque: float, size: float, side: int = 0, *, switch: bool = False,
    weight: bool = True,
) -> Term:  # fmt: skip
    return {"kind": kind, "torque": float(torque), "size": float(size), "side": side,
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
