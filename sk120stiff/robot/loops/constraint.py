"""Where two frames of a mechanism must coincide: the gap between them and its derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.robot.kinematics.chain import Chain, VirtualJoint

ELSEWHERE = -2  # the body of a virtual joint that is no part of a chain


@dataclass(frozen=True)
class Closure:
    """A closed loop that the tree of a URDF cannot hold, as `robot.yaml` states it.

    Attributes:
        name: What messages call it.
        frames: Two frames whose origins coincide.
        kind: ``point`` (a ball joint, or any pin of a planar linkage), or ``axis`` (a revolute
            pin): then the direction `axis`, the same in the axes of both frames, coincides too.
        axis: (3,) unit direction.
        dependent: Joints whose values the loop determines.
    """

    name: str
    frames: tuple[str, str]
    kind: Literal["point", "axis"]
    axis: tuple[float, float, float]
    dependent: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Gap:
    """A constraint at N poses.

    Attributes:
        value: (N, e) what must vanish [m].
        by_joint: (N, e, k) derivative by the k joints of the loop.
    """

    value: Array
    by_joint: Array
    _sides: tuple[_Swept, _Swept]

    def second(self, motion: Array) -> Array:
        """(N, e, s, s) second derivative along s directions, (N, k, s) motions of the joints."""
        k = self._sides[0].linear.shape[1]
        near, far = self._sides
        return near.curvature(motion[:, :k]) - far.curvature(motion[:, k:])


@dataclass(frozen=True, eq=False)
class Constraint:
    """The gap of one closure as a function of the joints of its loop.

    Both sides are chains from the last body that they share to the two frames; joints of that body
    and below move both sides alike and do not matter.

    Attributes:
        closure: What is closed.
        sides: Chains to the first and to the second frame; their `coordinates` index the joint
            vector.
    """

    closure: Closure
    sides: tuple[Chain, Chain]

    @cached_property
    def coordinates(self) -> Index:
        """(k,) indices of the loop's joints, first side first."""
        return np.concatenate([side.coordinates for side in self.sides])

    @cached_property
    def size(self) -> float:
        """Length round the loop [m], which says what is a small gap."""
        steps = [np.linalg.norm(side.placements[:, :3, 3], axis=1).sum() for side in self.sides]
        return float(sum(steps)) or 1.0

    def with_virtual_joints(
        self, virtual: Sequence[VirtualJoint], bodies: Sequence[str], first_index: int
    ) -> Constraint:
        """The same loop with those virtual joints in it that sit between two of its joints."""
        near, far = (_inserted(side, virtual, bodies, first_index) for side in self.sides)
        return Constraint(self.closure, (near, far))

    def gap(self, q: Array) -> Gap:
        """Gap at joint values q (N, all joints)."""
        near, far = (self._swept(side, q[:, side.coordinates]) for side in self.sides)
        return Gap(
            near.place - far.place,
            np.concatenate([near.gradient, -far.gradient], axis=2),
            (near, far),
        )

    def _swept(self, side: Chain, q: Array) -> _Swept:
        swept = side.sweep(q)
        axes, origins, rotation, position = swept[0], swept[1], swept[2], swept[3]
        turned = np.cross(axes, position[:, None, :] - origins)
        turns = side.revolute[:, None]
        linear = np.where(turns, turned, axes)
        angular = np.where(turns, axes, 0.0)
        if self.closure.kind == "point":
            return _Swept(position, linear, angular, None)
        pin = self.size * (rotation @ np.array(self.closure.axis))
        return _Swept(np.concatenate([position, pin], axis=1), linear, angular, pin)


@dataclass(frozen=True, eq=False)
class _Swept:
    """One side of a loop at N poses: place (N, 3 or 6), and unit twists (N, k, 3) at its end."""

    place: Array
    linear: Array
    angular: Array
    pin: Array | None

    @cached_property
    def gradient(self) -> Array:
        """(N, e, k) derivative of the place."""
        columns = self.linear
        if self.pin is not None:
            columns = np.concatenate([columns, self._pin_columns], axis=2)
        return np.swapaxes(columns, 1, 2)

    @cached_property
    def _pin_columns(self) -> Array:
        if self.pin is None:
            raise ValueError("a point has no direction")
        return np.cross(self.angular, self.pin[:, None, :])

    def curvature(self, motion: Array) -> Array:
        """(N, e, s, s) second derivative of the place along (N, k, s) motions.

        ∂²x/∂q_i ∂q_j = w_min(i,j) × v_max(i,j), and the same with w × pin for v of a direction.
        """
        parts = [_bent(self.angular, self.linear)]
        if self.pin is not None:
            parts.append(_bent(self.angular, self._pin_columns))
        hessian = np.concatenate(parts, axis=-1)  # (N, k, k, e)
        return np.asarray(np.einsum("nis,nije,njt->nest", motion, hessian, motion, optimize=True))


def _inserted(
    side: Chain, virtual: Sequence[VirtualJoint], bodies: Sequence[str], first_index: int
) -> Chain:
    inner = side.names[:-1]
    moved = []
    for joint in virtual:
        name = bodies[joint.body] if joint.body >= 0 else ""
        moved.append(replace(joint, body=inner.index(name) if name in inner else ELSEWHERE))
    return side.with_virtual_joints(moved, first_index)


def _bent(angular: Array, columns: Array) -> Array:
    """(N, k, k, 3) w_min(i,j) × v_max(i,j)."""
    upper = np.cross(angular[:, :, None, :], columns[:, None, :, :])
    k = angular.shape[1]
    keep = np.triu(np.ones((k, k)))[..., None]
    upper = upper * keep
    return np.asarray(upper + np.swapaxes(upper * np.triu(np.ones((k, k)), 1)[..., None], 1, 2))
