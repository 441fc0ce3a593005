"""Where a loaded elastic mechanism comes to rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.errors import Refusal
from sk120stiff.robot import Mechanism, Screws
from sk120stiff.robot.coupling import Array
from sk120stiff.stiffness.complementary import (
    complementary_stiffness,
    gravity_stiffness,
    gravity_torques,
)

#: torques (..., n) → elongations (..., n) and their derivative by the torques (..., n, n)
ElasticLaw = Callable[[Array], tuple[Array, Array]]

MAX_ITERATIONS = 60
TOLERANCE = 1e-13  # relative to one radian or one metre


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A loaded mechanism at rest.

    Attributes
    ----------
    z
        (..., n) coordinates under load [rad or m].
    screws
        Kinematics there, at the point of measurement.
    torques
        (..., n) generalised forces of the load [N·m or N].
    compliance
        (..., n, n) tangent compliance of the springs [rad/(N·m)].
    K_C
        (..., n, n) complementary stiffness of the load there [N·m/rad].
    weights
        (..., n) torques of the arm's own weight [N·m or N]; zero where it was not asked for.
    feedback
        (..., n, n) derivative of all elongations by the coordinates, C K_C and the weight's share.
    iterations
        Newton steps taken.
    """

    z: Array
    screws: Screws
    torques: Array
    compliance: Array
    K_C: Array
    weights: Array
    feedback: Array
    iterations: int


@dataclass(frozen=True, eq=False)
class Weight:
    """The arm's own weight on linear springs.

    Attributes
    ----------
    gravity
        (3,) acceleration in base axes [m/s²].
    compliance
        (n, n) or (..., n, n) compliance by which the arm sags [rad/(N·m)].
    """

    gravity: Array
    compliance: Array


def linear_springs(stiffness: ArrayLike) -> ElasticLaw:
    """The law of independent linear springs (n,) [N·m/rad]; an infinite one is rigid."""
    compliance = 1.0 / np.asarray(stiffness, dtype=float)
    matrix = np.diag(compliance)

    def law(torques: Array) -> tuple[Array, Array]:
        return torques * compliance, matrix

    return law


def equilibrium(
    mechanism: Mechanism,
    z_0: ArrayLike,
    wrench: ArrayLike,
    law: ElasticLaw,
    *,
    point: Array | None = None,
    force_point: Array | None = None,
    soft: NDArray[np.intp] | None = None,
    weight: Weight | None = None,
) -> Equilibrium:
    """Exact static equilibrium z = z_0 + e(J(z)ᵀ W) by Newton's method on compliances.

    The load is constant in base axes and moves with its point. Newton's matrix is I − C K_C, with C
    the tangent compliance: rigid coordinates (zero compliance) need no special treatment.

    Parameters
    ----------
    mechanism
        Chain and coupling, virtual joints included.
    z_0
        (..., n) unloaded coordinates.
    wrench
        (..., 6) force [N] and moment [N·m] in base axes at `force_point`.
    law
        Elongation of every coordinate for given torques.
    point, force_point
        (3,) measured point and point where the force acts, in the end frame [m]. The force acts at
        the measured point unless said otherwise.
    soft
        Indices of the coordinates that can yield under `law`; the others are not solved for.
        Default: all.
    weight
        Lets the arm sag under its own weight, with and without load.

    Raises
    ------
    Refusal
        No equilibrium was reached, or one at which the arm would not stay: the load is beyond what
        the springs can hold.
    """
    z_0 = np.asarray(z_0, dtype=float)
    load = np.asarray(wrench, dtype=float)
    batch = np.broadcast_shapes(z_0.shape[:-1], load.shape[:-1])
    z = np.broadcast_to(z_0, (*batch, z_0.shape[-1])).copy()
    loaded_point = point if force_point is None else force_point
    pick = np.arange(z.shape[-1]) if soft is None else soft
    identity = np.eye(len(pick))
    for step in range(MAX_ITERATIONS):
        screws = mechanism.screws(z, loaded_point)
        torques = screws.torques(load)
        elongation, compliance = law(torques)
        K_C = complementary_stiffness(screws, load)
        feedback = compliance @ K_C
        weights = np.zeros_like(torques)
        if weight is not None:
            weights = gravity_torques(screws, weight.gravity)
            elongation = elongation + (weight.compliance @ weights[..., None])[..., 0]
            feedback = feedback + weight.compliance @ gravity_stiffness(screws, weight.gravity)
        error = (z - z_0 - elongation)[..., pick]
        newton = identity - feedback[..., pick[:, None], pick]
        try:
            change = np.linalg.solve(newton, error[..., None])[..., 0]
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(change).all():
            break
        if np.max(np.abs(change), initial=0.0) <= TOLERANCE:
            _refuse_unstable(feedback[..., pick[:, None], pick])
            measured = screws if force_point is None else screws.at(_given(point))
            compliance = np.broadcast_to(compliance, K_C.shape)
            return Equilibrium(z, measured, torques, compliance, K_C, weights, feedback, step)
        # A step of more than half a radian would leave the region in which Newton can be trusted.
        largest = np.max(np.abs(change), axis=-1, keepdims=True, initial=0.0)
        z[..., pick] -= change * np.minimum(1.0, 0.5 / np.maximum(largest, 1e-300))
    raise _beyond("no static equilibrium was found")


def _refuse_unstable(feedback: Array) -> None:
    """Refuse a balance from which the least push makes the arm fall: C K_C with an eigenvalue ≥ 1.

    With springs K_θ = C⁻¹ that is where K_θ − K_C is no longer positive definite. A matrix whose
    Frobenius norm is below one has no such eigenvalue, so few readings are looked at closely.
    """
    doubtful = feedback[np.asarray((feedback**2).sum((-1, -2)) >= 1.0)]
    if len(doubtful) and (np.linalg.eigvals(doubtful).real >= 1.0).any():
        raise _beyond("the only static equilibrium that was found is not stable")


def _beyond(what: str) -> Refusal:
    return Refusal(
        f"{what}: the load is beyond what these springs can hold",
        remedy="Check the units of load and springs; see the critical load with "
        "'sk120stiff stiffness'.",
    )


def _given(point: Array | None) -> Array:
    return np.zeros(3) if point is None else np.asarray(point, dtype=float)
