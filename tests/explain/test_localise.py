"""Where the gap lives: right place, right words, no false alarm, on data of the other generator."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import stats

from sk120stiff.explain import Localisation, localise, where_sentences
from sk120stiff.explain.localise.changes import YIELDS_SINCE
from sk120stiff.explain.localise.places import holm
from sk120stiff.explain.localise.suspects import CLOCKS, TO_AND_FRO, suspects_of
from sk120stiff.measurements import Measurements, NoiseModel
from tests.explain.readings import SIGMA, base_fit, hidden
from tests.hidden.generator.causes_elastic import BaseRocking, ClosureCoupling, JointTilt
from tests.hidden.generator.causes_foreign import Hose, TrackerStand
from tests.hidden.generator.causes_joint import (
    Creep,
    FrictionHysteresis,
    GearHardening,
    LostMotion,
    PeriodicGear,
)
from tests.hidden.generator.causes_sensor import ForceScale, ReadingDrift, ReadingRotation
from tests.hidden.generator.world import Cause

SHOULDER = "joint_2_l"


@dataclass(frozen=True)
class Expected:
    """What must be said of a cause: any of some suspects, and words of the sentences."""

    cause: Cause
    strongest: tuple[str, ...]
    words: tuple[str, ...] = ()
    schedule: str = "scattered"


CASES = {
    "rocking base": Expected(
        BaseRocking("base_link", {"x": 2e-7, "y": 2e-7}),
        ("the moment that tips the base", "the moment that joint_1_s carries across its axis"),
        ("in proportion to the load, as with anything that yields",),
        "ascending",
    ),
    "tilting shoulder": Expected(
        JointTilt(SHOULDER, {"first": 4e-7, "second": 4e-7}),
        ("the moment that joint_2_l carries across its axis",),
        ("sideways, out of the arm's plane", "does not go with the order of the readings"),
        "ascending",
    ),
    "stiffening gear": Expected(
        GearHardening("joint_1_s", {"cubic": 0.8}, {"T": 700.0}),
        ("the torque of joint_1_s, not in proportion to it",),
        ("sideways, out of the arm's plane", "which no plain spring makes"),
        "ascending",
    ),
    "play": Expected(
        LostMotion(SHOULDER, {"half_width": 1.5e-4}),
        ("the sign of the torque of joint_2_l",),
    ),
    "friction": Expected(
        FrictionHysteresis("joint_1_s", {"half_width": 6e-5}),
        ("loading or unloading of joint_1_s",),
        (),
        "up_down",
    ),
    "turned tracker": Expected(
        ReadingRotation("tracker", {"x": 0.01, "y": -0.02, "z": 0.02}),
        ("a misread displacement in reading axes",),
    ),
    "misread force": Expected(
        ForceScale("sensor", {"x": 0.08, "y": -0.06, "z": 0.0}),
        ("a misread load in tool axes",),
    ),
    "drift": Expected(
        ReadingDrift("tracker", {"x": 8e-6, "y": -6e-6, "z": 9e-6}),
        ("the order of the readings",),
    ),
    "linkage": Expected(
        ClosureCoupling("joint_2_l,joint_3_u", {"compliance": 1e-7}),
        ("the torques of joint_2_l and joint_3_u, each moving the other joint",),
    ),
    "tracker on the robot's floor": Expected(
        TrackerStand("tracker", {"compliance": 1e-7}, {"at": (3.5, -0.8, -0.3)}),
        ("the moment that tips the floor under base and tracker",),
    ),
    "creep": Expected(
        Creep(SHOULDER, {"share": 0.5}, {"time": 3.0}),
        ("the torque of joint_2_l as it lasts, in creep",),
    ),
    "teeth": Expected(
        PeriodicGear(SHOULDER, {"share": 0.3}, {"count": 7, "phase": 1.0}),
        ("the position of joint_2_l, on which its own stiffness depends in 7 waves a turn",),
    ),
    "hose": Expected(
        Hose("tool0", {"stiffness": 20e3, "drag": 15.0}),
        ("something that holds the tool against its motion, a hose or a cable",),
    ),
}


@pytest.fixture(scope="module", params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Expected, Localisation, Measurements]:
    expected = CASES[request.param]
    readings = hidden(expected.cause, schedule=expected.schedule)
    return expected, localise(base_fit(readings)), readings


def test_the_strongest_suspect_is_the_cause(case) -> None:
    expected, found, _ = case
    assert found.real
    assert found.strongest is not None
    assert found.strongest.name in expected.strongest
    assert found.strongest.explained > 0.85
    assert found.probability is not None and found.probability < 1e-6


def test_sentences_name_it_with_numbers(case) -> None:
    expected, found, _ = case
    sentences = where_sentences(found)
    text = " ".join(sentences)
    assert f"The base model misses the readings by {1e6 * found.rms:#.3g} µm" in text
    assert any(name in text for name in expected.strongest)
    for words in expected.words:
        assert words in text
    assert all(sentence.endswith(".") and not sentence[0].islower() for sentence in sentences)


def test_nothing_is_left_once_the_strongest_is_known(case) -> None:
    _, found, _ = case
    assert found.beside
    assert found.beside[0].explained < 0.06


def test_what_is_drawn_belongs_to_the_readings(case) -> None:
    _, found, readings = case
    drawn = [s for s in found.suspects if s.partial.size]
    assert 1 <= len(drawn) <= 8
    assert drawn[0] is found.strongest
    for suspicion in drawn:
        assert suspicion.abscissa.shape == suspicion.partial.shape == (readings.n_readings,)
        assert np.isfinite(suspicion.partial).all()


def test_shares_add_up(case) -> None:
    _, found, readings = case
    assert sum(pose.share for pose in found.poses) == pytest.approx(1.0)
    assert {pose.label for pose in found.poses} == set(readings.poses)
    assert sum(level.count for level in found.levels) == readings.n_readings
    for axes in ("world", "arm plane", "forearm", "tool"):
        assert sum(d.share for d in found.directions if d.axes == axes) == pytest.approx(1.0)
    squares = sum(level.count * level.rms**2 for level in found.levels)
    assert squares / readings.n_readings == pytest.approx(found.rms**2)


def test_clean_readings_raise_no_alarm() -> None:
    real = [localise(base_fit(hidden(seed=100 + k))).real for k in range(12)]
    assert sum(real) <= 1  # two tests at one per cent each
    found = localise(base_fit(hidden(seed=100)))
    text = " ".join(where_sentences(found))
    assert "no more than noise" in text
    assert "Nothing stands out" in text
    assert found.noise is not None
    far = where_sentences(replace(found, rms=10.0 * found.noise))[0]  # poses differ by chance
    assert "no more than" not in far and "may all be chance from pose to pose (p = " in far


def test_probabilities_of_clean_readings_are_those_of_chance() -> None:
    found = [localise(base_fit(hidden(seed=200 + k, poses=8))) for k in range(25)]
    total = [1.0 if f.probability is None else f.probability for f in found]
    assert stats.kstest(total, "uniform", alternative="greater").pvalue > 1e-3
    first = [f.suspects[0].probability for f in found]
    assert np.mean(np.array(first) < 0.05) < 0.25


def test_noise_is_found_where_it_is_not_stated() -> None:
    cause = JointTilt(SHOULDER, {"first": 4e-7, "second": 4e-7})
    stated = localise(base_fit(hidden(cause)))
    found = localise(base_fit(hidden(cause, stated=False), noise=None))
    assert (stated.noise_from, found.noise_from) == ("stated", "scatter")
    assert found.noise == pytest.approx(np.sqrt(2.0) * SIGMA, rel=0.15)
    assert found.strongest is not None
    assert "as found from the scatter within poses" in where_sentences(found)[0]


def test_few_readings_do_not_tell_the_noise() -> None:
    readings = hidden(poses=3, loads=2, stated=False)
    found = localise(base_fit(readings, noise=None))
    assert found.noise_from == "unknown"
    assert found.probability is None
    assert "Nothing tells how large the noise is" in where_sentences(found)[0]


def test_a_single_bad_pose_is_pointed_at() -> None:
    readings = hidden(schedule="ascending")
    assert readings.displacement is not None
    shifted = readings.displacement.copy()
    shifted[[pose == "5" for pose in readings.pose]] += [1.5e-4, 0.0, 0.0]
    found = localise(base_fit(replace(readings, displacement=shifted)))
    worst = max(found.poses, key=lambda pose: pose.share)
    assert worst.label == "5" and worst.share > 0.5
    text = " ".join(where_sentences(found))
    assert "Pose 5 alone carries" in text
    assert "is constant" in text
    assert "It goes closely with none" in text


def test_twice_the_stated_noise_is_a_gap_that_goes_with_nothing() -> None:
    found = localise(base_fit(hidden(), NoiseModel(SIGMA / 2.0, zero="shared")))
    assert found.real
    assert "2.0 times what the noise alone makes" in where_sentences(found)[0]
    assert max(s.explained for s in found.suspects) < 0.2


def test_two_causes_are_told_one_after_the_other() -> None:
    causes = (
        BaseRocking("base_link", {"x": 4e-8, "y": 2e-7}),
        LostMotion("joint_3_u", {"half_width": 1e-4}),
    )
    found = localise(base_fit(hidden(*causes)))
    named = {found.suspects[0].name, found.beside[0].name}
    assert named == {
        "the moment that tips the base",
        "the sign of the torque of joint_3_u",
    }
    assert "That is not all" in " ".join(where_sentences(found))


def test_readings_that_cannot_tell_the_order_in_the_load_do_not_claim_it() -> None:
    found = localise(base_fit(hidden(CASES["tilting shoulder"].cause, loads=4)))
    assert {o.name for o in found.orders if o.probability is not None} == {"linear"}
    assert "No pose has readings enough" in " ".join(where_sentences(found))


def test_holm() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])


def test_a_zero_that_was_read_last_leaves_every_suspect_finite() -> None:
    readings = hidden(CASES["creep"].cause)
    assert readings.order is not None and readings.zero_order is not None
    late = replace(readings, zero_order=np.full(readings.n_readings, readings.order.max() + 900.0))
    fit = base_fit(late)
    cases = fit.problem.load_cases
    assert cases.order is not None and cases.order.max() < 0.0
    for suspect in suspects_of(fit.model, cases, fit.model.predict(cases)):
        assert np.isfinite(suspect.columns).all(), suspect.name
        assert np.abs(suspect.columns).max() < 1e9, suspect.name
    assert localise(fit).suspects


def test_waves_of_one_joint_are_one_cause() -> None:
    """Any of so many fits by chance sooner than one: which of them it is has its price."""
    base = base_fit(hidden())
    load_cases = base.problem.load_cases
    every = suspects_of(base.model, load_cases, base.model.predict(load_cases))
    waves = [s for s in every if s.name.startswith("the position of joint_2_l, on which its own")]
    assert len(waves) > 3
    assert {s.price_of_choice for s in waves} == {2.0 * np.log(len(waves))}
    several = ("a turn", TO_AND_FRO, YIELDS_SINCE)
    alone = [s for s in every if not any(words in s.name for words in several)]
    assert {s.price_of_choice for s in alone} == {0.0}
    freedom = len(base.residual) - len(base.x)
    told = {s.name: s for s in localise(base).suspects}
    for wave in waves:
        said = told[wave.name]
        paid = said.freedom * np.log(freedom) + wave.price_of_choice
        assert said.evidence == pytest.approx(said.statistic - paid, rel=1e-9)


def test_a_drift_that_comes_and_goes_is_told_with_its_period() -> None:
    """Air conditioning: 60 µm to and fro in 26 readings, beside a zero of every pose's own."""
    readings = hidden(stated=True)
    assert readings.order is not None and readings.zero_order is not None
    pace = 2.0 * np.pi / 26.0
    drift = 6e-5 * (np.sin(pace * readings.order) - np.sin(pace * readings.zero_order))
    moved = readings.displacement + drift[:, None] * np.array([0.0, 0.6, 0.8])
    found = localise(base_fit(replace(readings, displacement=moved)))
    assert found.strongest is not None
    name, _, period = found.strongest.name.partition(TO_AND_FRO)
    assert name == CLOCKS[0]
    assert float(period.removesuffix(" readings")) == pytest.approx(26.0, rel=0.1)
    told = " ".join(where_sentences(found))
    assert "does not go with the order of the readings" not in told
    still = " ".join(where_sentences(localise(base_fit(hidden(CASES["rocking base"].cause)))))
    assert TO_AND_FRO not in still
