"""What yields: a mechanism, the compliance of its coordinates, and the point that is looked at."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness.cartesian import symmetric_part
from sk120stiff.stiffness.equilibrium import ElasticLaw, Weight
from sk120stiff.stiffness.kernel.folding import Fold, fold

ZERO = 1e-12  # share of the largest below which a principal compliance is a rigid direction


class Compliant(Protocol):
    """An arm that yields, seen from a point: what `under_load` asks of it.

    Poses come as rows (N, n_a) of actuated coordinates, commanded and without any load.
    """

    @property
    def mechanism(self) -> Mechanism:
        """Chain and coupling to the frame of the point."""

    @property
    def point(self) -> Array:
        """(3,) in the end frame [m]; the load acts there too."""

    @property
    def soft(self) -> Index:
        """Indices of the coordinates that can move when a load comes."""

    @property
    def fold(self) -> Fold | None:
        """Constants of the compiled kernel, or None where it does not follow this arm."""

    def start(self, a: Array) -> Array:
        """(N, n) coordinates before load and weight come [rad or m]."""

    def compliance_at(self, a: Array) -> Array:
        """(n, n) or (N, n, n) tangent compliance under small loads, rigid coordinates zero."""

    def weight_at(self, a: Array) -> Weight | None:
        """The arm's own weight and what yields to it; None where nothing weighs."""

    def law(self, a: Array, wrench: Array) -> ElasticLaw:
        """Elongations under loads (N, 6), whatever their size."""


@dataclass(frozen=True, eq=False)
class ConstantCompliance:
    """Linear springs: the same compliance at every pose and under every load.

    Attributes:
        mechanism: Chain and coupling to the frame of the point; n coordinates, virtual joints
            included.
        compliance: (n, n) symmetric compliance [rad/(N·m) or m/N]; zero rows where a coordinate is
            rigid.
        point: (3,) in the end frame [m].
        shift: (n,) by which the coordinates start from elsewhere than commanded [rad or m].
        gravity: (3,) acceleration in base axes by which the arm hangs [m/s²]; None: its weight is
            left out.
    """

    mechanism: Mechanism
    compliance: Array
    point: Array = field(default_factory=lambda: np.zeros(3))
    shift: Array = field(default_factory=lambda: np.zeros(0))
    gravity: Array | None = None

    def __post_init__(self) -> None:
        n = self.mechanism.n
        if not self.shift.size:
            object.__setattr__(self, "shift", np.zeros(n))
        if self.compliance.shape != (n, n) or self.shift.shape != (n,):
            raise InputError(
                f"a compliance of shape {self.compliance.shape} and a shift of shape "
                f"{self.shift.shape} given for {n} coordinates"
            )
        if not np.isfinite(self.compliance).all():
            raise InputError("a compliance is not a finite number")
        if self.point.shape != (3,) or not np.isfinite(self.point).all():
            raise InputError(
                "the point is not three finite numbers", remedy="Give x, y, z in metres."
            )

    @classmethod
    def of_springs(
        cls,
        robot: Robot | Mechanism,
        springs: ArrayLike,
        *,
        frame: str | None = None,
        point: ArrayLike | None = None,
        virtual: ArrayLike | None = None,
        gravity: ArrayLike | None = None,
    ) -> ConstantCompliance:
        """The arm with springs.

        Args:
            robot: A robot, or a mechanism with its virtual joints.
            springs: (n,) spring of every coordinate [N·m/rad or N/m], infinite where rigid; or (n,
                n) their symmetric K_θ, infinite on the diagonal where rigid.
            frame: Frame that carries the point, for a robot; its tool frame by default.
            point: (3,) in that frame [m]; its origin by default.
            virtual: (n_v,) where the virtual joints stand [rad or m]; zero by default.
            gravity: (3,) in base axes [m/s²]; none by default.

        Raises:
            InputError: Shapes do not fit, or the springs are no positive definite stiffness.
        """
        mechanism = robot.mechanism(frame) if isinstance(robot, Robot) else robot
        shift = np.zeros(mechanism.n)
        if virtual is not None:
            shift[mechanism.coupling.n :] = virtual
        return cls(
            mechanism,
            _compliance_of(np.asarray(springs, dtype=float), mechanism.n),
            np.zeros(3) if point is None else np.asarray(point, dtype=float),
            shift,
            None if gravity is None else np.asarray(gravity, dtype=float),
        )

    @cached_property
    def soft(self) -> Index:
        """See `Compliant`."""
        return np.flatnonzero(self.compliance.any(axis=0))

    @cached_property
    def fold(self) -> Fold | None:
        """See `Compliant`: compliances that springs can make."""
        K_theta = stiffness_of(self.compliance)[np.ix_(self.soft, self.soft)]
        if not are_springs(K_theta):
            return None
        return fold(self.mechanism, self.soft, K_theta, self.point, self.shift, self.gravity)

    def start(self, a: Array) -> Array:
        """See `Compliant`."""
        virtual = np.zeros((*a.shape[:-1], len(self.mechanism.virtual)))
        return np.asarray(np.concatenate([a, virtual], axis=-1) + self.shift)

    def compliance_at(self, a: Array) -> Array:  # noqa: ARG002
        """See `Compliant`."""
        return self.compliance

    def weight_at(self, a: Array) -> Weight | None:  # noqa: ARG002
        """See `Compliant`."""
        if self.gravity is None or not self.mechanism.chain.weighs:
            return None
        return Weight(self.gravity, self.compliance)

    def law(self, a: Array, wrench: Array) -> ElasticLaw:  # noqa: ARG002
        """See `Compliant`."""
        return lambda torques: (torques @ self.compliance, self.compliance)


def stiffness_of(compliance: Array) -> Array:
    """(n, n) K_θ of a symmetric compliance, infinite on the diagonal where nothing yields.

    What yields is NaN where some of it does so only together with others: no K_θ exists.
    """
    soft = compliance.any(axis=0)
    K_theta = np.diag(np.where(soft, 0.0, np.inf))
    C = compliance[np.ix_(soft, soft)]
    sizes = np.abs(np.linalg.eigvalsh(C))
    exists = sizes.min(initial=np.inf) > ZERO * sizes.max(initial=0.0)
    K_theta[np.ix_(soft, soft)] = (
        symmetric_part(np.asarray(np.linalg.inv(C), dtype=float)) if exists else np.nan
    )
    return K_theta


def are_springs(K_theta: Array) -> bool:
    """Is a K_θ (s, s) positive definite, so that springs can make it?"""
    return bool(len(K_theta) and np.isfinite(K_theta).all() and np.linalg.eigvalsh(K_theta)[0] > 0)


def _compliance_of(springs: Array, n: int) -> Array:
    if springs.shape not in ((n,), (n, n)):
        raise InputError(
            f"springs of shape {springs.shape} given for {n} coordinates",
            remedy=f"Give {n} spring values, infinite for a rigid joint.",
        )
    diagonal = springs if springs.ndim == 1 else np.diagonal(springs)
    soft = np.flatnonzero(np.isfinite(diagonal))
    block = np.ix_(soft, soft)
    K_theta = np.diag(springs[soft]) if springs.ndim == 1 else springs[block]
    if np.isnan(diagonal).any() or not len(soft) or not np.isfinite(K_theta).all():
        raise InputError(
            "a spring is not a number" if len(soft) else "no joint has a finite spring",
            remedy="Give springs in N·m/rad (N/m where a joint slides), at least one of them "
            "finite.",
        )
    symmetric = np.abs(K_theta - K_theta.T).max() <= 1e-9 * np.abs(K_theta).max()
    if not symmetric or np.linalg.eigvalsh(K_theta)[0] <= 0.0:
        raise InputError(
            "the springs make no positive definite stiffness",
            remedy="Every spring must be greater than zero, and their matrix symmetric.",
        )
    C = np.zeros((n, n))
    C[block] = symmetric_part(np.asarray(np.linalg.inv(K_theta), dtype=float))
    return C
