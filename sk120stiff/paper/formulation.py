"""Sections III and V and the appendices: what they say of stiffness matrices, put to the test.

Appendix I is the paper's Jacobian, coded from its text, against ours. How its angles (primed)
follow from the readings of the bundled robot, whose joint 2 is measured from the vertical and whose
joint 3 is the forearm's absolute elevation, positive up::

    θ1' = θ1,  θ2' = θ2 + 90°,  θ3' = −θ3,  θ4' = θ4,  θ5' = θ5,  θ6' = θ6

so that the third column of the paper's Jacobian is minus ours. The fixture adds to D6 along the
tool's axis and is L6 across it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import DIMENSIONS, FIXTURE
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


#: Every length that Appendix I names.
LENGTHS = ("L1", "L2", "L3", "L4", "L5", "L6", "D1", "D3", "D4", "D5", "D6")


@cache
def printed_terms() -> dict[str, str]:
    """Element of eq. (17) → its terms as printed."""
    text = (files("sk120stiff.paper") / "appendix_1.txt").read_text(encoding="utf-8")
    elements = text.replace("\n    ", " ").splitlines()[1:]
    return {line[:3]: line[4:] for line in elements}


def printed_jacobian(angles: Array, lengths: Mapping[str, float]) -> Array:
    """(..., 3, 3) derivatives of x, y, z by θ1', θ2', θ3' by eq. (17) as printed [m/rad].

    Args:
        angles: (..., 6) the paper's angles θ1' to θ6' [rad].
        lengths: Any of `LENGTHS` [m]; the others are zero.
    """
    given = np.asarray(angles, dtype=float)
    named = {str(k + 1): given[..., k] for k in range(6)} | {"23": given[..., 1] - given[..., 2]}
    factors = {f"s{k}": np.sin(angle) for k, angle in named.items()}
    factors |= {f"c{k}": np.cos(angle) for k, angle in named.items()}
    J = np.zeros((*given.shape[:-1], 3, 3))
    for element, text in printed_terms().items():
        for term in text.replace("- ", "+ -").split("+ "):
            length, *angular = term.removeprefix("-").split() or [""]
            if length in lengths:
                value = -lengths[length] if term.startswith("-") else lengths[length]
                value = value * np.prod([factors[name] for name in angular], axis=0)
                J[..., int(element[1]) - 1, int(element[2]) - 1] += value
    return J


def mended_jacobian(angles: Array, lengths: Mapping[str, float]) -> Array:
    """Eq. (17) with + D4 cos θ1 cos θ3 and − D3 sin θ1 in J21."""
    J, (t1, _, t3) = printed_jacobian(angles, lengths), np.moveaxis(angles[..., :3], -1, 0)
    D4, D1, D3 = (lengths.get(name, 0.0) for name in ("D4", "D1", "D3"))
    J[..., 1, 0] += 2.0 * D4 * np.cos(t1) * np.cos(t3) + (D1 - D3) * np.sin(t1)
    return J


def paper_angles(readings: Array) -> Array:
    """(..., 6) angles of Appendix I for joint readings (..., 6) [rad]."""
    angles = np.array(readings, dtype=float)
    angles[..., 1] += np.pi / 2
    angles[..., 2] *= -1.0
    return angles


@dataclass(frozen=True)
class Slip:
    """A term of eq. (17) that contradicts the others, off by `size` times its length."""

    element: str
    length: str
    size: float


@dataclass(frozen=True, eq=False)
class Appendix:
    """Appendix I against the bundled robot.

    `slips` are found without our kinematics; the errors are (3, 3) largest differences to our
    Jacobian over random poses of all six joints, at the reflector [m/rad].
    """

    slips: tuple[Slip, ...]
    printed_error: Array
    mended_error: Array


def appendix(setting: Setting, *, seed: int = 0) -> Appendix:
    """Compare eq. (17) with our Jacobian at the reflector, and with itself."""
    rng = np.random.default_rng(seed)
    readings = np.concatenate(
        [random_poses(rng, 200), rng.uniform(-np.pi, np.pi, (200, 3))], axis=1
    )
    ours = setting.arm(readings, "reflector").linear_jacobian * np.array([1.0, 1.0, -1.0])
    lengths = {**DIMENSIONS, "D6": DIMENSIONS["D6"] + FIXTURE[0], "L6": FIXTURE[1]}
    angles = paper_angles(readings)
    return Appendix(
        slips=slips(),
        printed_error=np.max(np.abs(printed_jacobian(angles, lengths) - ours), axis=0),
        mended_error=np.max(np.abs(mended_jacobian(angles, lengths) - ours), axis=0),
    )


def slips(*, seed: int = 1) -> tuple[Slip, ...]:
    """Terms of eq. (17) that cannot belong to one arm which turns about a vertical axis.

    J11 = −y and J21 = x, and a quarter turn of joint 1 carries x to y: so J21(θ1) must be
    −J11(θ1 + 90°), length by length. Where they differ, the one whose slope by θ3 is not −J23 or
    J13 is wrong.
    """
    angles = np.random.default_rng(seed).uniform(-np.pi, np.pi, (50, 6))

    def slip_of(length: str) -> Slip:
        def J(turn: Array) -> Array:
            return printed_jacobian(angles + straight(turn), {length: 1.0})

        here, turned = J(np.zeros(3)), J(np.array([np.pi / 2, 0.0, 0.0]))
        slope = slopes(lambda turn: J(turn)[:, :2, 0], 1e-3)[..., 2]
        off = np.max(np.abs(slope - here[:, [1, 0], 2] * [-1.0, 1.0]), axis=0)
        apart = np.max(np.abs(here[:, 1, 0] + turned[:, 0, 0]))
        return Slip("J11" if off[0] > off[1] else "J21", length, float(apart))

    return tuple(slip for slip in map(slip_of, LENGTHS) if slip.size > 1e-12)
