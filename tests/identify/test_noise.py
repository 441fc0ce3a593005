"""Which noise a fit takes, and what it says of its choice."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.identify import (
    Problem,
    compare,
    contradiction,
    fit,
    fit_report,
    lack_of_fit,
    solve,
    yardstick,
)
from sk120stiff.identify.report import noise_sentence
from sk120stiff.measurements import NoiseModel, NoiseStatement
from sk120stiff.measurements.noise.repeats import repeated
from sk120stiff.plan import Schedule
from tests.identify.conftest import readings_of, without_statement


def test_a_stated_size_is_believed(springs) -> None:
    found = fit(springs, readings_of(springs, poses=20, sigma=7e-6))
    noise = yardstick(found)
    assert (noise.source, noise.scale, noise.freedom) == ("stated", 1.0, np.inf)
    assert noise.sigma == pytest.approx(7e-6)
    assert noise.floor == pytest.approx(7e-6 * 2**0.5)
    assert found.reasons == ()


def test_an_unstated_size_is_the_scatter_within_poses(springs) -> None:
    found = fit(springs, without_statement(readings_of(springs, poses=30, sigma=7e-6)))
    noise = yardstick(found)
    assert noise.source == "scatter"
    assert noise.sigma == pytest.approx(7e-6, rel=0.15)
    assert "scatter within poses" in noise_sentence(found)


def test_nothing_tells_the_noise_of_one_load_per_pose(springs) -> None:
    readings = readings_of(springs, poses=12, schedule=Schedule("as-given"))
    found = fit(springs, without_statement(readings))
    noise = yardstick(found)
    assert (noise.source, noise.sigma, noise.floor) == ("unknown", None, None)
    assert lack_of_fit(found) is None
    assert "unknown" in noise_sentence(found)


def test_repeats_tell_the_size_whatever_the_model_lacks(springs, robot) -> None:
    rocking = springs + effect(robot, "base_rocking")
    truth = rocking.with_public(**dict.fromkeys(rocking.names[-2:], 4e6))
    steps = Schedule("ascending", 3, 3)
    found = fit(springs, without_statement(readings_of(truth, poses=15, schedule=steps)))
    noise = yardstick(found)
    assert noise.source == "repeats"
    assert noise.sigma == pytest.approx(10e-6, rel=0.15)
    assert noise.freedom == found.problem.noise.freedom < np.inf
    assert lack_of_fit(found).lacking  # the missing foundation is misfit, not noise
    assert any("repeats give" in reason for reason in found.reasons)


def test_a_statement_that_the_scatter_denies_is_said_to_be_denied(springs, robot) -> None:
    """Whatever the model lacks: a missing foundation alone is no contradiction."""
    rocking = springs + effect(robot, "base_rocking")
    truth = rocking.with_public(**dict.fromkeys(rocking.names[-2:], 4e6))
    readings = readings_of(truth, poses=20, sigma=8e-6, schedule=Schedule("ascending", 5))
    assert contradiction(fit(springs, readings)) is None
    found = fit(springs, replace(readings, noise=NoiseStatement(sigma=2e-6)))
    said = contradiction(found)
    assert said is not None and "noise: {sigma: ..., unit: ...}" in said
    assert 3.5 < float(said.split("scatter ")[1].split()[0]) < 4.5
    assert yardstick(found).sigma == 2e-6  # the statement stays the yardstick
    assert contradiction(fit(springs, without_statement(readings))) is None


def up_and_down(springs, robot):
    """Loads up and down at every pose, gears that drag by 0.1 mrad, and a stated σ of 5 µm."""
    model = springs + effect(robot, "friction_hysteresis", "joint_2_l")
    truth = model.with_public(**{"friction_hysteresis:joint_2_l.half_width": 1e-4})
    return readings_of(truth, poses=10, sigma=5e-6, schedule=Schedule("up-down", 4))


def test_an_effect_is_not_taken_for_noise(springs, robot) -> None:
    """Hysteresis of 100 µm: the stated 5 µm stay, springs come out as by plain weighting."""
    readings = up_and_down(springs, robot)
    for data in (readings, replace(readings, branch=None)):
        found = fit(springs, data)
        assert yardstick(found).sigma == 5e-6
        assert found.problem.noise.growth == 0.0
        assert lack_of_fit(found).probability < 1e-6
        plain = solve(Problem(springs, data, NoiseModel(5e-6)))
        np.testing.assert_allclose(found.x, plain.x, rtol=1e-9)
        # the errors hold what is missing, and that is said with the factor
        factor = found.noise_factor
        assert factor > 5.0
        J = plain.jacobian
        np.testing.assert_allclose(found.covariance, np.linalg.inv(J.T @ J) * factor**2, rtol=1e-6)
        assert f"√(χ²/degrees of freedom) is {factor:.3g}" in fit_report(found)


def test_up_and_down_are_no_repeats(springs, robot) -> None:
    """Nobody stated σ: the scatter beside the branches is the tracker's, not that of the gears."""
    noise = yardstick(fit(springs, without_statement(up_and_down(springs, robot))))
    assert noise.source == "scatter"
    assert noise.sigma == pytest.approx(5e-6, rel=0.3)


def test_up_and_down_without_a_branch_are_no_repeats_either(springs, robot) -> None:
    readings = up_and_down(springs, robot)
    bare = replace(readings, branch=None)
    assert repeated(bare) is repeated(readings) is None
    found = fit(springs, without_statement(bare))
    assert found.problem.noise.freedom == 0
    assert found.problem.noise.growth == 0.0


def undescribed(readings):
    bare = replace(readings, zero="unknown", zero_group=readings.pose_index, zero_order=None)
    return without_statement(bare)


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_an_unknown_zero_is_decided_by_the_fit(springs, zero: str) -> None:
    """Neither zero nor σ said: the likelihood of the fits decides, in doubt for shared."""
    right = 0
    for seed in range(40):
        steps = Schedule("ascending", 5, 1, zero)
        readings = readings_of(springs, poses=8, schedule=steps, seed=seed)
        found = fit(springs, undescribed(readings))
        right += found.problem.noise.zero == zero
        assert any(found.problem.noise.zero in reason for reason in found.reasons)
    assert right >= {"shared": 40, "separate": 36}[zero]


def test_readings_far_off_have_no_say_in_what_zeros_are(springs, robot) -> None:
    """A slip at one load of a pose looks like a zero reading of its own."""
    readings = undescribed(readings_of(springs, poses=15, schedule=Schedule("ascending", 3, 1)))
    slips = readings.displacement.copy()
    slips[[7, 22], 2] *= -1.0
    found = fit(springs, replace(readings, displacement=slips))
    assert found.problem.noise.zero == "shared"
    models = {"springs": springs, "rocking": springs + effect(robot, "base_rocking")}
    for line in compare(models, replace(readings, displacement=slips)):
        assert line.fit.problem.noise.zero == "shared"


def test_intervals_hold_where_nobody_described_the_zero(springs) -> None:
    inside, lacking = 0, 0
    for seed in range(60):
        readings = readings_of(springs, poses=6, schedule=Schedule("ascending", 5), seed=seed)
        found = fit(springs, undescribed(readings))
        lacking += lack_of_fit(found).lacking
        for true, (low, high) in zip(springs.parameters, found.intervals(), strict=True):
            inside += low <= true.value <= high
    assert inside >= 0.9 * 180
    assert lacking <= 3


def test_a_stated_size_that_is_far_too_large_stays_the_yardstick(springs) -> None:
    readings = readings_of(springs, poses=30, sigma=5e-6, schedule=Schedule("ascending", 6))
    stated = replace(readings, noise=replace(readings.noise, sigma=15e-6))
    found = fit(springs, stated)
    assert yardstick(found).sigma == 15e-6
    assert lack_of_fit(found).probability > 0.99


def test_noise_that_grows_shows_in_repeats_alone(springs) -> None:
    steps = Schedule("ascending", 3, 3)
    readings = readings_of(springs, poses=20, growth=0.03, seed=1, schedule=steps)
    found = fit(springs, without_statement(readings))
    assert found.problem.noise.growth == pytest.approx(0.03, rel=0.3)
    assert found.problem.noise.sigma == pytest.approx(10e-6, rel=0.4)
    assert any("Repeats scatter the more" in reason for reason in found.reasons)
    stated = fit(springs, replace(readings, noise=NoiseStatement(10e-6)))
    assert stated.problem.noise.growth == pytest.approx(0.03, rel=0.3)
    assert not lack_of_fit(stated).lacking
    once = readings_of(springs, poses=20, growth=0.03, seed=1, schedule=Schedule("ascending", 6))
    assert fit(springs, without_statement(once)).problem.noise.growth == 0.0


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
                inside[zero] += low <= true.value <= high
    assert inside["shared"] >= 0.9 * 120
    assert inside["separate"] < inside["shared"]
