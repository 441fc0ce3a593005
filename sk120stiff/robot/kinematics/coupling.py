"""How every joint of a robot follows the joints that motors drive.

A *coupling* maps actuated coordinates ``a`` to the values ``q`` of all moving joints, together with
the first and second derivatives that J, K_C and the equilibrium need:

    q = q(a),    G = dq/da,    H = d²q/da²

Mimic joints and parallelograms are linear, ``q = A a + b``: G = A everywhere and H vanishes. Closed
loops of any kind are in `loops`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from sk120stiff.robot.kinematics.chain import VirtualJoint


@dataclass(frozen=True, eq=False)
class Curvature:
    """Second derivative of joint values by coordinates, kept only where it is not zero.

    Attributes:
        joints: (r,) positions of the joints that bend.
        coordinates: (s,) the coordinates that bend them.
        hessian: (..., r, s, s) d²q[joints]/da[coordinates]².
    """

    joints: Index
    coordinates: Index
    hessian: Array

    def picked(self, order: Index) -> Curvature | None:
        """The same for the joints q[order], or None if none of them bends."""
        place = {int(joint): k for k, joint in enumerate(self.joints)}
        found = [(k, place[int(joint)]) for k, joint in enumerate(order) if int(joint) in place]
        if not found:
            return None
        here, there = np.array(found, dtype=np.intp).T
        return Curvature(here, self.coordinates, self.hessian[..., there, :, :])

    def along(self, coordinates: Index) -> Curvature | None:
        """The same by some coordinates a[coordinates] alone, or None if none of them bends."""
        place = {int(each): k for k, each in enumerate(self.coordinates)}
        found = [(k, place[int(each)]) for k, each in enumerate(coordinates) if int(each) in place]
        if not found:
            return None
        here, there = np.array(found, dtype=np.intp).T
        return Curvature(self.joints, here, self.hessian[..., there[:, None], there])

    def contracted(self, torques: Array, n: int) -> Array:
        """(..., n, n) Σ_k τ_k d²q_k/da² for torques (..., m) on all joints."""
        bent = np.einsum("...k,...kij->...ij", torques[..., self.joints], self.hessian)
        out = np.zeros((*bent.shape[:-2], n, n))
        out[..., self.coordinates[:, None], self.coordinates] = bent
        return out


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Values of all moving joints and their derivatives by the actuated coordinates.

    Attributes:
        q: (..., m) joint values [rad or m].
        first: (m, n) or (..., m, n): dq/da.
        second: d²q/da², or None where it vanishes identically.
    """

    q: Array
    first: Array
    second: Curvature | None = None


class Coupling(Protocol):
    """Anything that says how the joints follow the actuated coordinates."""

    @property
    def n(self) -> int:
        """Number of actuated coordinates."""

    @property
    def m(self) -> int:
        """Number of moving joints."""

    @property
    def pattern(self) -> Mask:
        """(m, n) where dq/da is not zero at every pose."""

    @property
    def bending(self) -> tuple[Index, Index]:
        """Joints and coordinates of the `Curvature`, in ascending order."""

    def motion(self, a: Array) -> JointMotion:
        """Joint values and derivatives at `a` (..., n)."""

    def with_virtual_joints(
        self, virtual: Sequence[VirtualJoint], bodies: Sequence[str]
    ) -> Coupling:
        """The coupling of coordinates [a; v] to joint values [q; v].

        `bodies` names the joints of the chain that `VirtualJoint.body` counts.
        """


@dataclass(frozen=True, eq=False)
class LinearCoupling:
    """q = A a + b, exact for mimic joints and parallelograms.

    Attributes:
        A: (m, n) multipliers.
        b: (m,) offsets [rad or m].
    """

    A: Array
    b: Array

    @property
    def n(self) -> int:
        """Number of actuated coordinates."""
        return int(self.A.shape[1])

    @property
    def m(self) -> int:
        """Number of moving joints."""
        return int(self.A.shape[0])

    @property
    def pattern(self) -> Mask:
        """See `Coupling`."""
        return np.asarray(self.A != 0.0)

    @property
    def bending(self) -> tuple[Index, Index]:
        """See `Coupling`."""
        return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)

    def motion(self, a: Array) -> JointMotion:
        """Joint values and derivatives at `a` (..., n)."""
        return JointMotion(q=a @ self.A.T + self.b, first=self.A)

    def with_virtual_joints(
        self,
        virtual: Sequence[VirtualJoint],
        bodies: Sequence[str],  # noqa: ARG002
    ) -> LinearCoupling:
        """The coupling of coordinates [a; v] to joint values [q; v], still linear."""
        m, n = self.A.shape
        A = np.zeros((m + len(virtual), n + len(virtual)))
        A[:m, :n] = self.A
        A[m:, n:] = np.eye(len(virtual))
        for k, joint in enumerate(virtual):
            for index, multiplier in joint.followers:
                A[index, n + k] += multiplier
        return LinearCoupling(A, np.append(self.b, np.zeros(len(virtual))))


@dataclass(frozen=True)
class Follower:
    """One mimic rule: value = multiplier · driver + offset."""

    driver: str
    multiplier: float
    offset: float


def linear_coupling(
    joints: Sequence[str],
    actuated: Sequence[str],
    followers: dict[str, Follower],
    rest: dict[str, float],
) -> LinearCoupling:
    """Compose mimic rules, in any order and through any chain of them, into q = A a + b.

    Args:
        joints: All moving joints, in the order of q.
        actuated: The joints whose values are the coordinates a, in their order.
        followers: Mimic rule of each coupled joint.
        rest: Value at which every remaining joint is locked; zero where it is not named.

    Raises:
        InputError: A rule names an unknown joint, or the rules run in a circle.
    """
    column = {name: k for k, name in enumerate(actuated)}
    known = set(joints)
    A = np.zeros((len(joints), len(actuated)))
    b = np.zeros(len(joints))
    for i, name in enumerate(joints):
        driver, multiplier, offset = _trace(name, column, followers, known)
        if driver in column:
            A[i, column[driver]] = multiplier
            b[i] = offset
        else:
            b[i] = multiplier * rest.get(driver, 0.0) + offset
    return LinearCoupling(A, b)


def _trace(
    name: str, column: dict[str, int], followers: dict[str, Follower], known: set[str]
) -> tuple[str, float, float]:
    """Follow mimic rules from `name` to a joint that follows nothing: (joint, factor, offset)."""
    multiplier, offset, path = 1.0, 0.0, [name]
    while path[-1] not in column and path[-1] in followers:
        rule = followers[path[-1]]
        if rule.driver not in known:
            raise InputError(
                f"this joint mimics {rule.driver!r}, which is not a moving joint",
                where=f"joint {path[-1]!r}",
                remedy=f"Moving joints are: {', '.join(sorted(known))}.",
            )
        if rule.driver in path:
            circle = " → ".join([*path[path.index(rule.driver) :], rule.driver])
            raise InputError(
                f"mimic rules run in a circle: {circle}",
                where=f"joint {path[-1]!r}",
                remedy="Remove the <mimic> of one joint of the circle.",
            )
        offset += multiplier * rule.offset
        multiplier *= rule.multiplier
        path.append(rule.driver)
    return path[-1], multiplier, offset
