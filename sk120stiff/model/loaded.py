"""How stiff a modelled arm is at one pose under one load: everything `stiffness` answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal, warn
from sk120stiff.model.compliance import model_compliance
from sk120stiff.model.holding import warn_of_far_bend
from sk120stiff.model.model import Model
from sk120stiff.stiffness import (
    BY_LOAD,
    BY_POSE,
    CLASSES,
    Definiteness,
    Principal,
    complementary_stiffness,
    gravity_stiffness,
    under_load,
)
from sk120stiff.stiffness.elastic import ZERO, stiffness_of

_WANTED = (BY_POSE | BY_LOAD) - {
    "deflection_equilibrium",
    "loaded_coordinates",
    "deflection_second_order",
}


@dataclass(frozen=True, eq=False)
class LoadedStiffness:
    """Stiffness at the unloaded pose, and the deflection under the load, in base axes.

    Conventional quantities use K_θ, enhanced ones K_θ − K_C − K_gravity: the arm's own weight is a
    load too. Where the robot states no mass that is zero, and the formulas are the paper's.
    Wrenches and twists are [linear; angular].

    Attributes:
        coordinates: Names of the n coordinates: actuated joints, then the model's virtual joints.
        soft: Those of them that yield; K_X, compliance and definiteness are about these.
        soft_under_load: Those besides that yield under this load and not under a small one.
        jacobian: (6, n) at the loaded point.
        K_theta: (n, n) tangent stiffness at zero torque [N·m/rad or N/m]; infinite where rigid, NaN
            where soft coordinates yield only together and no such matrix exists.
        K_C: (n, n) complementary stiffness of the load [N·m/rad].
        K_gravity: (n, n) that of the arm's own weight.
        compliance_conventional, compliance_enhanced: (6, 6) twist of the point per wrench; they
            always exist.
        K_X_conventional, K_X_enhanced: (3, 3) force per displacement of the point [N/m]; NaN where
            a direction is rigid.
        K_X_6x6_conventional, K_X_6x6_enhanced: (6, 6) the same with rotations and moments; NaN
            where fewer than six directions yield.
        principal: Of the enhanced K_X.
        definiteness_of_K_C, definiteness_of_K_theta_minus_K_C: Classes of the symmetric parts, soft
            coordinates only, the second less K_gravity. Unless that is positive definite, the pose
            is not stable under this load.
        critical_factor: Factor on the load at which that loses positive definiteness; infinite if
            none does.
        deflection_conventional, deflection_enhanced, deflection_equilibrium: (3,) displacement of
            the point by eq. (8), by eq. (10), and at exact equilibrium [m]. NaN where there is
            none, see `no_deflection`.
        no_deflection: Why a deflection is NaN, by its name without ``deflection_``.
    """

    coordinates: tuple[str, ...]
    soft: tuple[str, ...]
    soft_under_load: tuple[str, ...]
    jacobian: Array
    K_theta: Array
    K_C: Array
    K_gravity: Array
    compliance_conventional: Array
    compliance_enhanced: Array
    K_X_conventional: Array
    K_X_enhanced: Array
    K_X_6x6_conventional: Array
    K_X_6x6_enhanced: Array
    principal: Principal
    definiteness_of_K_C: Definiteness
    definiteness_of_K_theta_minus_K_C: Definiteness
    critical_factor: float
    deflection_conventional: Array
    deflection_enhanced: Array
    deflection_equilibrium: Array
    no_deflection: dict[str, str]


def loaded_stiffness(
    model: Model, a: ArrayLike, wrench: ArrayLike, frame: str | None = None
) -> LoadedStiffness:
    """Stiffness of a modelled arm at the origin of a frame, under a wrench that acts there.

    Args:
        model: Robot and effects. Instruments (load and reading errors) have no say here.
        a: (n,) actuated coordinates of the unloaded arm [rad or m].
        wrench: (6,) force [N] and moment [N·m] on the robot, base axes.
        frame: Frame whose origin is meant; the tool frame by default.

    Raises:
        InputError: Nothing in the model yields under small loads, or there is no such frame.
        Refusal: The load is exactly critical: K_θ − K_C is singular.

    Warns:
        ToolkitWarning: No equilibrium exists: the load is beyond what the springs can hold; or the
            arm bends as no arm does; or something does not yield in proportion to the load.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> found = sk.stiffness(model, [0, 0.2, -0.3, 0, -1, 0], [0, 0, -490, 0, 0, 0])
        >>> found.K_X_enhanced.shape, bool(found.deflection_equilibrium[2] < 0.0)
        ((3, 3), True)
    """
    arm = model_compliance(model, frame)
    arm.warn_of_small_loads()
    n, load = arm.mechanism.n, np.asarray(wrench, dtype=float)
    rows = model.robot.coordinates(a)[None]
    missing: dict[str, str] = {}
    equilibrium = np.full(3, np.nan)
    try:
        found = under_load(arm, rows[0], load, _WANTED | {"deflection_equilibrium"})
        equilibrium = found.of("deflection_equilibrium")
        warn_of_far_bend(model, equilibrium)
    except Refusal as refusal:
        found = under_load(arm, rows[0], load, _WANTED)
        warn(str(refusal))
        missing["equilibrium"] = refusal.what
    if np.isnan(found.of("compliance")).any():
        raise Refusal(
            "K_θ − K_C is singular: this load is exactly critical and the deflection has no bound",
            remedy="Lower the load.",
        )
    screws = arm.mechanism.screws(found.of("coordinates"), arm.point)
    C_theta, own = arm.compliance_at(rows).reshape(-1, n, n)[0], arm.weight_at(rows)
    stable = CLASSES[int(found.of("stiffness_class"))]
    if not found.stable:
        missing["enhanced"] = (
            f"at the unloaded pose K_theta - K_C is {stable}: eq. (10) points to a balance that "
            "does not hold"
        )
    _, slopes = arm.law(rows, load)(screws.torques(load)[None])
    soft, under = C_theta.any(axis=0), slopes.reshape(-1, n, n)[0].any(axis=0)
    names = (*model.robot.actuated, *(joint.name for joint in arm.mechanism.virtual))
    C_conventional = found.of("compliance_conventional")
    C_enhanced = found.of("compliance_enhanced")
    return LoadedStiffness(
        coordinates=names,
        soft=tuple(names[k] for k in np.flatnonzero(soft)),
        soft_under_load=tuple(names[k] for k in np.flatnonzero(under & ~soft)),
        jacobian=found.of("jacobian"),
        K_theta=stiffness_of(C_theta),
        K_C=complementary_stiffness(screws, load),
        K_gravity=np.zeros((n, n)) if own is None else gravity_stiffness(screws, own.gravity),
        compliance_conventional=C_conventional,
        compliance_enhanced=C_enhanced,
        K_X_conventional=_inverse(C_conventional[:3, :3]),
        K_X_enhanced=_inverse(C_enhanced[:3, :3]),
        K_X_6x6_conventional=_inverse(C_conventional),
        K_X_6x6_enhanced=_inverse(C_enhanced),
        principal=found.principal,
        definiteness_of_K_C=CLASSES[int(found.of("complementary_class"))],
        definiteness_of_K_theta_minus_K_C=stable,
        critical_factor=float(found.of("critical")),
        deflection_conventional=found.of("deflection_conventional"),
        deflection_enhanced=found.of("deflection_enhanced"),
        deflection_equilibrium=equilibrium,
        no_deflection=missing,
    )


def _inverse(compliance: Array) -> Array:
    """Stiffness of a compliance (d, d), filled with NaN where a direction is rigid."""
    values = np.linalg.svd(compliance, compute_uv=False)
    if values[-1] <= ZERO * values[0]:
        return np.full_like(compliance, np.nan)
    return np.asarray(np.linalg.inv(compliance))
