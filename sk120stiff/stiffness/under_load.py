"""Stiffness under load: one call and one result for one pose or very many.

Everything holds where the arm rests before the load comes (bent by its own weight where it weighs).
With J the Jacobian of the point, C = K_θ⁻¹ the compliance of the coordinates, K_C the complementary
stiffness of the load, K_g that of the arm's own weight, and K = K_θ − K_C − K_g, the Hessian of the
elastic energy minus the work of all loads::

    C_X = J K⁻¹ Jᵀ = J (I − C (K_C + K_g))⁻¹ C Jᵀ,        d = J K⁻¹ Jᵀ W.

The second form needs no K_θ: rigid coordinates have zeros in C and take no special treatment.
Very many poses go through the compiled kernel, which fills the same result with the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.stiffness.cartesian import symmetric_part
from sk120stiff.stiffness.elastic import Compliant
from sk120stiff.stiffness.kernel.folding import Fold, given
from sk120stiff.stiffness.kernel.run import compiles, run
from sk120stiff.stiffness.on_arrays import hanging, on_arrays
from sk120stiff.stiffness.principal import CLASSES, Definiteness, Principal, principal_compliance
from sk120stiff.stiffness.quantities import BY_LOAD, COMPILED, QUANTITIES, shape_of

Wanted = Collection[str]
Road = Callable[[Compliant, Array, Array, Wanted], dict[str, NDArray[Any]]]
BLOCK = 4096  # poses worked on together where NumPy has a part in it


@dataclass(frozen=True, eq=False)
class UnderLoad:
    """What was asked for, at batch shape (...); what was not asked for is None.

    With poses (N, n) and loads (Q, 1, 6) it is (Q, N) wherever the load matters and (N,) elsewhere.
    Base axes, SI; wrenches and twists are [linear; angular].

    Attributes:
        soft: (s,) indices of the coordinates that can move when a load comes.
        coordinates, loaded_coordinates: (..., n) where the arm rests before the load and, at exact
            equilibrium, under it [rad or m].
        position, rotation: (..., 3) of the point [m] and (..., 3, 3) of its frame, before the load.
        jacobian: (..., 6, n) of the point by all coordinates.
        condition: (...,) smallest over largest singular value of the position Jacobian of the
            actuated joints; 0 where a direction is lost.
        K_gravity, K_C: (..., s, s) complementary stiffness of the arm's own weight and of the load
            [N·m/rad].
        compliance: (..., 3, 3) J K⁻¹ Jᵀ of positions [m/N]; NaN where K is singular.
        compliance_conventional, compliance_enhanced: (..., 6, 6) twist of the point per wrench, J C
            Jᵀ and J K⁻¹ Jᵀ.
        values, directions: (..., 3) principal stiffness [N/m] and (..., 3, 3) unit directions, see
            `Principal`.
        stiffness_class, complementary_class: (...,) definiteness of K and of K_C in the directions
            that yield, as indices into `CLASSES`.
        critical: (...,) factor on the load at which K loses positive definiteness; infinite if it
            never does, 0 if it has none before the load comes.
        stiffening: (...,) largest share of K_θ − K_g that the load adds to it in any direction;
            what it takes away is 1 / `critical`. NaN where that one is 0.
        deflection_conventional, deflection_enhanced, deflection_second_order: (..., 3) J C Jᵀ W of
            eq. (8); J K⁻¹ Jᵀ W of eq. (10) and (11), NaN where K is not positive definite, for
            there it points to a balance that does not hold; and that with the curvature of the
            path, + ½ δᵀ H δ [m].
        deflection_equilibrium: (..., 3) at exact equilibrium [m].
    """

    soft: Index
    coordinates: Array | None = None
    loaded_coordinates: Array | None = None
    position: Array | None = None
    rotation: Array | None = None
    jacobian: Array | None = None
    condition: Array | None = None
    K_gravity: Array | None = None
    K_C: Array | None = None
    compliance: Array | None = None
    compliance_conventional: Array | None = None
    compliance_enhanced: Array | None = None
    values: Array | None = None
    directions: Array | None = None
    stiffness_class: NDArray[np.uint8] | None = None
    complementary_class: NDArray[np.uint8] | None = None
    critical: Array | None = None
    stiffening: Array | None = None
    deflection_conventional: Array | None = None
    deflection_enhanced: Array | None = None
    deflection_second_order: Array | None = None
    deflection_equilibrium: Array | None = None

    def __post_init__(self) -> None:
        batches: dict[bool, tuple[int, ...]] = {}
        n = None if self.jacobian is None else self.jacobian.shape[-1]
        for each in fields(self)[1:]:
            found = getattr(self, each.name)
            if found is None:
                continue
            last = found.shape[-1] if found.ndim else 0
            own = shape_of(each.name, last if n is None else n, len(self.soft))
            batch = found.shape[: found.ndim - len(own)]
            first = batches.setdefault(each.name in BY_LOAD, batch)
            if found.shape[len(batch) :] != own or batch != first:
                raise ValueError(f"{each.name} has shape {found.shape}, not {(*first, *own)}")

    def of(self, quantity: str) -> NDArray[Any]:
        """A quantity that was asked for.

        Raises:
            KeyError: It was not.
        """
        found = getattr(self, quantity, None)
        if found is None:
            raise KeyError(quantity)
        return np.asarray(found)

    @property
    def principal(self) -> Principal:
        """`values` and `directions`."""
        return Principal(self.of("values"), self.of("directions"))

    @property
    def stable(self) -> Mask:
        """(...,) is K positive definite, so that the pose holds under the load?"""
        return np.asarray(
            self.of("stiffness_class") == CLASSES.index(Definiteness.POSITIVE_DEFINITE)
        )

    def axes(self, formula: str, part: slice) -> Principal:
        """Principal compliances, softest first, of `compliance_conventional` or `_enhanced`.

        Args:
            formula: ``"conventional"`` or ``"enhanced"``.
            part: `POSITIONS` [m/N] or `ROTATIONS` [rad/(N·m)].
        """
        return principal_compliance(self.of(f"compliance_{formula}")[..., part, part])


POSITIONS, ROTATIONS = slice(0, 3), slice(3, 6)


def under_load(
    arm: Compliant,
    a: ArrayLike,
    wrench: ArrayLike,
    want: Collection[str] = ("position", "compliance", "values", "stiffness_class"),
    *,
    threads: int | None = None,
) -> UnderLoad:
    """Stiffness of an arm at its point, at one pose or many, under one load or many.

    Args:
        arm: What yields, and the point.
        a: (..., n_a) actuated coordinates as commanded [rad or m].
        wrench: (6,) or (..., 6) force [N] and moment [N·m] on the robot at the point, base axes;
            their batch is broadcast with that of the poses. (Q, 1, 6) are Q loads at each of N
            poses.
        want: What to compute, of `QUANTITIES`.
        threads: Number of threads of the compiled kernel; one per available core by default.

    Raises:
        InputError: Shapes do not fit, a number is not finite, or there is no such quantity.
        Refusal: An exact equilibrium was asked for and does not exist; or the springs do not hold
            the arm's own weight (at many poses, an arm with constant springs and no closed loops
            gives NaN there).
    """
    unknown = set(want) - set(QUANTITIES)
    if unknown:
        raise InputError(
            f"{', '.join(sorted(unknown))} cannot be computed",
            remedy=f"Choose from {', '.join(QUANTITIES)}.",
        )
    poses = _poses(a, arm.mechanism.coupling.n)
    load = _loads(wrench, poses.shape[:-1])
    many = poses.ndim == 2 and load.ndim < 4
    many = many and (load.ndim < 2 or load.shape[-2] in (1, len(poses)))
    folded = arm.fold if many and COMPILED.issuperset(want) else None
    road: Road = on_arrays
    if folded is not None and compiles():
        if not folded.given:
            found = run(folded, poses, load, frozenset(want), threads)
            return UnderLoad(soft=folded.soft, **found)
        road = partial(_with_given_motion, folded, threads)
    if poses.ndim == 2 and len(poses) > BLOCK:
        return UnderLoad(soft=arm.soft, **_in_blocks(road, arm, poses, load, want))
    return UnderLoad(soft=arm.soft, **road(arm, poses, load, want))


def _with_given_motion(
    folded: Fold, threads: int | None, arm: Compliant, poses: Array, load: Array, want: Wanted
) -> dict[str, NDArray[Any]]:
    """The kernel, after NumPy closed the loops, let the arm hang and evaluated its springs."""
    motion = (arm.mechanism.elastic or arm.mechanism.coupling).motion(hanging(arm, poses))
    block = (..., folded.soft[:, None], folded.soft)
    K_theta = np.zeros((0, len(folded.soft), len(folded.soft)))
    C = arm.compliance_at(poses)[block]
    if C.ndim > 2:
        if np.linalg.eigvalsh(symmetric_part(C)).min(initial=np.inf) <= 0.0:
            return on_arrays(arm, poses, load, want)  # no springs make such a compliance
        K_theta = np.asarray(np.linalg.inv(symmetric_part(C)))
    more = given(folded, arm.mechanism, motion, K_theta)
    q = np.ascontiguousarray(motion.q[:, arm.mechanism.chain.coordinates])
    return run(folded, q, load, frozenset(want), threads, more)


def _in_blocks(
    road: Road, arm: Compliant, poses: Array, load: Array, want: Wanted
) -> dict[str, NDArray[Any]]:
    each = load.ndim > 1 and load.shape[-2] > 1  # a load of its own for every pose
    parts = [
        road(
            arm,
            poses[k : k + BLOCK],
            load[..., k : k + BLOCK, :] if each else load,
            want,
        )
        for k in range(0, len(poses), BLOCK)
    ]
    several = load.ndim > 2
    return {
        name: np.concatenate(
            [part[name] for part in parts], axis=1 if several and name in BY_LOAD else 0
        )
        for name in want
    }


def _poses(a: ArrayLike, n: int) -> Array:
    poses = np.ascontiguousarray(a, dtype=float)
    if poses.shape[-1:] != (n,):
        raise InputError(
            f"poses of shape {poses.shape} given, but this mechanism has {n} actuated coordinates",
            remedy=f"Give an array of shape (N, {n}).",
        )
    # The extremes tell in one pass without copies; only a doubt looks at each pose.
    if poses.size and not np.isfinite(poses.max() - poses.min()):
        lost = np.argwhere(~np.isfinite(poses).all(axis=-1))
        if len(lost):
            which = ", ".join(str(k) for k in lost[0])
            raise InputError(
                "a joint coordinate is not a finite number", where=f"pose {which}".strip()
            )
    return poses


def _loads(wrench: ArrayLike, batch: tuple[int, ...]) -> Array:
    given = np.asarray(wrench, dtype=float)
    if given.shape == (3,):
        given = np.concatenate([given, np.zeros(3)])
    fits = given.shape[-1:] == (6,)
    try:
        np.broadcast_shapes(given.shape[:-1], batch)
    except ValueError:
        fits = False
    if not fits:
        raise InputError(
            f"loads of shape {given.shape} given for poses of shape {batch}",
            remedy="Give (6,), one for each of N poses (N, 6), or (Q, 1, 6) for Q loads at each.",
        )
    if not np.isfinite(given).all():
        raise InputError("a load is not a finite number", remedy="Check forces and moments.")
    return given
