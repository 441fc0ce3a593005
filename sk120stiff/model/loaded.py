"""How stiff a modelled arm is at one pose under one load: everything `stiffness` answers."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import situation_of_load
from sk120stiff.errors import InputError, Refusal, ToolkitWarning
from sk120stiff.model.holding import warn_of_far_bend
from sk120stiff.model.model import Model
from sk120stiff.robot import Robot
from sk120stiff.stiffness import (
    Definiteness,
    Principal,
    cartesian_compliance,
    complementary_stiffness,
    definiteness_of,
    principal_stiffness,
    symmetric_part,
)

_SINGULAR = 1e-12  # smallest eigenvalue of a compliance over the largest: a direction is rigid


@dataclass(frozen=True, eq=False)
class LoadedStiffness:
    """Stiffness at the unloaded pose, and the deflection under the load, in base axes.

    Conventional quantities use K_θ, enhanced ones K_θ − K_C. Wrenches and twists are
    [linear; angular].

    Attributes
    ----------
    coordinates
        Names of the n coordinates: actuated joints, then the model's virtual joints.
    soft
        Those of them that yield; K_X, compliance and definiteness are about these.
    jacobian
        (6, n) at the loaded point.
    K_theta
        (n, n) tangent stiffness at zero torque [N·m/rad or N/m]; infinite where rigid, NaN where
        soft coordinates yield only together and no such matrix exists.
    K_C
        (n, n) complementary stiffness of the load [N·m/rad].
    compliance_conventional, compliance_enhanced
        (6, 6) twist of the point per wrench; they always exist.
    K_X_conventional, K_X_enhanced
        (3, 3) force per displacement of the point [N/m]; NaN where a direction is rigid.
    K_X_6x6_conventional, K_X_6x6_enhanced
        (6, 6) the same with rotations and moments; NaN where fewer than six directions yield.
    principal
        Of the enhanced K_X.
    definiteness_of_K_C, definiteness_of_K_theta_minus_K_C
        Classes of the symmetric parts, soft coordinates only. Unless the second is positive
        definite, the pose is not stable under this load.
    critical_factor
        Factor on the load at which K_θ − K_C loses positive definiteness; infinite if none does.
    deflection_conventional, deflection_enhanced, deflection_equilibrium
        (3,) displacement of the point by eq. (8), by eq. (10), and at exact equilibrium [m]. NaN
        where there is none, see `no_deflection`.
    no_deflection
        Why a deflection is NaN, by its name without ``deflection_``.
    """

    coordinates: tuple[str, ...]
    soft: tuple[str, ...]
    jacobian: Array
    K_theta: Array
    K_C: Array
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

    Parameters
    ----------
    model
        Robot and effects. Instruments (load and reading errors) have no say here.
    a
        (n,) actuated coordinates of the unloaded arm [rad or m].
    wrench
        (6,) force [N] and moment [N·m] on the robot, base axes.
    frame
        Frame whose origin is meant; the tool frame by default.

    Raises
    ------
    InputError
        The model has nothing that yields under load, or there is no such frame.
    Refusal
        The load is exactly critical: K_θ − K_C is singular.

    Warns
    -----
    ToolkitWarning
        No equilibrium exists: the load is beyond what the springs can hold; or the arm bends as no
        arm does.

    Examples
    --------
    >>> import sk120stiff as sk
    >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
    >>> found = sk.stiffness(model, [0, 0.2, -0.3, 0, -1, 0], [0, 0, -490, 0, 0, 0])
    >>> found.K_X_enhanced.shape, bool(found.deflection_equilibrium[2] < 0.0)
    ((3, 3), True)
    """
    model, point = seen_from(model.physical(), frame or model.robot.tool_frame)
    load = np.asarray(wrench, dtype=float)
    unloaded = model.solve(situation_of_load(model.robot, a, np.zeros(6), point=point))
    mechanism = model.assembly.mechanism
    screws = mechanism.screws(unloaded.rest.z[0], point)
    C_theta = unloaded.rest.compliance[0]  # (n, n) [rad/(N·m)]
    soft = np.flatnonzero(C_theta.any(axis=0))
    if not len(soft):
        raise InputError(
            "nothing in this model yields under load",
            where=model.robot.name,
            remedy="Give a model with joint_springs or another elastic effect.",
        )
    J, K_C = screws.jacobian, complementary_stiffness(screws, load)
    c, V = _soft_directions(C_theta, soft)  # (r,) compliances, (n, r) orthonormal directions
    K_soft, K_C_soft = np.diag(1.0 / c), V.T @ K_C @ V
    enhanced = K_soft - K_C_soft
    C_conventional = cartesian_compliance(J @ V, K_soft)
    C_enhanced = cartesian_compliance(J @ V, enhanced)
    stable = definiteness_of(enhanced)
    equilibrium, refused = _at_equilibrium(model, a, load, point)
    missing = {"equilibrium": refused} if refused else {}
    if stable is not Definiteness.POSITIVE_DEFINITE:
        missing["enhanced"] = (
            f"at the unloaded pose K_theta - K_C is {stable}: eq. (10) points to a balance that "
            "does not hold"
        )
    names = (*model.robot.actuated, *(joint.name for joint in mechanism.virtual))
    return LoadedStiffness(
        coordinates=names,
        soft=tuple(names[k] for k in soft),
        jacobian=J,
        K_theta=_joint_stiffness(C_theta, soft, full=len(c) == len(soft)),
        K_C=K_C,
        compliance_conventional=C_conventional,
        compliance_enhanced=C_enhanced,
        K_X_conventional=_inverse(C_conventional[:3, :3]),
        K_X_enhanced=_inverse(C_enhanced[:3, :3]),
        K_X_6x6_conventional=_inverse(C_conventional),
        K_X_6x6_enhanced=_inverse(C_enhanced),
        principal=principal_stiffness(C_enhanced[:3, :3]),
        definiteness_of_K_C=definiteness_of(K_C_soft),
        definiteness_of_K_theta_minus_K_C=stable,
        critical_factor=_critical_factor(c, K_C_soft),
        deflection_conventional=(C_conventional @ load)[:3],
        deflection_enhanced=np.full(3, np.nan)
        if "enhanced" in missing
        else (C_enhanced @ load)[:3],
        deflection_equilibrium=equilibrium,
        no_deflection=missing,
    )


def _at_equilibrium(
    model: Model, a: ArrayLike, load: Array, point: Array
) -> tuple[Array, str | None]:
    """(3,) deflection, or NaN and the reason."""
    try:
        found = np.asarray(model.deflect(a, load, point=point)[0])
    except Refusal as refusal:
        warnings.warn(str(refusal), ToolkitWarning, stacklevel=3)
        return np.full(3, np.nan), refusal.what
    warn_of_far_bend(model, found)
    return found, None


def seen_from(model: Model, frame: str) -> tuple[Model, Array]:
    """The model of the arm up to `frame`, and the frame's origin in that arm's tool frame [m]."""
    robot = model.robot
    if _same_body(robot, frame):
        inward = np.linalg.inv(robot.placement(robot.rest)) @ robot.placement(robot.rest, frame)
        return model, inward[:3, 3]
    return replace(model, robot=replace(robot, tool_frame=frame)), np.zeros(3)


def _same_body(robot: Robot, frame: str) -> bool:
    return robot.mechanism(frame).chain.names == robot.mechanism().chain.names


def _inverse(compliance: Array) -> Array:
    """Stiffness of a compliance (d, d), filled with NaN where a direction is rigid."""
    values = np.linalg.svd(compliance, compute_uv=False)
    if values[-1] <= _SINGULAR * values[0]:
        return np.full_like(compliance, np.nan)
    return np.asarray(np.linalg.inv(compliance))


def _soft_directions(C_theta: Array, soft: Index) -> tuple[Array, Array]:
    """Principal compliances of the coordinates and their directions, the rigid ones left out."""
    compliances, vectors = np.linalg.eigh(symmetric_part(C_theta[np.ix_(soft, soft)]))
    yielding = np.abs(compliances) > _SINGULAR * np.max(np.abs(compliances))
    directions = np.zeros((len(C_theta), int(yielding.sum())))
    directions[soft] = vectors[:, yielding]
    return compliances[yielding], directions


def _joint_stiffness(C_theta: Array, soft: Index, *, full: bool) -> Array:
    K_theta = np.zeros_like(C_theta)
    rigid = np.setdiff1d(np.arange(len(C_theta)), soft)
    K_theta[rigid, rigid] = np.inf
    block = np.ix_(soft, soft)
    K_theta[block] = np.linalg.inv(C_theta[block]) if full else np.nan
    return K_theta


def _critical_factor(compliances: Array, K_C: Array) -> float:
    """Smallest λ ≥ 0 at which K_θ − λ K_C is not positive definite, in directions of K_θ."""
    if (compliances < 0.0).any():
        return 0.0  # a negative spring: unstable before any load
    root = np.sqrt(compliances)
    largest = float(np.linalg.eigvalsh(root[:, None] * symmetric_part(K_C) * root)[-1])
    return 1.0 / largest if largest > 0.0 else float(np.inf)
