"""Work and energy: what the load does along its path is what the springs hold."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sk120stiff.stiffness import (
    complementary_stiffness,
    equilibrium,
    linear_springs,
    loading_balance,
    paper_work,
)
from sk120stiff.stiffness.energy import quadratic
from tests.stiffness.arms import PAPER_SPRINGS, POINT, mixed_arm, sk120, sk120_poses

HEAVY = np.array([5000.0, -6000.0, 6000.0, 0, 0, 0])


@pytest.mark.parametrize("arm", [sk120(), mixed_arm(0), mixed_arm(4)], ids=["sk120", "a", "b"])
def test_work_along_the_path_is_the_stored_energy(arm):
    poses = sk120_poses(4, 3) if arm.n == 6 else arm.poses(4, 3)
    work, energy = loading_balance(arm.mechanism, poses, HEAVY, arm.springs, POINT)
    assert work.shape == energy.shape == (4,)
    assert np.allclose(work, energy, rtol=1e-10)
    # nothing here is linear: half of force times displacement misses by a margin
    rest = equilibrium(arm.mechanism, poses, HEAVY, linear_springs(arm.springs), point=POINT)
    moved = rest.screws.position - arm.robot.screws(poses, point=POINT).position
    half = 0.5 * (HEAVY[:3] * moved).sum(-1)
    assert np.max(np.abs(half / energy - 1)) > 1e-3


def test_work_by_walking_the_path():
    """The trapezium rule over positions alone, with matrices for the kinematics."""
    arm = mixed_arm(2)
    (a,) = arm.poses(1, 6)
    factors = np.linspace(0, 1, 401)
    law = linear_springs(arm.springs)
    path = [
        arm.position(equilibrium(arm.mechanism, a, f * HEAVY, law, point=POINT).z) for f in factors
    ]
    forces = factors[:, None] * HEAVY[:3]
    walked = np.sum(0.5 * (forces[1:] + forces[:-1]) * np.diff(path, axis=0))
    work, energy = loading_balance(arm.mechanism, a, HEAVY, arm.springs, POINT)
    assert walked == pytest.approx(float(work), rel=1e-5)
    rest = equilibrium(arm.mechanism, a, HEAVY, law, point=POINT)
    assert energy == pytest.approx(0.5 * np.sum(arm.springs * (rest.z - a) ** 2), rel=1e-12)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), size=st.floats(1e-6, 0.1))
def test_eq_14_and_15_agree_by_congruence_for_any_displacement(seed, size):
    """The enhanced works agree whatever was displaced, so that agreement says nothing of data."""
    rng = np.random.default_rng(seed)
    (a,) = sk120_poses(1, seed % 13)
    screws, force = _three(a), 300 * rng.normal(size=3)
    moved = size * rng.normal(size=3)
    works = paper_work(screws, PAPER_SPRINGS, force, moved)
    assert works.joint_enhanced == pytest.approx(float(works.cartesian), rel=1e-9)
    load = np.array([*force, 0, 0, 0])
    turned = np.linalg.solve(screws.linear_jacobian, moved)
    K_C = complementary_stiffness(screws, load)
    gap = works.joint_conventional - works.joint_enhanced
    scale = abs(float(works.joint_conventional))
    assert gap == pytest.approx(0.5 * turned @ K_C @ turned, rel=1e-6, abs=1e-10 * scale)


def test_eq_14_by_hand():
    """Without a force K_C vanishes: the work is that of the springs alone."""
    (a,) = sk120_poses(1, 0)
    screws, moved = _three(a), np.array([1e-3, -2e-3, 5e-4])
    none = paper_work(screws, PAPER_SPRINGS, np.zeros(3), moved)
    turned = np.linalg.solve(screws.linear_jacobian, moved)
    by_hand = 0.5 * np.sum(PAPER_SPRINGS * turned**2)
    assert none.cartesian == pytest.approx(by_hand) == pytest.approx(none.joint_conventional)
    force = np.array([100.0, 50.0, -20.0])
    some = paper_work(screws, PAPER_SPRINGS, force, moved)
    assert some.joint_conventional == pytest.approx(by_hand + force @ moved)


def test_the_works_of_eq_14_count_three_times_what_the_load_did():
    """Fᵀ ΔX + ½ ΔXᵀ K ΔX supposes that F was there before ΔX began; a load that grows does half."""
    arm, load = sk120(), np.array([200.0, -100.0, 150.0, 0, 0, 0])
    (a,) = sk120_poses(1, 4)
    rest = equilibrium(arm.mechanism, a, load, linear_springs(arm.springs))
    moved = rest.screws.position - arm.robot.screws(a).position
    works = paper_work(_three(a), PAPER_SPRINGS, load[:3], moved)
    work, _ = loading_balance(arm.mechanism, a, load, arm.springs)
    assert works.cartesian / work == pytest.approx(3.0, rel=0.01)


def test_batch_is_the_loop():
    poses, rng = sk120_poses(4, 7), np.random.default_rng(1)
    forces, moved = 100 * rng.normal(size=(4, 3)), 1e-3 * rng.normal(size=(4, 3))
    whole = paper_work(_three(poses), PAPER_SPRINGS, forces, moved)
    for k in range(4):
        one = paper_work(_three(poses[k]), PAPER_SPRINGS, forces[k], moved[k])
        for name in ("cartesian", "joint_enhanced", "joint_conventional"):
            assert getattr(whole, name)[k] == pytest.approx(float(getattr(one, name)), rel=1e-12)
    M, x = rng.normal(size=(2, 3, 3)), rng.normal(size=(2, 3))
    assert np.allclose(quadratic(M, x), [v @ m @ v for m, v in zip(M, x, strict=True)])


def _three(a):
    """Screws of the SK120 in its three elastic coordinates."""
    screws = sk120().robot.screws(a)
    return replace(screws, first=screws.first[..., :3])
