"""Tests of a fitted model against what is known of the noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sk120stiff.effects import effect
from sk120stiff.identify import LackOfFit, Problem, fit, lack_of_fit, solve
from sk120stiff.identify.robust import solve_robustly
from sk120stiff.measurements import NoiseModel
from sk120stiff.plan import Schedule
from tests.identify.conftest import readings_of, without_statement

NOISE = NoiseModel(10e-6)
UNSTATED = replace(NOISE, freedom=0)


def rocking(springs, robot):
    model = springs + effect(robot, "base_rocking")
    names = model.names[-2:]
    return model, model.with_public(**{names[0]: 1e7, names[1]: 1e7})


def test_stated_uncertainty_is_a_chi_square(springs) -> None:
    found = solve(Problem(springs, readings_of(springs), NOISE))
    test = lack_of_fit(found)
    assert test.against == "stated"
    assert test.probability == pytest.approx(stats.chi2.sf(found.chi_square, 144 - 3), rel=1e-12)
    assert not test.lacking
    assert "agree" in test.sentence()
    halved = lack_of_fit(solve(Problem(springs, readings_of(springs), NoiseModel(5e-6))))
    assert halved.lacking


def test_pure_error_by_the_textbook(springs) -> None:
    """Separate zeros: plain analysis of variance, cell means by hand."""
    steps = Schedule("ascending", 3, 2, "separate")
    readings = without_statement(readings_of(springs, poses=8, schedule=steps))
    found = fit(springs, readings)
    test = lack_of_fit(found)
    assert test.against == "repeats"
    assert not found.problem.noise.stated
    pairs = readings.displacement.reshape(24, 2, 3)
    within = ((pairs - pairs.mean(axis=1, keepdims=True)) ** 2).sum()
    assert test.freedom == (144 - 3 - 72, 72)
    whole = (found.gap**2).sum()
    by_hand = (whole - within) / (144 - 3 - 72) / (within / 72)
    assert test.statistic == pytest.approx(by_hand, rel=1e-6)
    assert test.probability == pytest.approx(stats.f.sf(by_hand, 69, 72), rel=1e-5)


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_repeats_find_a_missing_foundation(springs, robot, zero: str) -> None:
    model, truth = rocking(springs, robot)
    steps = Schedule("ascending", 3, 2, zero)
    readings = without_statement(readings_of(truth, poses=8, schedule=steps))
    assert lack_of_fit(fit(springs, readings)).lacking
    assert not lack_of_fit(fit(model, readings)).lacking


def test_one_question_has_one_answer(springs) -> None:
    """Where σ is stated it is the yardstick, whatever repeats say besides."""
    steps = Schedule("ascending", 3, 2)
    readings = readings_of(springs, poses=8, schedule=steps)
    assert lack_of_fit(fit(springs, readings)).against == "stated"
    assert lack_of_fit(fit(springs, without_statement(readings))).against == "repeats"


def test_the_scatter_within_poses_stands_in(springs, robot) -> None:
    model, truth = rocking(springs, robot)
    readings = without_statement(readings_of(truth, poses=12, schedule=Schedule("ascending", 6)))
    short = lack_of_fit(fit(springs, readings))
    whole = lack_of_fit(fit(model, readings))
    assert short.against == whole.against == "scatter"
    assert short.lacking
    assert not whole.lacking


def test_false_alarms_come_as_often_as_they_say(springs) -> None:
    """True models under each yardstick: p below 0.1 in about a tenth of them."""
    counts = {"stated": 0, "repeats": 0, "within": 0}
    for seed in range(60):
        repeated = readings_of(springs, poses=5, seed=seed, schedule=Schedule("ascending", 3, 2))
        steps = readings_of(springs, poses=5, seed=seed, schedule=Schedule("ascending", 6))
        found = {
            "stated": solve(Problem(springs, steps, NOISE)),
            "repeats": fit(springs, without_statement(repeated)),
            "within": solve(Problem(springs, steps, UNSTATED)),
        }
        for name, one in found.items():
            counts[name] += lack_of_fit(one).probability < 0.1
    for name, count in counts.items():
        assert stats.binomtest(count, 60, 0.1).pvalue > 1e-3, (name, count)


def test_no_test_without_a_yardstick(springs) -> None:
    few = without_statement(readings_of(springs, poses=3, schedule=Schedule("as-given")))
    assert lack_of_fit(solve(Problem(springs, few, UNSTATED))) is None
    many = readings_of(springs)
    assert lack_of_fit(solve_robustly(Problem(springs, many, NOISE))) is None


def test_counted_freedom(springs) -> None:
    readings = readings_of(springs, poses=4)
    found = solve(Problem(springs, readings, NOISE))
    assert found.degrees_of_freedom == 3 * readings.n_readings - 3
    assert np.isclose(found.noise_factor**2 * found.degrees_of_freedom, found.chi_square)


def test_a_stated_uncertainty_that_is_exceeded_is_told() -> None:
    test = LackOfFit("stated", 321.0 * 37.6**2, (321, None), 0.0, 37.6)
    assert "too small, or something is missing in the model" in test.of_the_statement()
    assert test.sentence().endswith("p < 0.000001.")  # no probability is zero
    assert not replace(test, against="scatter").of_the_statement()


def test_a_stated_uncertainty_that_is_too_large_is_told() -> None:
    test = LackOfFit("stated", 80.0, (321, None), 1.0, 0.5)
    assert test.of_the_statement() == "σ looks 2.00 times too large; it stays the yardstick."
    assert not LackOfFit("stated", 321.0, (321, None), 0.5, 1.0).of_the_statement()
