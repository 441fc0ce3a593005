"""Sections III and V and Appendix II: what they say of stiffness matrices, put to the test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.setting import (
    Setting,
    even_directions,
    motion_grid,
    random_poses,
    straight,
    wrench_of,
)
from sk120stiff.stiffness import (
    cartesian_compliance,
    cartesian_stiffness,
    complementary_stiffness,
    definiteness,
    equilibrium,
    linear_springs,
)

#: Load at which the formulas of K_X are told apart [N]: one that no SK120 carries.
HEAVY = 30e3
#: Loads at which classes of K_C and K_θ − K_C are compared, up to far beyond the critical one [N].
SIZES = (1e2, 1e4, 1e6, 1e8)


@dataclass(frozen=True)
class Formulation:
    """Findings as numbers, all relative unless said otherwise.

    Attributes:
        load: Force at which the next two were found [N].
        enhanced_error, conventional_error: Compliance of the loaded arm by eq. (10) and by eq. (8),
            against the slope of the exact deflection, the largest over poses.
        unloaded_difference: Eq. (10) minus eq. (8) without a load.
        force_asymmetry, moment_asymmetry: ‖K_C − K_Cᵀ‖ / ‖K_C‖ for forces, and for moments on all
            six joints.
        third_derivatives: Largest relative violation of ∂K_C,ij/∂θ_k = ∂K_C,ik/∂θ_j for forces: the
            exact differential that a potential asks for.
        negative_cases, negative_failures: Grid poses and loads at which K_C is ND or NSD, and those
            of them at which K_θ − K_C is not PD: corollary 1 says none.
        congruent_cases, congruence_failures: Poses and loads at which K_X exists, and those at
            which its class is not that of K_θ − K_C: Appendix II says none.
        minors_agree: Do the three printed conditions of section V agree with positive definiteness
            everywhere?
        enhanced_cycle, conventional_cycle: Work left over when the force goes round a closed circle
            of size `load` and the arm follows by increments of eq. (10), or of eq. (8), over the
            energy stored: nature leaves nothing.
        loop_error: Largest opening of the five-bar over the motion range [m].
    """

    load: float
    enhanced_error: float
    conventional_error: float
    unloaded_difference: float
    force_asymmetry: float
    moment_asymmetry: float
    third_derivatives: float
    negative_cases: int
    negative_failures: int
    congruent_cases: int
    congruence_failures: int
    minors_agree: bool
    enhanced_cycle: float
    conventional_cycle: float
    loop_error: float


def formulation(setting: Setting, *, seed: int = 0) -> Formulation:
    """Put the paper's formulas and corollaries to the test on the SK120."""
    rng = np.random.default_rng(seed)
    poses = random_poses(rng, 12)
    enhanced, conventional = _loaded_compliance(setting, poses, rng)
    unloaded = complementary_stiffness(setting.arm(poses), np.zeros(6))
    force_asymmetry, moment_asymmetry = (_asymmetry(setting, rng, k) for k in (0, 3))
    negative, failures, congruent, different, minors = _classes(setting)
    rod, lever = (
        setting.robot.placement(straight(motion_grid()), frame)[:, :3, 3]
        for frame in ("rod_end", "forearm_lever_end")
    )
    return Formulation(
        HEAVY,
        enhanced,
        conventional,
        float(np.max(np.abs(unloaded))),
        force_asymmetry,
        moment_asymmetry,
        _third_derivatives(setting, poses),
        negative,
        failures,
        congruent,
        different,
        minors,
        _cycle(setting, poses, enhanced=True),
        _cycle(setting, poses, enhanced=False),
        float(np.max(np.abs(rod - lever))),
    )


def printed_minors(K_theta: Array, K_C: Array) -> Array:
    """(..., 3) the three expressions of section V that must be positive, as printed."""
    K1, K2, K3 = np.diagonal(K_theta)
    C = np.moveaxis(K_C, (-2, -1), (0, 1))
    second = (K1 - C[0, 0]) * (K2 - C[1, 1]) - C[0, 1] ** 2
    third = (
        (K1 - C[0, 0]) * ((K2 - C[1, 1]) * (K3 - C[2, 2]) - C[1, 2] ** 2)
        - C[0, 1] * (C[2, 0] * C[1, 2] + C[0, 1] * (K3 - C[2, 2]))
        - C[0, 2] * (C[1, 0] * C[2, 1] + C[2, 0] * (K2 - C[1, 1]))
    )
    return np.stack([K1 - C[0, 0], second, third], axis=-1)


def _loaded_compliance(
    setting: Setting, poses: Array, rng: np.random.Generator
) -> tuple[float, float]:
    force = rng.normal(size=(len(poses), 3))
    force *= HEAVY / np.linalg.norm(force, axis=1, keepdims=True)
    start, law = straight(poses), linear_springs(setting.springs)

    def position(extra: Array) -> Array:
        load = wrench_of(force + extra)
        return equilibrium(setting.mechanism, start, load, law).screws.position

    step = 50.0  # N: large enough for rounding, small enough for a fourth-order difference
    columns = []
    for unit in step * np.eye(3):
        near, far = position(unit) - position(-unit), position(2 * unit) - position(-2 * unit)
        columns.append((8.0 * near - far) / (12.0 * step))
    measured = np.stack(columns, axis=-1)  # (P, 3, 3) [m/N]
    rest = equilibrium(setting.mechanism, start, wrench_of(force), law)
    screws = setting.arm(rest.z)
    K_C = complementary_stiffness(screws, wrench_of(force))
    size = np.max(np.abs(measured), axis=(1, 2))

    def off(stiffness: Array) -> float:
        found = cartesian_compliance(screws.linear_jacobian, stiffness)
        return float(np.max(np.max(np.abs(found - measured), axis=(1, 2)) / size))

    return off(setting.K_theta - K_C), off(setting.K_theta)


def _cycle(setting: Setting, poses: Array, *, enhanced: bool, steps: int = 60) -> float:
    """∮ F · dX over the stored energy, for F on a circle through the x and z directions.

    Joint angles and work are carried along the circle by Runge and Kutta's fourth-order steps.
    """
    start, law = straight(poses), linear_springs(setting.springs)
    theta = equilibrium(setting.mechanism, start, wrench_of([HEAVY, 0.0, 0.0]), law).z[:, :3]
    energy = 0.5 * (setting.arm_springs * (theta - poses) ** 2).sum(axis=1)

    def rates(at: Array, angle: float) -> tuple[Array, Array]:
        force = HEAVY * np.array([np.cos(angle), 0.0, np.sin(angle)])
        change = HEAVY * np.array([-np.sin(angle), 0.0, np.cos(angle)])
        screws = setting.arm(at)
        J = screws.linear_jacobian
        K = setting.K_theta - (complementary_stiffness(screws, wrench_of(force)) if enhanced else 0)
        turned = (np.swapaxes(J, -1, -2) @ change)[..., None]
        turning = np.linalg.solve(np.broadcast_to(K, J.shape), turned)[..., 0]
        power = np.einsum("k,pkj,pj->p", force, J, turning)
        return np.asarray(turning, dtype=float), np.asarray(power, dtype=float)

    work, h = np.zeros(len(poses)), 2 * np.pi / steps
    for k in range(steps):
        d1, w1 = rates(theta, k * h)
        d2, w2 = rates(theta + h / 2 * d1, (k + 0.5) * h)
        d3, w3 = rates(theta + h / 2 * d2, (k + 0.5) * h)
        d4, w4 = rates(theta + h * d3, (k + 1) * h)
        theta = theta + h / 6 * (d1 + 2 * d2 + 2 * d3 + d4)
        work = work + h / 6 * (w1 + 2 * w2 + 2 * w3 + w4)
    return float(np.max(np.abs(work / energy)))


def _asymmetry(setting: Setting, rng: np.random.Generator, first: int) -> float:
    """Of K_C on all six joints, for forces (`first` 0) or moments (3)."""
    a = np.concatenate([random_poses(rng, 50), rng.uniform(-2.0, 2.0, (50, 3))], axis=1)
    load = np.zeros((50, 6))
    load[:, first : first + 3] = rng.normal(size=(50, 3))
    K_C = complementary_stiffness(setting.robot.screws(a), load)
    skew = np.linalg.norm(K_C - np.swapaxes(K_C, -1, -2), axis=(1, 2))
    return float(np.max(skew / np.linalg.norm(K_C, axis=(1, 2))))


def _third_derivatives(setting: Setting, poses: Array) -> float:
    load, step = wrench_of([300.0, -400.0, 500.0]), 1e-4
    slopes = []
    for unit in step * np.eye(3):
        ahead, behind = (
            complementary_stiffness(setting.arm(poses + sign * unit), load) for sign in (1, -1)
        )
        slopes.append((ahead - behind) / (2 * step))
    third = np.stack(slopes, axis=1)  # (P, k, i, j)
    return float(np.max(np.abs(third - np.swapaxes(third, 1, 2))) / np.max(np.abs(third)))


def _classes(setting: Setting) -> tuple[int, int, int, int, bool]:
    """Corollary 1, Appendix II and the printed minors, over the grid and many loads."""
    screws = setting.arm(motion_grid()[::7])
    J = screws.linear_jacobian
    # Close to a singular pose rounding blurs the eigenvalues of K_X.
    regular = np.linalg.svd(J, compute_uv=False)[:, -1] > 0.05
    negative = failures = congruent = different = 0
    minors = True
    for load in (wrench_of(size * unit) for size in SIZES for unit in even_directions(12)):
        K_C = complementary_stiffness(screws, load)
        K = setting.K_theta - K_C
        of_K_C, of_K = definiteness(K_C), definiteness(K)
        below = (of_K_C == 2) | (of_K_C == 3)
        negative += int(below.sum())
        failures += int((below & (of_K != 0)).sum())
        signs = (printed_minors(setting.K_theta, K_C) > 0).all(axis=-1)
        minors &= bool(np.array_equal(signs, of_K == 0))
        congruent += int(regular.sum())
        different += int((definiteness(cartesian_stiffness(J, K)[regular]) != of_K[regular]).sum())
    return negative, failures, congruent, different, minors
