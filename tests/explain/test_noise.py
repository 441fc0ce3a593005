"""The noise of an answer: what was stated is the yardstick, and no effect is taken for noise."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import Model, base_model, load_robot
from sk120stiff.explain import Explanation
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.identify import fit, lack_of_fit
from sk120stiff.identify.checks.yardstick import scatter
from sk120stiff.measurements import NoiseStatement
from sk120stiff.show.stories.verdicts import lead_of, title_of
from tests.explain.readings import SIGMA, answered, hidden
from tests.hidden.generator.causes_elastic import BaseRocking
from tests.hidden.generator.causes_joint import FrictionHysteresis, Memory

DRAG = FrictionHysteresis("joint_2_l", {"half_width": 2e-4})


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


def understated(seed, factor, *, poses=10, loads=4):
    readings = hidden(seed=seed, poses=poses, loads=loads)
    return replace(readings, noise=NoiseStatement(sigma=SIGMA / factor))


@pytest.fixture(scope="module")
def halved(springs: Model) -> Explanation:
    """Readings that are twice as noisy as stated."""
    return answered(springs, understated(101, 2.0))


def test_a_stated_uncertainty_that_is_a_little_too_small_is_said_to_be(springs):
    answer = answered(springs, understated(100, 1.35))
    assert_said_to_be_too_small(answer, 1.35)


def test_a_stated_uncertainty_of_half_the_size_is_said_to_be(halved):
    assert_said_to_be_too_small(halved, 2.0)


def assert_said_to_be_too_small(answer, factor):
    assert answer.verdict == "none"
    assert answer.adequacy.understated == pytest.approx(factor, rel=0.1)
    assert "times too small; nothing structured is left" in " ".join(answer.noise_reasons)
    assert answer.noise.sigma == SIGMA / factor  # it stays the yardstick
    assert answer.noise_floor == pytest.approx(2**0.5 * SIGMA / factor)
    assert title_of(answer) == "Nothing structured is missing, but σ looks too small"


def test_a_statement_that_is_a_wrong_number_is_said_to_be(springs):
    answer = answered(springs, understated(101, 4.0))
    assert_said_to_be_too_small(answer, 4.0)
    assert "Correct the stated σ to about" in next_step(answer)


def test_a_statement_exceeded_eight_times_is_a_finding(springs):
    answer = answered(springs, understated(100, 9.0))
    assert answer.verdict == "outside"
    assert "times the stated uncertainty" in " ".join(answer.noise_reasons)


def test_too_few_readings_for_a_scatter_still_tell_noise_from_what_poses_have(springs):
    """Nothing within a pose is left to scatter, and yet readings err each by itself."""
    answer = answered(springs, understated(100, 2.5, poses=20, loads=2))
    assert scatter(answer.final) is None
    assert_said_to_be_too_small(answer, 2.5)


def test_one_reading_a_pose_tells_neither_noise_nor_a_cause(springs):
    answer = answered(springs, understated(100, 2.5, poses=40, loads=1))
    assert answer.verdict == "outside"
    assert answer.adequacy.undecided and answer.adequacy.understated is None
    assert "nothing tells whether the readings are noisier" in lead_of(answer)
    assert "has no structure" in " ".join(answer.noise_reasons)


def test_hysteresis_is_named_and_not_taken_for_noise(springs):
    answer = answered(springs, hidden(DRAG, schedule="up_down", loads=6, poses=8, sigma=5e-6))
    assert [finding.effect.id for finding in answer.findings] == ["friction_hysteresis:joint_2_l"]
    assert answer.noise.sigma == 5e-6
    assert answer.noise_floor == pytest.approx(2**0.5 * 5e-6)


def test_hysteresis_that_nothing_can_name_is_outside(springs):
    """Neither branch nor order: the effect cannot be named, and is no noise for all that."""
    readings = hidden(DRAG, schedule="up_down", loads=4, poses=5, sigma=5e-6)
    bare = replace(readings, branch=None, order=None, zero_order=None)
    answer = answered(springs, bare)
    assert answer.verdict == "outside"
    assert answer.noise.sigma == 5e-6


def test_a_foreign_memory_is_not_called_noise(springs):
    cause = Memory("joint_2_l", {"share": 0.4}, {"play": 150.0})
    answer = answered(springs, hidden(cause, schedule="up_down", loads=3, poses=6, sigma=5e-6))
    assert answer.verdict != "none"


def test_one_question_has_one_number(springs):
    """The same p and the same floor from the fit, the answer, and its file."""
    readings = hidden(seed=100, stated=False)
    answer = answered(springs, readings)
    found = fit(springs, readings)
    document = answer.document().as_keys()
    test = lack_of_fit(found)
    assert answer.verdict == "none"
    assert document["gap"]["p"] == pytest.approx(test.probability, rel=1e-9)
    assert document["gap"]["noise_floor"] == pytest.approx(
        1e6 * answer.details["localisation"].noise, rel=1e-9
    )
    assert answer.details["localisation"].probability == pytest.approx(test.probability)


def test_an_unknown_noise_has_no_floor(springs):
    """One load per pose, nobody stated σ: the gap is no yardstick of the gap."""
    cause = BaseRocking("base_link", {"x": 2e-7, "y": 2e-7})
    readings = hidden(cause, loads=1, poses=40, stated=False)
    answer = answered(springs, readings)
    document = answer.document().as_keys()
    assert document["gap"]["noise_floor"] is None
    assert document["gap"]["p"] is None
    assert document["noise"]["source"] == "unknown"


def test_errors_hold_what_is_left(springs, halved):
    """An answer that leaves more than the stated noise widens its errors by as much."""
    honest = fit(springs, hidden(seed=101, poses=10, loads=4))
    assert [p.internal_std for p in halved.final.parameters] == pytest.approx(
        [p.internal_std for p in honest.parameters], rel=0.1
    )
    assert np.isfinite(halved.final.unit)


def test_a_gap_of_rounding_is_nothing(springs):
    """Computed readings: a floor as stiff as this moves the point by picometres."""
    floor = BaseRocking("base_link", {"x": 2e-15, "y": 2e-15})
    readings = hidden(floor, sigma=1e-16, stated=False)
    answer = answered(springs, readings)
    assert answer.base.rms < 1e-10
    assert answer.verdict == "none" and not answer.findings
    document = answer.document().as_keys()
    assert document["noise"]["source"] == "computed"
    assert "the readings were computed" in answer.yardstick.sentence()


def test_what_would_explain_most_beyond_belief_is_to_be_checked(halved):
    said = next_step(replace(halved, beyond="force_point:sensor"))
    assert said.startswith(next_step(halved))
    assert "Of all that could be added force_point:sensor would explain the most" in said
    assert "write force: {point: ...}" in said and "--assume force_point:sensor" in said
