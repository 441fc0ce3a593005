"""How stiff a modelled arm is at one pose under one load, ±: everything `stiffness` answers.

A compliance is linear in the compliances that it is made of, so its derivative carries drawn
parameters exactly, and 3×3 eigenvalues of thousands of draws cost nothing. Principal values must be
drawn: where two are nearly equal, they push each other apart, and no derivative says by how much.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import load_case
from sk120stiff.errors import Refusal, warn
from sk120stiff.files import html_table
from sk120stiff.model.compliance import ModelCompliance, model_compliance, seen_from
from sk120stiff.model.holding import warn_of_far_bend
from sk120stiff.model.model import Model
from sk120stiff.model.predicted import Predicted, blamed, predict_with_uncertainty
from sk120stiff.model.uncertainty import spread
from sk120stiff.stiffness import (
    BY_LOAD,
    BY_POSE,
    CLASSES,
    Definiteness,
    Principal,
    complementary_stiffness,
    gravity_stiffness,
    symmetric_part,
    under_load,
)
from sk120stiff.stiffness.elastic import ZERO, stiffness_of
from sk120stiff.stiffness.equilibrium import SEE_CRITICAL
from sk120stiff.stiffness.wrench import wrenches

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

    def __repr__(self) -> str:
        values = ", ".join(f"{1e-6 * value:.4g}" for value in self.principal.values)
        bent = 1e6 * float(np.linalg.norm(self.deflection_equilibrium))
        return (
            f"<LoadedStiffness: principal {values} N/µm; deflection {bent:.4g} µm; "
            f"K_theta - K_C is {self.definiteness_of_K_theta_minus_K_C}>"
        )

    def _repr_html_(self) -> str:
        """What a notebook shows: principal stiffness and deflections, with their directions."""
        bent = {
            "conventional": self.deflection_conventional,
            "enhanced": self.deflection_enhanced,
            "equilibrium": self.deflection_equilibrium,
        }
        ways = np.array([*self.principal.directions, *(1e6 * d for d in bent.values())])
        columns: dict[str, Iterable[object]] = {
            "": [*["principal stiffness"] * 3, *(f"deflection, {name}" for name in bent)],
            "size": [*1e-6 * self.principal.values, *np.linalg.norm(ways[3:], axis=1)],
            "unit": [*["N/µm"] * 3, *["µm"] * 3],
            **{axis: ways[:, k] for k, axis in enumerate("xyz")},
        }
        return html_table(repr(self), columns)


def loaded_stiffness(
    model: Model, a: ArrayLike, wrench: ArrayLike, frame: str | None = None
) -> LoadedStiffness:
    """Stiffness of a modelled arm at the origin of a frame, under a wrench that acts there.

    Args:
        model: Robot and effects. Instruments (load and reading errors) have no say here.
        a: (n,) actuated coordinates of the unloaded arm [rad or m].
        wrench: (6,) force [N] and moment [N·m] on the robot, base axes; (3,) is a force alone.
        frame: Frame whose origin is meant; the tool frame by default.

    Raises:
        InputError: Nothing in the model yields under small loads, there is no such frame, or the
            wrench is no six numbers.
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
    n, load = arm.mechanism.n, wrenches(wrench, 1)[0]
    rows = model.robot.coordinates(a)[None]
    missing: dict[str, str] = {}
    equilibrium = np.full(3, np.nan)
    try:
        found = under_load(arm, rows[0], load, _WANTED | {"deflection_equilibrium"})
        equilibrium = found.of("deflection_equilibrium")
        warn_of_far_bend(model, equilibrium)
    except Refusal as refusal:
        found = under_load(arm, rows[0], load, _WANTED)
        warn(str(refusal).removesuffix(SEE_CRITICAL).rstrip())  # here it stands in the answer
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


STEP = 1e-3  # of a usual size; compliances enter linearly, so it does not matter
SLIGHT = 0.01  # share of a stiffness that nobody asks about
DRAWS, SEED = 4000, 1  # of parameters; the same question has the same answer


@dataclass(frozen=True, eq=False)
class LoadedUncertainty:
    """± of principal stiffness and deflection at one pose under one load.

    Attributes:
        principal: (3,) standard uncertainty of the principal stiffness [N/m]; infinite where a
            value counts that the readings of the fit do not show.
        principal_interval: (3, 2) 95 % intervals [N/m]. They are made of compliances and turned
            over: so one that reaches to a compliance of zero is open upwards.
        deflection: Of the point at exact equilibrium, base axes (one reading); None where there is
            none.
        blame: Parameters that make a ± infinite.
    """

    principal: Array
    principal_interval: Array
    deflection: Predicted | None
    blame: tuple[str, ...]


def loaded_uncertainty(
    model: Model,
    a: ArrayLike,
    wrench: ArrayLike,
    found: LoadedStiffness,
    frame: str | None = None,
) -> LoadedUncertainty | None:
    """The uncertainty of `found`, `loaded_stiffness` of the same arguments.

    None if the model does not know how well its parameters are known.
    """
    known = model.uncertainty
    if known is None:
        return None
    model, point = seen_from(model.physical(), frame)
    load = np.asarray(wrench, dtype=float)
    C = _compliance(model, model.values, a, load, point)
    derivatives = by_parameters(model, lambda values: _compliance(model, values, a, load, point))
    change = np.stack(derivatives, axis=-1)  # (3, 3, P)
    change = 0.5 * (change + np.swapaxes(change, 0, 1))
    directions = found.principal.directions  # (3, 3), one per row
    by_parameter = np.einsum("ki,ijp,kj->kp", directions, change, directions)
    L, B = known.factors(model.names)
    softness = np.asarray(np.linalg.eigvalsh(symmetric_part(C))[::-1], dtype=float)
    lost = np.isinf(spread(by_parameter @ L, by_parameter @ B, SLIGHT * np.abs(softness)))
    drawn = _drawn(symmetric_part(C), change @ L)  # what nothing tells has no size to draw
    stiffness = found.principal.values
    with np.errstate(invalid="ignore"):
        std = np.where(lost | np.isinf(stiffness), np.inf, drawn.std(axis=0) * stiffness**2)
    stretch = known.reach(0.95) / float(stats.norm.ppf(0.975))
    ends = np.quantile(drawn, [0.025, 0.975], axis=0)  # (2, 3)
    low, high = (softness + stretch * (end - softness) for end in ends)
    deflection = _deflection(model, a, load, point)
    blame = [*blamed(known, model.names, by_parameter[lost])] if lost.any() else []
    blame += [name for names in (deflection.blame if deflection else ()) for name in names]
    return LoadedUncertainty(
        std, _reciprocals(softness, low, high, lost), deflection, tuple(dict.fromkeys(blame))
    )


def _drawn(C: Array, change: Array) -> Array:
    """(DRAWS, 3) principal compliances, largest first, for changes (3, 3, r) of unit variance."""
    normal = np.random.default_rng(SEED).normal(size=(DRAWS // 2, change.shape[-1]))
    every = C + np.einsum("ijr,dr->dij", change, np.concatenate([normal, -normal]))
    return np.asarray(np.linalg.eigvalsh(every)[:, ::-1])


def _deflection(model: Model, a: ArrayLike, load: Array, point: Array) -> Predicted | None:
    try:
        return predict_with_uncertainty(model, load_case(model.robot, a, load, point=point))
    except Refusal:
        return None


def _compliance(model: Model, values: Array, a: ArrayLike, load: Array, point: Array) -> Array:
    """(3, 3) compliance of the point under the load for other parameter values."""
    arm = ModelCompliance(model.with_values(values), point)
    return under_load(arm, model.robot.coordinates(a), load, ("compliance",)).of("compliance")


def by_parameters(model: Model, of: Callable[[Array], Array]) -> list[Array]:
    """Derivatives of a function of the parameter values by each of them, by central differences."""
    changes = []
    for k, parameter in enumerate(model.parameters):
        step = STEP * max(abs(parameter.internal), parameter.spec.typical)
        ends = []
        for side in (step, -step):
            values = model.values.copy()
            values[k] += side
            ends.append(of(values))
        changes.append((ends[0] - ends[1]) / (2.0 * step))
    return changes


def _reciprocals(softness: Array, low: Array, high: Array, lost: Mask) -> Array:
    """(3, 2) stiffness of an interval of compliance.

    Open where that reaches to a compliance of zero: upwards from the stable side; from the
    unstable one, or where nothing is known, nothing is excluded at all.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([1.0 / high, 1.0 / low], axis=-1)
    across = (low <= 0.0) & (high >= 0.0)
    ends[across, 1] = np.inf
    ends[(across & (softness < 0.0)) | lost] = (-np.inf, np.inf)
    return ends
