"""Held-out error and the table of models."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.effects import effect, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.identify import Problem, compare, held_out, refitted, solve
from sk120stiff.measurements import NoiseModel
from tests.identify.conftest import readings_of

NOISE = NoiseModel(10e-6)


def test_leaving_out_by_hand(springs, table2, robot) -> None:
    (error,) = held_out(table2, refitted(springs, noise=NOISE))
    assert error.folds == 3
    assert error.poses == table2.poses
    squares = []
    for pose in table2.poses:
        out = table2.rows_of(pose)
        rest = table2.select(np.setdiff1d(np.arange(table2.n_readings), out))
        other = solve(Problem(springs, rest, NOISE))
        left = table2.select(out)
        gap = left.displacement - other.model.predict(load_cases_of(robot, left))
        squares.append((gap**2).mean())
    np.testing.assert_allclose(error.squares, squares, rtol=1e-9)
    assert error.rms == pytest.approx(np.sqrt(np.mean(squares)), rel=1e-9)
    # the standard error of a mean of squares, by the delta method
    assert error.std == pytest.approx(
        np.std(squares, ddof=1) / np.sqrt(3) / (2 * np.sqrt(np.mean(squares))), rel=1e-9
    )


def test_held_out_error_is_what_new_poses_show(springs) -> None:
    """About the noise of a displacement and a little for the springs' own error."""
    readings = readings_of(springs, poses=30, seed=6)
    (error,) = held_out(readings, refitted(springs, noise=NOISE))
    assert error.folds == 5
    assert abs(error.rms - np.sqrt(2.0) * 10e-6) < 4 * error.std + 0.5e-6


def test_differences_are_paired(springs, robot) -> None:
    """Poses scatter much more than the models' difference at each pose does."""
    readings = readings_of(springs, poses=20, seed=7)
    turned = springs + effect(robot, "reading_rotation")
    (small,) = held_out(readings, refitted(springs, noise=NOISE))
    (large,) = held_out(readings, refitted(turned, noise=NOISE))
    loss, doubt = large.difference(small)
    assert loss == pytest.approx(large.rms - small.rms, abs=1e-15)
    assert doubt < 0.5 * np.hypot(small.std, large.std)


def test_one_pose_cannot_be_left_out(springs, table2) -> None:
    alone = table2.select(table2.rows_of("1"))
    with pytest.raises(InputError, match="there is only one"):
        held_out(alone, refitted(springs, noise=NOISE))


def test_the_true_model_wins_the_table(springs, robot) -> None:
    rocking = springs + effect(robot, "base_rocking")
    truth = rocking.with_public(**dict.fromkeys(rocking.names[-2:], 1e7))
    readings = readings_of(truth, poses=20)
    models = {
        "springs": springs,
        "rocking": rocking,
        "more": rocking + effect(robot, "reading_rotation"),
        "tilt": springs + effect(robot, "joint_tilt", "joint_3_u"),
    }
    told: list[tuple[int, int]] = []
    table = compare(models, readings, progress=lambda *step: told.append(step))
    lines = {line.name: line for line in table}
    assert [line.name for line in table[:2]] == ["rocking", "more"]
    assert lines["rocking"].bic == 0.0
    assert (lines["rocking"].loss, lines["rocking"].loss_std) == (0.0, 0.0)
    assert lines["rocking"].note.startswith("best, least BIC")
    assert lines["springs"].note.startswith("worse")
    assert lines["tilt"].note.startswith("worse")
    assert lines["springs"].loss > 3 * lines["springs"].loss_std
    assert lines["more"].note.startswith("not told from the best")
    assert {line.fit.problem.noise for line in table} == {table[0].fit.problem.noise}
    assert told[-1] == (4, 4)


def test_criteria_count_from_the_least(springs, robot, table2) -> None:
    table = compare(
        {"a": springs, "b": springs + effect(robot, "base_rocking")}, table2, noise=NOISE
    )
    assert min(line.aic for line in table) == 0.0
    assert min(line.bic for line in table) == 0.0
    one, two = table
    assert two.fit.aic - one.fit.aic == pytest.approx(two.aic - one.aic)


def test_notes_tell_what_is_unknown(springs, robot, table2) -> None:
    models = {"plain": springs, "scaled": springs + effect(robot, "force_scale")}
    lines = {line.name: line for line in compare(models, table2)}
    assert "6 known up to a calibration" in lines["scaled"].note


def test_a_comparison_takes_two(springs, table2) -> None:
    with pytest.raises(InputError, match="two models"):
        compare({"a": springs}, table2)


def test_one_pose_is_ranked_by_bic(springs, robot, table2) -> None:
    one = replace(table2.select(table2.rows_of("2")))
    table = compare({"a": springs, "b": springs + effect(robot, "closure_coupling")}, one)
    assert all(line.held_out is None for line in table)
    assert table[0].bic == 0.0
