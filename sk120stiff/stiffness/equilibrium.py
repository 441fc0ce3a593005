"""Where a loaded elastic mechanism comes to rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import Refusal
from sk120stiff.robot import Mechanism, Screws
from sk120stiff.stiffness.cartesian import (
    complementary_stiffness,
    follower_stiffness,
    gravity_stiffness,
)
from sk120stiff.stiffness.wrench import rotate

#: torques (..., n) → elongations (..., n) and their derivative by the torques (..., n, n)
ElasticLaw = Callable[[Array], tuple[Array, Array]]

MAX_ITERATIONS = 60
TOLERANCE = 1e-13  # relative to one radian or one metre
LONGEST_STEP = 0.5  # rad or m: beyond it Newton cannot be trusted
FOLLOWED_ITERATIONS, FOLLOWED_TOLERANCE = 6, 1e-9  # of Newton at one step of the load
FIRST_STEP, LEAST_STEP = 0.25, 1e-4  # of the load
SHRINK, GROW = 0.25, 2.0  # of the step, after it failed and after it held
SMALL = 0.01  # of the load: such shares are told as small
SEE_CRITICAL = "See the critical load with 'sk120stiff stiffness'."
FARTHEST = np.pi  # rad or m from the unloaded pose: no linear spring means more


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A loaded mechanism at rest.

    Attributes:
        z: (..., n) coordinates under load [rad or m].
        screws: Kinematics there, at the point of measurement.
        torques: (..., n) generalised forces of the load [N·m or N].
        compliance: (..., n, n) tangent compliance of the springs [rad/(N·m)].
        weights: (..., n) torques of the arm's own weight [N·m or N]; zero where it was not asked
            for.
        pulled: Kinematics at the point where the force acts.
        load: (..., 6) the load there, base axes [N, N·m].
        following: (..., 6) the part of it that turns with the end frame, or None.
        weight: The arm's own weight, if it was asked for.
        iterations: Newton steps taken.
    """

    z: Array
    screws: Screws
    torques: Array
    compliance: Array
    weights: Array
    pulled: Screws
    load: Array
    following: Array | None
    weight: Weight | None
    iterations: int

    @cached_property
    def K_C(self) -> Array:
        """(..., n, n) derivative of the load's torques by the coordinates there [N·m/rad]."""
        return _load_stiffness(self.pulled, self.load, self.following)

    def feedback(self, rows: Index) -> Array:
        """(..., r, n) derivative of r elongations by all coordinates: C K_C, the weight's share.

        The r coordinates are those that yield at all.
        """
        own = (..., rows[:, None], rows)
        out = self.compliance[own] @ _load_stiffness(self.pulled, self.load, self.following, rows)
        if self.weight is not None:
            hanging = gravity_stiffness(self.pulled, self.weight.gravity, rows)
            out = out + self.weight.compliance[own] @ hanging
        return out

    def adjoint(self, J: Array, soft: Index) -> Array:
        """(N, k, n) J (I − ∂e/∂z)⁻¹ for J (N, k, n), solved in the soft coordinates only.

        With Y = J (I − ∂e/∂z)⁻¹: Y = J + Y ∂e/∂z, and ∂e/∂z has rows of soft coordinates only.
        """
        if not len(soft):
            return J
        rows = self.feedback(soft)
        newton = np.eye(len(soft)) - rows[..., soft]
        right = np.swapaxes(J[..., soft], -1, -2)
        Y_soft = np.swapaxes(np.linalg.solve(np.swapaxes(newton, -1, -2), right), -1, -2)
        return np.asarray(J + Y_soft @ rows)


@dataclass(frozen=True, eq=False)
class Weight:
    """The arm's own weight on linear springs.

    Attributes:
        gravity: (3,) acceleration in base axes [m/s²].
        compliance: (n, n) or (..., n, n) compliance by which the arm sags [rad/(N·m)].
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
    follower: Array | None = None,
    soft: Index | None = None,
    weight: Weight | None = None,
    near: Array | None = None,
) -> Equilibrium:
    """Exact static equilibrium z = z_0 + e(J(z)ᵀ W) by Newton's method on compliances.

    The load moves with its point. It is constant in base axes, but for a `follower`, which turns
    with the end frame: W(z) = W + R(z) W_end. Newton's matrix is I − C (K_C + K_F), with C the
    tangent compliance and K_F from what follows alone: rigid coordinates (zero compliance) need no
    special treatment.

    Of several equilibria the one is meant at which the arm comes to rest as the load grows from
    zero. Newton's method finds it by itself while I − C K_C stays positive on its way; elsewhere
    the load is followed in steps (natural continuation; Allgower & Georg 1990, ch. 2).

    Args:
        mechanism: Chain and coupling, virtual joints included.
        z_0: (..., n) unloaded coordinates.
        wrench: (..., 6) force [N] and moment [N·m] in base axes at `force_point`.
        law: Elongation of every coordinate for given torques.
        point, force_point: (3,) measured point and point where the force acts, in the end frame
            [m]. The force acts at the measured point unless said otherwise.
        follower: (..., 6) force and moment in axes of the end frame, at `force_point`, besides.
        soft: Indices of the coordinates that can yield under `law`; the others are not solved for.
            Default: all.
        weight: Lets the arm sag under its own weight, with and without load.
        near: (..., n) where it is known to come to rest, up to rounding; found from `z_0` without.

    Raises:
        Refusal: On the way from zero load the arm loses its balance, or a joint goes farther than
            half a turn: the load is beyond what the springs can hold.
    """
    start = np.asarray(z_0, dtype=float)
    load = np.asarray(wrench, dtype=float)
    batch = np.broadcast_shapes(start.shape[:-1], load.shape[:-1])
    start = np.broadcast_to(start, (*batch, start.shape[-1]))
    pick = np.arange(start.shape[-1]) if soft is None else soft
    loaded_point = point if force_point is None else force_point
    statics = _Statics(mechanism, start, load, law, loaded_point, pick, weight, follower)
    full = np.ones(batch)
    begin = start if near is None else near
    z, trusted, state, steps = statics.newton(begin.copy(), full, full)
    if not trusted.all():
        z, trusted, state, steps = statics.newton(_followed(statics, z, trusted), full, full)
    if not trusted.all():
        raise _beyond(1.0)
    screws = state.screws if force_point is None else state.screws.at(_given(point))
    compliance = np.broadcast_to(state.compliance, (*z.shape, z.shape[-1]))
    following = None if follower is None else rotate(screws.rotation, follower)
    return Equilibrium(
        z, screws, state.torques, compliance, state.weights, state.screws,
        load if following is None else load + following, following, weight, steps,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _State:
    """What holds at coordinates z.

    Of the s that yield, `error` (..., s) is what they are off, and `feedback` (..., s, s) the
    derivative of their elongations by themselves.
    """

    screws: Screws
    torques: Array
    compliance: Array
    weights: Array
    feedback: Array
    error: Array


@dataclass(frozen=True, eq=False)
class _Statics:
    """An equilibrium problem whose load and weight can be taken in part."""

    mechanism: Mechanism
    z_0: Array
    load: Array
    law: ElasticLaw
    point: Array | None
    pick: Index
    weight: Weight | None
    follower: Array | None

    def at(self, z: Array, loaded: Array, hung: Array) -> _State:
        """The state at z under shares (...,) of the load and of the weight."""
        share, heavy = loaded[..., None], hung[..., None]
        load, following = self.load * share, None
        screws = self.mechanism.screws(z, self.point)
        if self.follower is not None:
            following = rotate(screws.rotation, self.follower) * share
            load = load + following
        torques = screws.torques(load)
        elongation, compliance = self.law(torques)
        yielding = screws.alone(self.pick)
        own = (..., self.pick[:, None], self.pick)
        feedback = compliance[own] @ _load_stiffness(yielding, load, following)
        weights = np.zeros_like(torques)
        if self.weight is not None:
            sag, gravity = self.weight.compliance, self.weight.gravity
            weights = screws.gravity_torques(gravity) * heavy
            elongation = elongation + (sag @ weights[..., None])[..., 0]
            hanging = gravity_stiffness(yielding, gravity) * heavy[..., None]
            feedback = feedback + sag[own] @ hanging
        error = (z - self.z_0 - elongation)[..., self.pick]
        return _State(screws, torques, compliance, weights, feedback, error)

    def newton(
        self,
        z: Array,
        loaded: Array,
        hung: Array,
        iterations: int = MAX_ITERATIONS,
        tolerance: float = TOLERANCE,
    ) -> tuple[Array, Mask, _State, int]:
        """Coordinates from z on, where they can be trusted (...,), their state, the steps taken.

        Not to be trusted is an answer that did not settle, or on the way to which the balance was
        not stable. Rows without hope stay where they lost it.
        """
        pick = self.pick
        identity = np.eye(len(pick))
        good = np.ones(z.shape[:-1], dtype=bool)
        for step in range(iterations + 1):
            state = self.at(z, loaded, hung)
            inner = state.feedback
            good = good & _stable(inner) & np.isfinite(state.error).all(axis=-1)
            if not good.any():
                break
            matrix = np.where(good[..., None, None], identity - inner, identity)
            error = np.where(good[..., None], state.error, 0.0)
            change = np.linalg.solve(matrix, error[..., None])[..., 0]
            largest = np.max(np.abs(change), axis=-1, keepdims=True, initial=0.0)
            if np.max(largest, initial=0.0) <= tolerance:
                break
            if step == iterations:
                good = good & (largest[..., 0] <= tolerance)
                break
            z[..., pick] -= change * np.minimum(1.0, LONGEST_STEP / np.maximum(largest, 1e-300))
        return z, good, state, step


def _load_stiffness(
    screws: Screws, load: Array, following: Array | None, rows: Index | None = None
) -> Array:
    """∂(Jᵀ W)/∂z (..., r, n) of a load a part of which turns with the end frame."""
    K = complementary_stiffness(screws, load, rows)
    return K if following is None else K + follower_stiffness(screws, following, rows)


def _followed(statics: _Statics, found: Array, trusted: Mask) -> Array:
    """Coordinates (..., n) on the way from no weight and no load: first the weight, then the load.

    Rows that are trusted keep what was found. The steps of the others shrink where the balance
    would be lost; it is, where even the least step loses it.
    """
    z = np.where(trusted[..., None], found, statics.z_0)
    legs = 2.0 if statics.weight is not None else 1.0
    way = np.where(trusted, legs, 0.0)
    stride = np.full(way.shape, FIRST_STEP)

    brief = (FOLLOWED_ITERATIONS, FOLLOWED_TOLERANCE)

    def shares(at: Array) -> tuple[Array, Array]:
        return np.clip(at - (legs - 1.0), 0.0, 1.0), np.clip(at, 0.0, 1.0)

    # The unloaded arm stands where its law says that it does (lost motion is taken up at once).
    z, good, _, _ = statics.newton(z.copy(), *shares(way), *brief)
    while good.all() and (way < legs).any():
        ahead = np.minimum(way + stride, np.where(way < legs - 1.0, legs - 1.0, legs))
        tried, held, _, _ = statics.newton(z.copy(), *shares(ahead), *brief)
        held &= np.abs(tried - z).max(axis=-1, initial=0.0) <= LONGEST_STEP
        held &= np.abs(tried - statics.z_0).max(axis=-1, initial=0.0) <= FARTHEST
        z = np.where(held[..., None], tried, z)
        way = np.where(held, ahead, way)
        stride = stride * np.where(held, GROW, SHRINK)
        good = held | (stride > LEAST_STEP)
    if good.all():
        return z
    reached = float(way[~good].min())
    if reached < legs - 1.0:
        raise Refusal(
            f"the arm falls under its own weight, at {reached:.3g} of it: these springs cannot "
            "hold it",
            remedy="Check masses, gravity and springs.",
        )
    raise _beyond(reached - (legs - 1.0))


def _stable(feedback: Array) -> Mask:
    """(...,) does the arm stay when pushed a little: has C K_C no eigenvalue ≥ 1?

    With springs K_θ = C⁻¹ that is where K_θ − K_C is positive definite. A matrix whose Frobenius
    norm is below one has no such eigenvalue, so few readings are looked at closely.
    """
    size = np.asarray((feedback**2).sum((-1, -2)))
    stable = np.asarray(size < 1.0)
    close = ~stable & np.isfinite(size)
    if close.any():
        stable[close] = (np.linalg.eigvals(feedback[close]).real < 1.0).all(axis=-1)
    return stable


def _beyond(reached: float) -> Refusal:
    # Below SMALL the steps are no finer than the share itself.
    share = f"at {reached:.3g} of" if reached >= SMALL else f"at less than {SMALL:g} of"
    return Refusal(
        f"no static equilibrium: followed from zero, the arm gives way {share} this load, which is "
        "beyond what these springs can hold",
        remedy=f"Check the units of load and springs. {SEE_CRITICAL}",
    )


def _given(point: Array | None) -> Array:
    return np.zeros(3) if point is None else np.asarray(point, dtype=float)
