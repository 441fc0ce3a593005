"""Forces that were read by hand: what their errors move, and how large single poses say they are.

Readings come from the generator of the blind benchmark, which shares no code with the package.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sk120stiff import Model, base_model, fit, load_robot, simulate
from sk120stiff.effects import load_cases_of
from sk120stiff.identify.noise.growing import growing
from sk120stiff.identify.solve.forces import with_by_force
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement
from sk120stiff.plan import Schedule
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.causes_joint import LostMotion
from tests.hidden.generator.sk120 import sk120

SHARE, SIGMA = 0.02, 3e-6
TRUE = sk120().typical.joint  # N·m/rad


def pulled(**how: Any) -> Measurements:
    return hidden(**{"sigma": SIGMA, "force_error": SHARE, "loads": 8, **how})


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
    found = base_fit(pulled(stated=stated), noise=None)
    told = growing(found)
    assert told is not None
    assert told.force == pytest.approx(SHARE, rel=0.2)
    assert told.growth == 0.0
    if stated:
        assert told.sigma == SIGMA  # it stays the yardstick


def test_a_fit_says_so_and_takes_nothing_for_it() -> None:
    """Its model may lack lost motion, which looks alike."""
    found = base_fit(pulled(), noise=None)
    assert found.problem.noise.force == 0.0
    assert found.exceeds
    (said,) = (reason for reason in found.reasons if "gauge held by hand" in reason)
    assert "'noise: {force: 0.0" in said


def test_what_is_stated_counts() -> None:
    found = base_fit(replace(pulled(), noise=NoiseStatement(SIGMA, force=SHARE)), noise=None)
    assert found.problem.noise.force == SHARE
    assert not found.exceeds
    none = base_fit(replace(pulled(), noise=NoiseStatement(SIGMA, force=0.0)), noise=None)
    assert none.problem.noise.force == 0.0


def test_poses_with_few_loads_tell_nothing() -> None:
    """With loads all around, five leave no room for a constant and a curve: lost motion has it."""
    assert growing(base_fit(pulled(loads=5))) is None
    assert (
        growing(base_fit(hidden(LostMotion("joint_2_l", {"half_width": 5e-5}), sigma=SIGMA)))
        is None
    )


def test_forces_that_are_as_written_are_not_doubted() -> None:
    for seed in range(8):
        sound = base_fit(hidden(sigma=SIGMA, seed=seed, loads=8), noise=NoiseModel(SIGMA))
        assert growing(sound) is None


def test_a_statement_too_small_by_a_third_is_no_error_of_forces() -> None:
    readings = replace(hidden(sigma=1.5 * SIGMA, loads=8), noise=NoiseStatement(SIGMA))
    assert growing(base_fit(readings, noise=None)) is None


def test_a_slip_is_none_either() -> None:
    readings = hidden(sigma=SIGMA, loads=8)
    assert readings.displacement is not None
    off = readings.displacement.copy()
    off[np.linalg.norm(off, axis=1).argmax()] += 150e-6
    found = base_fit(replace(readings, displacement=off), noise=None)
    assert not any("gauge" in reason for reason in found.reasons)


def test_repeats_count_what_is_stated_once(springs: Model) -> None:
    """They scatter by the errors of forces too: their growth is not taken beside."""
    plan = replace(hidden(sigma=SIGMA, poses=12), displacement=None)
    thrice = Schedule("as-given", repeats=3)
    noise = NoiseModel(SIGMA, force=SHARE)
    made = simulate(springs, plan, noise=noise, schedule=thrice, seed=4).measurements
    found = fit(springs, made)
    assert (found.problem.noise.growth, found.problem.noise.force) == (0.0, SHARE)
    assert found.noise_factor == pytest.approx(1.0, abs=0.1)


def test_intervals_hold_the_truth() -> None:
    """Of 20 campaigns of three springs each; as noise of one size it would be 92 %, 1.3 wide."""
    found = [
        base_fit(
            replace(pulled(seed=seed, loads=5), noise=NoiseStatement(SIGMA, force=SHARE)), None
        )
        for seed in range(20)
    ]
    off = [(p.value - TRUE[p.effect.where]) / p.std for fit in found for p in fit.parameters]
    assert np.std(off) == pytest.approx(1.0, abs=0.2)


def test_readings_with_what_forces_move_are_joined_with_those_without(springs: Model) -> None:
    """That belongs to a model, and not to a file: `explain --holdout` joins both."""
    known, second = with_by_force(springs, pulled()), pulled(seed=8)
    second = replace(second, pose=tuple(f"again {label}" for label in second.pose))
    joined = known + second
    assert joined.by_force is None
    assert joined.n_readings == known.n_readings + second.n_readings


def test_simulated_readings_have_it(springs: Model) -> None:
    plan = replace(hidden(sigma=SIGMA, loads=8), displacement=None)
    made = simulate(springs, plan, noise=NoiseModel(SIGMA, force=SHARE), seed=4).measurements
    assert made.noise == NoiseStatement(SIGMA, force=SHARE)
    told = growing(fit(springs, replace(made, noise=NoiseStatement(SIGMA))))
    assert told is not None and told.force == pytest.approx(SHARE, rel=0.2)
