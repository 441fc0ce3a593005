"""How every joint of a robot follows the joints that motors drive.

A *coupling* maps actuated coordinates ``a`` to the values ``q`` of all moving joints, together with
the first and second derivatives that J, K_C and the equilibrium need:

    q = q(a),    G = dq/da,    H = d²q/da²

Mimic joints and parallelograms are linear, ``q = A a + b``: G = A everywhere and H vanishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sk120stiff.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Values of all moving joints and their derivatives by the actuated coordinates.

    Attributes
    ----------
    q
        (..., m) joint values [rad or m].
    first
        (m, n) or (..., m, n): dq/da.
    second
        (..., m, n, n): d²q/da², or None where it vanishes identically.
    """

    q: Array
    first: Array
    second: Array | None = None


class Coupling(Protocol):
    """Anything that says how the joints follow the actuated coordinates."""

    @property
    def n(self) -> int:
        """Number of actuated coordinates."""

    def motion(self, a: Array) -> JointMotion:
        """Joint values and derivatives at `a` (..., n)."""


@dataclass(frozen=True, eq=False)
class LinearCoupling:
    """q = A a + b, exact for mimic joints and parallelograms.

    Attributes
    ----------
    A
        (m, n) multipliers.
    b
        (m,) offsets [rad or m].
    """

    A: Array
    b: Array

    @property
    def n(self) -> int:
        """Number of actuated coordinates."""
        return int(self.A.shape[1])

    def motion(self, a: Array) -> JointMotion:
        """Joint values and derivatives at `a` (..., n)."""
        return JointMotion(q=a @ self.A.T + self.b, first=self.A)


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

    Parameters
    ----------
    joints
        All moving joints, in the order of q.
    actuated
        The joints whose values are the coordinates a, in their order.
    followers
        Mimic rule of each coupled joint.
    rest
        Value at which every remaining joint is locked; zero where it is not named.

    Raises
    ------
    InputError
        A rule names an unknown joint, or the rules run in a circle.
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
