"""Which noise a fit takes, and what it says of its choice."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import effect, situation_of
from sk120stiff.identify import fit
from sk120stiff.measurements import NoiseModel
from sk120stiff.plan import Schedule
from tests.identify.conftest import readings_of, without_statement


def test_a_stated_size_is_believed(springs) -> None:
    found = fit(springs, readings_of(springs, poses=20, sigma=7e-6))
    assert found.sigma_stated
    assert found.sigma == pytest.approx(7e-6)
    assert found.reasons == ()


def test_an_unstated_size_is_estimated(springs) -> None:
    found = fit(springs, without_statement(readings_of(springs, poses=30, sigma=7e-6)))
    assert not found.sigma_stated
    assert found.sigma == pytest.approx(7e-6, rel=0.1)
    assert any("No uncertainty is stated" in reason for reason in found.reasons)


def test_repeats_tell_the_size_whatever_the_model_lacks(springs, robot) -> None:
    rocking = springs + effect(robot, "base_rocking")
    truth = rocking.with_public(**dict.fromkeys(rocking.names[-2:], 4e6))
    steps = Schedule("ascending", 3, 3)
    found = fit(springs, without_statement(readings_of(truth, poses=15, schedule=steps)))
    assert found.problem.noise.sigma == pytest.approx(10e-6, rel=0.15)
    assert found.problem.noise.stated
    assert found.noise_factor > 1.5  # the missing foundation is misfit, not noise


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_an_unknown_zero_is_told_from_the_scatter(springs, zero: str) -> None:
    steps = Schedule("ascending", 5, 1, zero)
    readings = readings_of(springs, poses=20, schedule=steps, seed=3)
    silent = replace(readings, zero="unknown", zero_group=readings.pose_index, zero_order=None)
    found = fit(springs, silent)
    assert found.problem.noise.zero == zero
    assert any(zero in reason for reason in found.reasons)


def test_a_stated_size_that_is_far_too_large_is_not_believed(springs) -> None:
    readings = readings_of(springs, poses=30, sigma=5e-6, schedule=Schedule("ascending", 6))
    stated = replace(readings, noise=replace(readings.noise, sigma=15e-6))
    found = fit(springs, stated)
    assert found.sigma == pytest.approx(5e-6, rel=0.15)
    assert any("scatter" in reason for reason in found.reasons)


def test_noise_that_grows_is_found(springs) -> None:
    readings = without_statement(readings_of(springs, poses=30, growth=0.03, seed=1))
    found = fit(springs, readings)
    assert found.problem.noise.growth * found.noise_factor == pytest.approx(0.03, rel=0.4)
    assert any("grows" in reason for reason in found.reasons)


def test_a_jump_that_the_model_explains_is_no_noise(springs, robot) -> None:
    """Loads in all directions at a pose: play looks like scatter until it is fitted."""
    model = springs + effect(robot, "lost_motion", "joint_1_s")
    truth = model.with_public(**{"lost_motion:joint_1_s.half_width": 2e-4})
    readings = readings_of(truth, poses=12, schedule=Schedule("as-given"))
    rng = np.random.default_rng(0)
    # five more directions at every pose
    many = replace(
        readings,
        pose=readings.pose * 6,
        joints=np.tile(readings.joints, (6, 1)),
        wrench=np.vstack([np.hstack([400 * _unit(rng, 12), np.zeros((12, 3))]) for _ in range(6)]),
        displacement=np.zeros((72, 3)),
        order=None,
        zero_order=None,
        zero_group=np.tile(readings.zero_group, 6),
        zero_count=np.ones(72),
        use=np.ones(72),
        line=np.zeros(72),
    )
    exact = truth.predict(situation_of(robot, many))
    zero = rng.normal(size=(12, 3))[many.zero_group]
    noisy = exact + 10e-6 * (rng.normal(size=(72, 3)) - zero)
    many = replace(many, displacement=noisy)
    found = fit(model, many)
    assert found.problem.noise.growth == 0.0
    assert found.sigma == pytest.approx(10e-6)
    assert found.lack_of_fit > 0.01
    blind = fit(springs, many)
    assert blind.sigma > 10e-6 or blind.problem.noise.growth > 0.0


def _unit(rng: np.random.Generator, count: int) -> np.ndarray:
    x = rng.normal(size=(count, 3))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def test_a_given_noise_is_taken_as_it_is(springs, table2) -> None:
    noise = NoiseModel(3e-6, 0.01, "separate")
    found = fit(springs, table2, noise=noise)
    assert found.problem.noise == noise
    assert found.reasons == ()


def test_shared_zeros_matter(springs) -> None:
    """Taken for independent, errors of a shared zero make wrong standard errors."""
    inside = {"shared": 0, "separate": 0}
    for seed in range(40):
        readings = readings_of(springs, poses=8, seed=seed, schedule=Schedule("ascending", 8))
        for zero in ("shared", "separate"):
            found = fit(springs, readings, noise=NoiseModel(10e-6, zero=zero))
            for true, (low, high) in zip(springs.parameters, found.intervals(), strict=True):
                inside[zero] += low <= true.public_value <= high
    assert inside["shared"] >= 0.9 * 120
    assert inside["separate"] < inside["shared"]
