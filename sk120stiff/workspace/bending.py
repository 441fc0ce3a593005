"""How far the points of a map bend under its loads, ± what the model knows of its own uncertainty.

One step from the unloaded pose with the enhanced stiffness, as `deflection_enhanced` of
`under_load`: with the compliance C of the coordinates, K what load and weight take from their
stiffness, N = I − C K and τ = JᵀW,

    d = J N⁻¹ C τ,        ∂d/∂p = J N⁻¹ (∂C/∂p) (τ + K N⁻¹ C τ).

It lacks the curvature of the path, ½ δᵀ H δ: parts in a thousand at usual loads. Coordinates that
the model holds rigid may yield within their uncertainty; K is left out in those alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import load_case
from sk120stiff.model import Model, Remainder
from sk120stiff.model.loaded import by_parameters
from sk120stiff.model.uncertainty import spread


@dataclass(frozen=True, eq=False)
class ArmUncertainty:
    """The uncertainty of an arm, as arrays that can be sent anywhere.

    Attributes:
        seen, unseen: (P, r) and (P, b) factors of `Uncertainty.factors`.
        changes: (P, n_z, n_z) derivative of the compliance of the coordinates by the parameters, or
            (P, N, n_z, n_z) where it changes with the pose.
        noise: Of one reading [m].
        remainder: What the model leaves unexplained; None: not known.
    """

    seen: Array
    unseen: Array
    changes: Array
    noise: float
    remainder: Remainder | None

    @property
    def identity(self) -> tuple[object, ...]:
        """What makes it another; the derivatives follow from the arm, but for rounding."""
        left = self.remainder
        sizes = None if left is None else (left.upper, left.load, left.grows, left.share)
        return self.seen, self.unseen, self.noise, sizes


@dataclass(frozen=True, eq=False)
class Bending:
    """Deflection of N points under one load.

    Attributes:
        deflection: (N, 3) base axes [m]; NaN where the arm is not stable under the load.
        std_parameters, std_remainder: (N,) standard uncertainty of its length [m]; infinite:
            unknown, NaN: no deflection. None where nothing is known.
    """

    deflection: Array
    std_parameters: Array | None
    std_remainder: Array | None


def uncertainty_of(model: Model, poses: Array) -> ArmUncertainty | None:
    """The uncertainty of a physical model whose compliance is that at the first of poses (M, n).

    None if the model has none. See `at_poses` for a compliance that changes with the pose.
    """
    known = model.uncertainty
    if known is None:
        return None
    return ArmUncertainty(
        *known.factors(model.names), _changes(model, poses[:1]), known.floor, known.remainder
    )


def at_poses(uncertainty: ArmUncertainty, model: Model, poses: Array) -> ArmUncertainty:
    """The same with the derivatives at poses (N, n), for compliances that change with the pose."""
    return replace(uncertainty, changes=_changes(model, poses))


def _changes(model: Model, poses: Array) -> Array:
    load_cases = load_case(model.robot, poses, np.zeros(6))
    changes = by_parameters(
        model, lambda values: np.asarray(model.solve(load_cases, values).rest.compliance)
    )
    n = model.assembly.mechanism.n
    stacked = np.array(changes).reshape(len(changes), -1, n, n)
    return np.asarray(stacked[:, 0] if stacked.shape[1] == 1 else stacked)


def bending(
    jacobian: Array,
    C: Array,
    K: Array,
    soft: Index,
    deflection: Array,
    wrench: Array,
    uncertainty: ArmUncertainty | None,
) -> Bending:
    """± of deflections at N poses under one wrench (6,).

    Args:
        jacobian: (N, 6, n_z) of the point by all coordinates, base axes.
        C: (s, s) or (N, s, s) compliance of the soft coordinates.
        K: (N, s, s) complementary stiffness of the load and of the weight.
        soft: (s,) indices of the soft coordinates.
        deflection: (N, 3) enhanced deflection; NaN where the arm does not hold the load.
        wrench: Force [N] and moment [N·m] at the point.
        uncertainty: What is uncertain; None: not known.
    """
    if uncertainty is None:
        return Bending(deflection, None, None)
    torque = np.einsum("nij,i->nj", jacobian, wrench)
    newton = np.eye(len(soft)) - C @ K
    held = np.asarray(np.isfinite(deflection).all(axis=1))
    newton = np.where(held[:, None, None], newton, np.eye(len(soft)))  # not looked at
    z = np.linalg.solve(newton, (C @ torque[:, soft, None]))[..., 0]
    length = np.linalg.norm(deflection, axis=1)
    along = deflection / np.where(length > 0.0, length, 1.0)[:, None]
    pull = np.einsum("ni,nij->nj", along, jacobian[:, :3])  # what the load of one along d does
    pull[:, soft] = np.linalg.solve(np.swapaxes(newton, -1, -2), pull[:, soft, None])[..., 0]
    torque[:, soft] += np.einsum("nij,nj->ni", K, z)
    changes = uncertainty.changes if uncertainty.changes.ndim == 4 else uncertainty.changes[:, None]
    by_parameter = ((pull[:, None] @ changes)[..., 0, :] * torque).sum(axis=-1).T  # (N, P)
    std = spread(
        by_parameter @ uncertainty.seen, by_parameter @ uncertainty.unseen, uncertainty.noise
    )
    left = None
    if uncertainty.remainder is not None:
        left = np.sqrt(np.einsum("ni,i->n", along**2, uncertainty.remainder.std(wrench) ** 2))
    return Bending(deflection, np.where(held, std, np.nan), left)
