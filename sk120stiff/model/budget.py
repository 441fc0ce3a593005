"""What each effect of a model moves the point by: the shares of an error budget.

To first order a displacement is the sum of what every parameter brings, d = Σ_p (∂d/∂p) v_p, with
v_p the internal value, which is zero where the effect is absent. The parts add as vectors, and so
their sizes need not add up: springs and tilts may pull opposite ways.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.effects import Elastic
from sk120stiff.model.model import Model

ROUNDING = 1e-9  # m: what moves the point by less does not move it


@dataclass(frozen=True)
class Share:
    """What one effect brings.

    Attributes:
        name: ``name:where``.
        rms: Of the displacements that it brings, per axis [m].
        std: Standard error of `rms` [m]; None where nothing tells it.
        members: Of a sum the ids of its effects.
    """

    name: str
    rms: float
    std: float | None
    members: tuple[str, ...] = ()


def moved_by(model: Model, derivative: Array, effects: Collection[str]) -> Array:
    """(N, 3) what some effects of a model bring together [m].

    Args:
        derivative: (N, 3, P) of the displacements by the internal values.
        effects: Their ids, ``name:where``.
    """
    own = np.array([parameter.effect.id in effects for parameter in model.parameters], dtype=bool)
    return np.asarray(derivative[:, :, own] @ model.values[own])


def shares(model: Model, derivative: Array, covariance: Array | None) -> tuple[Share, ...]:
    """Shares of all effects of a model, the largest first.

    Args:
        derivative: (N, 3, P) of the displacements by the internal values.
        covariance: (P, P) of the internal values; None: unknown.
    """
    ids = [parameter.effect.id for parameter in model.parameters]
    found = []
    for name in dict.fromkeys(ids):
        own = np.array([k for k, other in enumerate(ids) if other == name])
        part = None if covariance is None else covariance[np.ix_(own, own)]
        moved = moved_by(model, derivative, {name})
        found.append(_share(name, moved, derivative[:, :, own], part))
    return tuple(sorted(found, key=lambda share: -share.rms))


def joint_shares(model: Model, derivative: Array, covariance: Array | None) -> tuple[Share, ...]:
    """What all that yields at one joint brings together, the largest first.

    Spring, gear and bearing of a joint trade with one another: their sum is known where the parts
    are not, and its standard error is that of the sum.

    Args:
        derivative, covariance: As in `shares`.
    """
    ids = [parameter.effect.id for parameter in model.parameters]
    found = []
    for joint, members in at_joints(model).items():
        own = np.array([k for k, other in enumerate(ids) if other in members])
        part = None if covariance is None else covariance[np.ix_(own, own)]
        whole = _share(joint, moved_by(model, derivative, members), derivative[:, :, own], part)
        found.append(replace(whole, members=members))
    return tuple(sorted(found, key=lambda share: -share.rms))


def at_joints(model: Model) -> dict[str, tuple[str, ...]]:
    """Joint → ids of what yields there: its spring, the laws of its gear, its bearing."""
    joints = model.robot.actuated
    yielding = [e for e in model.effects if isinstance(e, Elastic) and e.where in joints]
    found = {joint: tuple(e.id for e in yielding if e.where == joint) for joint in joints}
    return {joint: members for joint, members in found.items() if members}


def with_own_errors(sums: Sequence[Share], within: Sequence[Share]) -> tuple[Share, ...]:
    """Sums with the standard errors of others, where these have more than one member.

    Args:
        sums: With all that is uncertain about each part.
        within: The same sums without what other laws would make of their parts: the parts change
            places then, and the sum stays.
    """
    other = {share.name: share.std for share in within}
    return tuple(
        replace(share, std=other[share.name]) if len(share.members) > 1 else share for share in sums
    )


def _share(name: str, moved: Array, columns: Array, covariance: Array | None) -> Share:
    """Size of what some parameters bring (N, 3): columns (N, 3, p), covariance (p, p)."""
    size = rms(moved)
    if size < ROUNDING:
        return Share(name, 0.0, 0.0)
    if covariance is None or not np.isfinite(covariance).all():
        return Share(name, size, None)
    slope = np.einsum("ni,nip->p", moved, columns) / (moved.size * size)
    return Share(name, size, float(np.sqrt(max(slope @ covariance @ slope, 0.0))))
