"""The critical load by bisection of eigenvalues."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import bisect

from sk120stiff.stiffness import (
    ConstantCompliance,
    complementary_stiffness,
    symmetric_part,
    under_load,
)
from tests.stiffness.arms import PAPER_SPRINGS, mixed_arm, sk120, sk120_poses


def critical_load(arm, a, direction):
    elastic = ConstantCompliance.of_springs(arm.robot, arm.springs)
    return under_load(elastic, a, direction, ("critical",)).critical


def smallest(arm, screws, load):
    soft = np.isfinite(arm.springs)
    K_C = symmetric_part(complementary_stiffness(screws, load))[np.ix_(soft, soft)]
    return np.linalg.eigvalsh(np.diag(arm.springs[soft]) - K_C)[0]


def by_bisection(arm, a, direction):
    screws = arm.robot.screws(a)
    far = 1e12
    if smallest(arm, screws, far * direction) > 0:
        return np.inf
    return bisect(
        lambda size: smallest(arm, screws, size * direction),
        0.0,
        far,
        xtol=1e-9,
        rtol=1e-12,
        maxiter=200,
    )


@settings(max_examples=30, deadline=None)
@given(
    arm=st.one_of(st.just(sk120()), st.integers(0, 4).map(mixed_arm)),
    seed=st.integers(0, 10_000),
    moment=st.booleans(),
)
def test_definiteness_is_lost_at_the_critical_load(arm, seed, moment):
    rng = np.random.default_rng(seed)
    (a,) = arm.poses(1, seed)
    direction = rng.normal(size=6) * ([1, 1, 1] + [float(moment)] * 3)
    found = float(critical_load(arm, a, direction))
    assert found == pytest.approx(by_bisection(arm, a, direction), rel=1e-9)
    if np.isfinite(found):
        screws = arm.robot.screws(a)
        assert smallest(arm, screws, 0.999 * found * direction) > 0
        assert smallest(arm, screws, 1.001 * found * direction) < 0


def test_it_scales_with_the_direction_and_takes_batches():
    arm, poses = sk120(), sk120_poses(5, 1)
    rng = np.random.default_rng(2)
    directions = np.concatenate([rng.normal(size=(5, 3)), np.zeros((5, 3))], axis=1)
    whole = critical_load(arm, poses, directions)
    assert whole.shape == (5,)
    for k in range(5):
        one = critical_load(arm, poses[k], directions[k])
        assert whole[k] == pytest.approx(float(one), rel=1e-12)
    assert np.allclose(critical_load(arm, poses, 10 * directions), whole / 10, rtol=1e-12)


def test_no_load_is_critical_without_a_direction():
    arm = sk120()
    assert critical_load(arm, np.zeros(6), np.zeros(6)) == np.inf


def test_the_upright_sk120_buckles_at_spring_over_arm_length():
    """Upper arm upright, pressed straight down at the flange: joint 2 gives way at K2 / 1100 mm."""
    arm = sk120()
    a = np.radians([0, 0, -82.5, 0, 0, 0])
    press = np.array([0, 0, -1.0, 0, 0, 0])
    assert critical_load(arm, a, press) == pytest.approx(PAPER_SPRINGS[1] / 1.1)
