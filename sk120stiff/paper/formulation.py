"""Sections III and V and Appendix II: what they say of stiffness matrices, put to the test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from sk120stiff.arrays import Array
from sk120stiff.paper.setting import (
    Setting,
    even_directions,
    motion_grid,
    random_poses,
    slopes,
    straight,
    wrench_of,
)
from sk120stiff.stiffness import (
    cartesian_compliance,
    cartesian_stiffness,
    complementary_stiffness,
    definiteness,
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
    enhanced, conventional = _compliance_errors(setting, poses, rng)
    force_asymmetry, moment_asymmetry = (_asymmetry(setting, rng, k) for k in (0, 3))
    load = wrench_of([300.0, -400.0, 500.0])
    third = slopes(lambda turn: complementary_stiffness(setting.arm(poses + turn), load), 1e-3)
    rod, lever = (
        setting.robot.placement(straight(motion_grid()), frame)[:, :3, 3]
        for frame in ("rod_end", "forearm_lever_end")
    )
    return Formulation(
        load=HEAVY,
        enhanced_error=enhanced,
        conventional_error=conventional,
        unloaded_difference=_largest(complementary_stiffness(setting.arm(poses), np.zeros(6))),
        force_asymmetry=force_asymmetry,
        moment_asymmetry=moment_asymmetry,
        third_derivatives=_largest(third - np.swapaxes(third, -1, -2)) / _largest(third),
        **_classes(setting),
        enhanced_cycle=_cycle(setting, poses, enhanced=True),
        conventional_cycle=_cycle(setting, poses, enhanced=False),
        loop_error=_largest(rod - lever),
    )


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))


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


def _compliance_errors(
    setting: Setting, poses: Array, rng: np.random.Generator
) -> tuple[float, float]:
    """Of eq. (10) and of eq. (8)."""
    force = rng.normal(size=(len(poses), 3))
    force *= HEAVY / np.linalg.norm(force, axis=1, keepdims=True)
    # 50 N: large enough for rounding, small enough for a fourth-order difference.
    true = slopes(lambda more: setting.deflection(poses, force + more), 50.0)  # (P, 3, 3) [m/N]
    coordinates = "loaded_coordinates"
    screws = setting.arm(setting.under_load(poses, force, coordinates).of(coordinates))
    K_C = complementary_stiffness(screws, wrench_of(force))
    enhanced, conventional = (
        cartesian_compliance(screws.linear_jacobian, K) - true
        for K in (setting.K_theta - K_C, setting.K_theta)
    )
    size = np.max(np.abs(true), axis=(1, 2), keepdims=True)
    return _largest(enhanced / size), _largest(conventional / size)


def _cycle(setting: Setting, poses: Array, *, enhanced: bool) -> float:
    """∮ F · dX over the stored energy, for F on a circle through the x and z directions."""
    coordinates, first = "loaded_coordinates", np.array([HEAVY, 0.0, 0.0])
    start = setting.under_load(poses, first, coordinates).of(coordinates)[:, :3]
    energy = 0.5 * (setting.arm_springs * (start - poses) ** 2).sum(axis=1)

    def rates(angle: float, state: Array) -> Array:
        x, z = HEAVY * np.cos(angle), HEAVY * np.sin(angle)
        force, change = np.array([x, 0.0, z]), np.array([-z, 0.0, x])
        screws = setting.arm(state.reshape(-1, 4)[:, :3])
        J, K = screws.linear_jacobian, np.broadcast_to(setting.K_theta, (len(poses), 3, 3))
        if enhanced:
            K = K - complementary_stiffness(screws, wrench_of(force))
        turning = np.linalg.solve(K, (np.swapaxes(J, -1, -2) @ change)[..., None])
        return np.concatenate([turning[..., 0], force @ (J @ turning)], axis=1).ravel()

    state = np.concatenate([start, np.zeros((len(poses), 1))], axis=1).ravel()
    end = solve_ivp(rates, (0.0, 2 * np.pi), state, method="DOP853", rtol=1e-10, atol=1e-12)
    return _largest(end.y[3::4, -1] / energy)


def _asymmetry(setting: Setting, rng: np.random.Generator, first: int) -> float:
    """Of K_C on all six joints, for forces (`first` 0) or moments (3)."""
    a = np.concatenate([random_poses(rng, 50), rng.uniform(-2.0, 2.0, (50, 3))], axis=1)
    load = np.zeros((50, 6))
    load[:, first : first + 3] = rng.normal(size=(50, 3))
    K_C = complementary_stiffness(setting.robot.screws(a), load)
    skew = np.linalg.norm(K_C - np.swapaxes(K_C, -1, -2), axis=(1, 2))
    return float(np.max(skew / np.linalg.norm(K_C, axis=(1, 2))))


def _classes(setting: Setting) -> dict[str, Any]:
    """Corollary 1, Appendix II and the printed minors, over the grid and many loads."""
    screws = setting.arm(motion_grid()[::7])
    J = screws.linear_jacobian
    loads = wrench_of(np.concatenate([size * even_directions(12) for size in SIZES]))[:, None]
    K_C = complementary_stiffness(screws, loads)  # (loads, poses, 3, 3)
    K = setting.K_theta - K_C
    negative, of_K = np.isin(definiteness(K_C), (2, 3)), definiteness(K)
    # Close to a singular pose rounding blurs the eigenvalues of K_X.
    regular = np.linalg.svd(J, compute_uv=False)[:, -1] > 0.05
    of_K_X = definiteness(cartesian_stiffness(J[regular], K[:, regular]))
    signs = (printed_minors(setting.K_theta, K_C) > 0).all(axis=-1)
    return {
        "negative_cases": int(negative.sum()),
        "negative_failures": int((negative & (of_K != 0)).sum()),
        "congruent_cases": of_K_X.size,
        "congruence_failures": int((of_K_X != of_K[:, regular]).sum()),
        "minors_agree": bool(np.array_equal(signs, of_K == 0)),
    }
