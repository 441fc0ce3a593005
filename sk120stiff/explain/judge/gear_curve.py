"""The curve of a gear as it was found: twist against torque, with its band, beside the plain law.

People recognise a gear by its curve. The found one is the sum of the joint's spring and of all that
was named at its gear, run on a bench: the torque grows from zero to the largest that was measured,
falls to the largest of the other sign and grows back. A loop is friction, a step is play, a bend
is a gear that stiffens. Beside it stands the plain law of the catalogue that comes nearest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Elastic, LoadCases, Options
from sk120stiff.effects.gear.law import GearEffect
from sk120stiff.identify import Fit
from sk120stiff.identify.checks.left_over import orthonormal

STEPS = 60  # of the torque between zero and its largest
SEEN = (
    0.5  # share of the longest lever of the joint below which a reading tells little of its twist
)


@dataclass(frozen=True, eq=False)
class GearCurve:
    """Twist of one joint under its torque.

    Attributes:
        where: The joint.
        names: Effects that were named at its gear.
        torque: (K,) on the bench, in the order in which it is applied [N·m].
        twist, band: (K,) the found curve and half its 95 % interval [rad]; None where nothing
            tells an interval.
        compliance: Of the joint's spring, which is part of the curve [rad/(N·m)].
        ideal: (K,) the plain law of the first name that comes nearest [rad].
        measured: (M, 2) torque [N·m] and twist [rad] of the readings that tell of this joint: the
            found law at the reading and what the whole model leaves of it, over the joint's lever.
    """

    where: str
    names: tuple[str, ...]
    torque: Array
    twist: Array
    compliance: float
    band: Array | None
    ideal: Array
    measured: Array


def gear_curves(fit: Fit, named: Sequence[str]) -> tuple[GearCurve, ...]:
    """The curves of all gears at which something was named.

    Args:
        fit: The fitted model.
        named: Ids of the named effects.
    """
    gears = [e for e in fit.model.effects if isinstance(e, GearEffect) and e.id in named]
    joints = dict.fromkeys(effect.where for effect in gears)
    return tuple(_curve(fit, where, [e for e in gears if e.where == where]) for where in joints)


def _curve(fit: Fit, where: str, gears: Sequence[GearEffect]) -> GearCurve:
    load_cases = fit.problem.load_cases
    springs = [e for e in fit.model.effects if e.joint_spring and e.where == where]
    parts = [e for e in (*springs, *gears) if isinstance(e, Elastic)]
    bench, applied = _bench(load_cases, gears[0].largest_torque(load_cases))
    shapes = np.hstack([_shapes(part, applied, bench) for part in parts])
    own = np.array([p.effect in parts for p in fit.model.parameters])
    twist = shapes @ fit.model.values[own]
    plain = type(gears[0]).at(load_cases.robot, where, Options())
    ideal = orthonormal(np.hstack([applied, _shapes(plain, applied, bench)]))
    return GearCurve(
        where=where,
        names=tuple(effect.id for effect in gears),
        torque=applied[:, 0],
        twist=twist,
        compliance=float(sum(p.internal for p in fit.model.parameters if p.effect in springs)),
        band=_band(fit, shapes, own),
        ideal=ideal @ (ideal.T @ twist),
        measured=_measured(fit, gears[0], parts),
    )


def _shapes(effect: Elastic, torque: Array, bench: LoadCases) -> Array:
    """(K, p) twist per unit of each parameter; laws of gears are linear in these."""
    count = len(effect.parameters)
    return effect.elongation(torque, bench, np.zeros(count)).by_parameter[:, 0, :]


def _band(fit: Fit, shapes: Array, own: Array) -> Array | None:
    problem = fit.problem
    covariance = np.zeros((len(own), len(own)))
    covariance[np.ix_(problem.free, problem.free)] = fit.covariance * np.outer(
        problem.scale, problem.scale
    )
    part = covariance[np.ix_(own, own)]
    if not np.isfinite(part).all():
        return None
    variance = np.einsum("kp,pq,kq->k", shapes, part, shapes)
    return np.asarray(fit.reach() * np.sqrt(np.maximum(variance, 0.0)))


def _bench(load_cases: LoadCases, largest: float) -> tuple[LoadCases, Array]:
    """One joint on a bench: readings of one pose without weight, their torques (K, 1) [N·m]."""
    up = np.linspace(0.0, 1.0, STEPS)
    way = np.concatenate([up, up[-2::-1], -up[1:], -up[-2::-1], up[1:]]) * largest
    rising = np.concatenate([[1.0], np.diff(np.abs(way))])
    first = load_cases.rows(np.zeros(len(way), dtype=np.intp))
    return _weightless(first, rising, np.zeros(len(way), dtype=np.intp)), way[:, None]


def _weightless(load_cases: LoadCases, rising: Array, pose: Index) -> LoadCases:
    """The same readings of an arm without weight, at these poses (N,), one after the other."""
    return replace(
        load_cases,
        robot=replace(load_cases.robot, gravity=np.zeros(3)),
        order=np.arange(1.0, load_cases.count + 1.0),
        time=None,
        branch=np.where(rising < 0.0, -1.0, 1.0),
        pose=pose,
        poses=tuple(str(k) for k in np.unique(pose)),
        zero_group=pose,
        repeat=None,
    )


def _measured(fit: Fit, gear: GearEffect, parts: Sequence[Elastic]) -> Array:
    """(M, 2) total torque and twist of the readings whose point the joint moves well."""
    load_cases = fit.problem.load_cases
    lever = load_cases.nominal.linear_jacobian[:, :, load_cases.robot.actuated.index(gear.where)]
    read = fit.problem.read
    lever = np.where(read, np.einsum("nij,ni->nj", load_cases.reading_axes, lever), 0.0)
    gap = np.where(read, fit.problem.measured - fit.model.predict(load_cases), 0.0)
    square = (lever**2).sum(axis=1)
    told = square > SEEN**2 * square.max(initial=0.0)
    twist = (lever * gap).sum(axis=1) / np.where(told, square, 1.0)
    load, weight = gear.load_torque(load_cases), gear.weight_torque(load_cases)
    count = load_cases.count
    alone = _weightless(load_cases, np.ones(count), np.arange(count, dtype=np.intp))
    for part in parts:  # from no torque at all to the weight's, and from there to the load's
        values = fit.model.values[[p.effect == part for p in fit.model.parameters]]
        twist = twist + _shapes(part, weight, alone) @ values
        twist = twist + part.elongation(load, load_cases, values).value[:, 0]
    return np.asarray(np.stack([(load + weight)[:, 0], twist], axis=1)[told])
