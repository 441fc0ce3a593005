"""Forces that were read by hand: what their errors move, and how large single poses say they are.

Readings come from the generator of the blind benchmark, which shares no code with the package.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import Model, base_model, fit, load_robot, simulate
from sk120stiff.effects import load_cases_of
from sk120stiff.identify.noise.growing import growing
from sk120stiff.identify.solve.forces import with_by_force
from sk120stiff.measurements import NoiseModel, NoiseStatement
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.sk120 import sk120

SHARE, SIGMA = 0.02, 3e-6
TRUE = sk120().typical.joint  # N·m/rad


@pytest.fixture(scope="module")
def springs() -> Model:
    return base_model(load_robot("motoman_sk120"))


def test_what_a_force_moves_is_the_compliance_of_the_arm(springs: Model) -> None:
    readings = hidden(sigma=SIGMA)
    small = replace(readings, wrench=1e-3 * readings.wrench)
    moved = with_by_force(springs, small).by_force
    assert moved is not None
    cases = load_cases_of(springs.robot, small)
    compliance = {p.effect.where: p.internal for p in springs.parameters}
    c = np.array([compliance.get(name, 0.0) for name in springs.robot.actuated])
    J = cases.nominal.linear_jacobian
    force = np.linalg.norm(small.wrench[:, :3], axis=1)[:, None, None]
    exact = force * (J * c) @ np.swapaxes(J, 1, 2)
    np.testing.assert_allclose(moved, exact, rtol=0, atol=1e-4 * np.abs(exact).max())


@pytest.mark.parametrize("stated", [True, False])
def test_single_poses_tell_how_far_off_forces_are(stated: bool) -> None:
    found = base_fit(hidden(sigma=SIGMA, force_error=SHARE, stated=stated), noise=None)
    assert found.problem.noise.force == pytest.approx(SHARE, rel=0.2)
    assert found.problem.noise.growth == 0.0
    if stated:
        assert found.problem.noise.sigma == SIGMA  # it stays the yardstick
        assert not found.exceeds
    assert any("gauge held by hand" in reason for reason in found.reasons)


def test_forces_that_are_as_written_are_not_doubted() -> None:
    doubted = [
        seed
        for seed in range(12)
        if growing(base_fit(hidden(sigma=SIGMA, seed=seed), noise=NoiseModel(SIGMA))) is not None
    ]
    assert not doubted


def test_a_statement_too_small_by_a_third_is_no_error_of_forces() -> None:
    readings = replace(hidden(sigma=1.5 * SIGMA), noise=NoiseStatement(SIGMA))
    assert base_fit(readings, noise=None).problem.noise.force == 0.0


def test_what_is_stated_counts_and_none_is_none() -> None:
    readings = hidden(sigma=SIGMA, force_error=SHARE)
    said = replace(readings, noise=NoiseStatement(SIGMA, force=0.01))
    assert base_fit(said, noise=None).problem.noise.force == 0.01
    none = replace(readings, noise=NoiseStatement(SIGMA, growth=0.0, force=0.0))
    found = base_fit(none, noise=None)
    assert found.problem.noise.force == 0.0
    assert found.exceeds


def test_intervals_hold_the_truth(springs: Model) -> None:
    """Of 20 campaigns of three springs each; as noise of one size it would be 79 %."""
    held = []
    for seed in range(20):
        found = base_fit(hidden(sigma=SIGMA, force_error=SHARE, seed=seed), noise=None)
        for parameter, (low, high) in zip(found.parameters, found.intervals(), strict=True):
            held.append(low <= TRUE[parameter.effect.where] <= high)
    assert np.mean(held) >= 0.85


def test_simulated_readings_have_it(springs: Model) -> None:
    plan = replace(hidden(sigma=SIGMA), displacement=None)
    made = simulate(springs, plan, noise=NoiseModel(SIGMA, force=SHARE), seed=4).measurements
    assert made.noise == NoiseStatement(SIGMA, force=SHARE)
    bare = replace(made, noise=NoiseStatement(SIGMA))
    assert fit(springs, bare).problem.noise.force == pytest.approx(SHARE, rel=0.2)
