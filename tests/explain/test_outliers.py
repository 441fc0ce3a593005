"""Which readings are set aside: slips at single readings, never what a tracker does as it warms."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot, predict
from sk120stiff.effects.reading_drift import ReadingDrift, warm_ups
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.words import set_aside_sentences
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.options import Options, candidates_for
from sk120stiff.explain.select.outliers import LIMIT, NEXT, outlying_rows
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.noise.repeats import borne_out
from tests.explain.readings import NOISE, SIGMA, answered, base_fit, hidden

WAY = np.array([0.6, -0.5, 0.62])


def set_aside(readings: Measurements, noise: NoiseModel = NOISE) -> tuple[list[int], list[int]]:
    """Rows that stand out where nothing is known of warming up, and where it is."""
    base = base_fit(readings, noise)
    candidates = candidates_for(base.model, readings, Options())
    regression = regression_at(base, candidates, ("joint_springs",), alpha=0.01)
    whitener, courses = base.problem.whitener, warm_ups(base.problem.load_cases)
    assert courses
    certain = borne_out(readings)
    return (
        outlying_rows(regression, whitener, (), certain).tolist(),
        outlying_rows(regression, whitener, courses, certain).tolist(),
    )


def off(readings: Measurements, rows: list[int], by: float) -> Measurements:
    """Single readings that slipped, each another way [m]."""
    moved = np.array(readings.displacement)
    rng = np.random.default_rng(3)
    for row in rows:
        way = rng.normal(size=3)
        moved[row] += by * way / np.linalg.norm(way)
    return replace(readings, displacement=moved)


def warming(readings: Measurements, over: float, by: float) -> Measurements:
    """The same read by a tracker that wanders by so much [m] at first, dying away over so many."""
    at, zero = np.array(readings.order), np.array(readings.zero_order)
    course = np.exp(-zero / over) - np.exp(-at / over)
    moved = np.array(readings.displacement) + by * course[:, None] * WAY
    return replace(readings, displacement=moved)


def test_a_reading_that_the_named_model_holds_counts_again(monkeypatch: pytest.MonkeyPatch):
    """Rows of a gear's flank may be off every usual law; the slip beside them stays out."""
    stepwise = sys.modules["sk120stiff.explain.select.stepwise"]
    monkeypatch.setattr(stepwise, "outlying_rows", lambda *_: np.array([3, 17, 40]))
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    answer = answered(model, off(hidden(), [17], 40 * SIGMA), options=Options(only=("joint_tilt",)))
    assert answer.set_aside == (17,)
    assert answer.final.problem.measurements.n_readings == answer.readings.n_readings - 1
    told = predict(answer.final.model, answer.readings).gap(answer.readings)
    assert answer.rms_of_all == pytest.approx(np.sqrt(np.mean(told**2)), rel=1e-9)
    assert answer.rms_of_all > 1.5 * answer.final.rms
    said = set_aside_sentences(answer)
    assert len(said) == 2 and f"leaves {1e6 * answer.rms_of_all:.1f} µm" in said[1]


@pytest.mark.parametrize("seed", [7, 8, 9])
@pytest.mark.parametrize("over", [2.0, 5.0])
def test_the_first_poses_of_a_warming_tracker_are_no_outliers(seed: int, over: float):
    readings = warming(hidden(poses=36, seed=seed), over, 40 * SIGMA)
    before, after = set_aside(readings)
    assert before
    assert after == []


@pytest.mark.parametrize("rows", [[0], [1], [4], [0, 1], [37], [0, 60, 61, 110]])
def test_slips_at_single_readings_are_outliers_wherever_they_are(rows: list[int]):
    _, after = set_aside(off(hidden(poses=36), rows, 25 * SIGMA))
    assert after == rows


def test_a_crowd_far_off_is_set_aside_where_nothing_is_left_without_it():
    """Seven slips of a hundred readings: `explain` said that something is missing."""
    readings = hidden(poses=24, seed=5)
    count = readings.n_readings
    rows = sorted(np.random.default_rng(2).choice(count, round(0.09 * count), replace=False))
    assert set_aside(off(readings, rows, 40 * SIGMA))[0] == rows
    near = set_aside(off(readings, rows, 7 * SIGMA))[0]  # so much a cause may bring at some poses
    assert near == []


def test_a_reading_far_beyond_all_others_is_set_aside_beside_a_cause_that_has_no_name():
    readings = hidden(poses=24, seed=5)
    bent = np.array(readings.displacement)
    bent += 8 * SIGMA * np.random.default_rng(6).normal(size=bent.shape)  # nobody stated it
    slipped = off(replace(readings, displacement=bent), [31], 150 * SIGMA)
    assert set_aside(slipped)[0] == [31]
    assert set_aside(replace(readings, displacement=bent))[0] == []


def with_slips() -> Measurements:
    """Two readings exchanged, one with a wrong sign; and more noise than was stated."""
    readings = hidden(poses=12, loads=4, seed=4)
    moved = np.array(readings.displacement)
    moved += 1.7 * SIGMA * np.random.default_rng(6).normal(size=moved.shape)
    moved[[7, 33]] = moved[[33, 7]]
    moved[25, 2] *= -1.0
    return replace(readings, displacement=moved)


@pytest.mark.parametrize("freedom", [np.inf, 0])
def test_slips_that_hide_each_other_are_set_aside_where_the_noise_is_not_what_was_stated(freedom):
    """One far off hid the others, and all stayed."""
    slipped = with_slips()
    assert set_aside(slipped, replace(NOISE, freedom=freedom))[0] == [7, 25, 33]


def test_a_crowd_that_does_not_stand_apart_is_a_cause_that_is_missing():
    """Far off and less far off without a gap between: no slips, and nobody stated the noise."""
    readings = hidden(poses=24, seed=5)
    rows = np.random.default_rng(2).choice(readings.n_readings, 24, replace=False)
    moved = readings
    for row, times in zip(rows.tolist(), np.geomspace(5.0, 60.0, len(rows)), strict=True):
        moved = off(moved, [row], times * SIGMA)
    assert set_aside(moved, replace(NOISE, freedom=0))[0] == []


def test_the_slip_that_would_explain_a_reading_is_told():
    readings = with_slips()
    model = base_fit(readings).model
    answer = answered(model, readings, options=Options(only=("joint_tilt",)))
    assert answer.slips == {
        7: "exchanged with the reading of pose 9 both would fit",
        25: "dz would fit with the other sign",
        33: "exchanged with the reading of pose 2 both would fit",
    }
    assert "Compare pose 2, pose 7 and pose 9 with the sheet" in next_step(answer)


def test_a_slip_is_found_beside_a_tracker_that_warms_up():
    readings = off(warming(hidden(poses=36), 3.0, 40 * SIGMA), [90], 25 * SIGMA)
    assert set_aside(readings)[1] == [90]


def test_a_drift_may_die_away_at_once_where_the_series_is_long():
    for poses, times in ((36, 5), (6, 4)):
        case = base_fit(hidden(poses=poses)).problem.load_cases
        laws = ReadingDrift("tracker", 1.0).other_laws(case)
        assert len(laws) == times
        assert min(T for law in laws for T in law.over if T) >= 2.0


def test_a_tracker_that_warms_up_over_two_poses_of_many_is_named():
    readings = warming(hidden(poses=36), 6.0, 40 * SIGMA)
    answer = answered(base_fit(readings).model, readings)
    assert [finding.effect.id for finding in answer.findings] == ["reading_drift:tracker"]
    assert answer.set_aside == ()


@pytest.mark.parametrize(
    ("rows", "poses", "loads", "by"),
    [
        ([4, 5, 6], 12, 10, 12.0),
        ([0, 60, 61, 110], 12, 10, 12.0),
        *(([4, 5, 8, 9, 12, 13], 60, 2, by) for by in (7.0, 7.4)),
    ],
)
def test_they_are_those_that_dense_least_squares_finds_one_after_the_other(
    rows: list[int], poses: int, loads: int, by: float
):
    readings = off(hidden(poses=poses, loads=loads), rows, by * SIGMA)
    base = base_fit(readings)
    candidates = candidates_for(base.model, readings, Options())[:40]
    springs = [effect.id for effect in base.model.effects]
    regression = regression_at(base, candidates, springs, alpha=0.01)
    whitener = base.problem.whitener
    columns = np.concatenate([regression.base, *regression.columns])
    drawn = 3.0 / regression.plausible[columns]
    drawn[: len(regression.base)] = 0.0
    X = np.vstack([regression.X[:, columns], np.diag(drawn)])
    zeros = np.zeros((len(columns), 3))
    y = np.concatenate([regression.y, zeros[:, 0]])
    unit = np.eye(3 * readings.n_readings).reshape(readings.n_readings, 3, -1)
    seen = np.split(whitener.apply(unit), readings.n_readings, axis=1)
    shifts = [np.vstack([each, zeros]) for each in seen]
    out: list[int] = []
    while True:
        basis = np.linalg.qr(np.hstack([X, *(shifts[row] for row in out)]))[0]
        left = y - basis @ (basis.T @ y)
        free = [each - basis @ (basis.T @ each) for each in shifts]
        length = np.array([np.linalg.norm(each, axis=0) for each in free])
        score = np.array([np.abs(each.T @ left) for each in shifts]) / np.maximum(length, 1e-6)
        score[out] = 0.0
        worst = int(score.max(axis=1).argmax())
        if score[worst].max() <= (NEXT if out else LIMIT):
            break
        out.append(worst)
    assert len(out) > 1
    assert outlying_rows(regression, whitener).tolist() == sorted(out)


@pytest.mark.parametrize("rows", [[3, 11, 17], [0, 8]])
def test_slips_of_a_small_campaign_are_not_hidden_by_a_catalogue_that_follows_single_readings(
    rows: list[int],
) -> None:
    """Ten poses, three readings each: more columns than rows, and half a millimetre in three."""
    readings = hidden(poses=10, loads=3, stated=False, seed=4)
    answer = answered(base_fit(readings).model, off(readings, rows, 60 * SIGMA))
    assert list(answer.set_aside) == rows
    assert answer.verdict == "none"


def test_what_came_twice_did_not_slip() -> None:
    """Both readings of a repeated load off alike: that is the arm, or its load, but no slip."""
    once = hidden(poses=12, loads=5)
    pairs = once.select(np.repeat(np.arange(once.n_readings), 2))
    moved = np.array(pairs.displacement)
    moved += SIGMA * np.random.default_rng(2).normal(size=moved.shape)
    twice = [60, 61]
    moved[twice] += 60 * SIGMA * WAY
    off_alike = replace(pairs, displacement=moved)
    assert borne_out(off_alike)[twice].all()
    assert not set(set_aside(off_alike)[0]) & set(twice)
    moved[twice[1]] -= 60 * SIGMA * WAY
    off_once = replace(pairs, displacement=moved)
    assert not borne_out(off_once)[twice].any()
    assert set_aside(off_once)[0] == twice[:1]
