"""What a fit tells its model of its uncertainty, against refits and readings that show nothing."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from sk120stiff.effects import effect, load_case, load_cases_of
from sk120stiff.identify import fit, known_model
from sk120stiff.identify.uncertainty.known_model import _together
from sk120stiff.measurements import ModelForm, NoiseStatement
from sk120stiff.model import (
    Model,
    joint_spring_model,
    model_from_text,
    model_text,
    predict_with_uncertainty,
)
from sk120stiff.plan import Schedule
from sk120stiff.robot import Robot
from tests.identify.conftest import readings_of, without_statement

SIGMA = 10e-6


@pytest.fixture(scope="module")
def truth(springs: Model) -> Model:
    return springs


def stated(model: Model, **changes: object):
    readings = readings_of(model, sigma=SIGMA, **changes)
    return replace(readings, noise=NoiseStatement(sigma=SIGMA))


def test_the_covariance_is_that_of_the_fit(truth: Model) -> None:
    found = fit(truth, stated(truth))
    known = known_model(found).uncertainty
    scale = found.problem.scale
    np.testing.assert_allclose(
        known.covariance, found.covariance * np.outer(scale, scale), rtol=1e-9
    )
    np.testing.assert_allclose(known.std, [p.internal_std for p in found.parameters])
    assert known.freedom is None and len(known.unseen) == 0
    assert known.remainder is not None and not known.remainder.significant


def test_what_other_models_make_of_the_values_leaves_the_readings_predicted(truth: Model) -> None:
    """Large moves of single values count as far as the readings allow them together."""
    found = fit(truth, stated(truth))
    scale, before = found.problem.scale, known_model(found).uncertainty.covariance
    J = found.jacobian / scale
    seen = np.einsum("ij,jk,ik->i", J, before, J)
    errors = np.sqrt(np.diag(before)) / scale
    for size in (30.0, 300.0):
        moved = replace(found, selection_uncertainty=size * errors)
        after = known_model(moved).uncertainty.covariance
        ratio = np.einsum("ij,jk,ik->i", J, after, J) / seen
        assert (ratio > 3.5).all() and (ratio < 4.0 + 1e-6).all()  # 1 + AS_WELL
    little = replace(found, selection_uncertainty=1e-3 * errors)
    more = known_model(little).uncertainty.covariance - before
    np.testing.assert_allclose(
        more, np.diag((1e-3 * errors * scale) ** 2), rtol=1e-5, atol=1e-6 * more.max()
    )
    for omitted in (np.diag((30.0 * errors) ** 2), 900.0 * before / np.outer(scale, scale)):
        left_out = replace(found, left_out=30.0 * errors, omitted=omitted)
        after = known_model(left_out).uncertainty.covariance
        ratio = np.einsum("ij,jk,ik->i", J, after, J) / seen
        assert (ratio > 1.9).all() and (ratio < 2.0 + 1e-6).all()  # 1 + OMITTED
    beside = replace(found.problem.noise, form=ModelForm(0.01, 1e-6))
    formed = replace(found, problem=replace(found.problem, noise=beside))
    foreign = np.outer(30.0 * errors, 30.0 * errors)
    formed = replace(formed, foreign=foreign)
    wide = known_model(formed).uncertainty.std
    assert (wide > 29.0 * errors * scale).all()
    more = (
        known_model(formed).uncertainty.covariance
        - known_model(replace(formed, foreign=None)).uncertainty.covariance
    )
    np.testing.assert_allclose(more, foreign * np.outer(scale, scale), rtol=1e-6)


def test_a_value_that_stays_does_not_make_up_for_one_that_moves() -> None:
    """Two that are nearly one: what one may move by is what readings allow of it alone."""
    rng = np.random.default_rng(1)
    J = rng.normal(size=(30, 2))
    J[:, 1] = J[:, 0] + 1e-5 * J[:, 1]
    moved = np.diag([1e4, 0.0])
    told = _together(moved, J, 3.0)
    assert np.trace(J @ told @ J.T) == pytest.approx(3.0, rel=1e-3)
    assert told[1, 1] == 0.0
    whole = _together(np.diag([1e4, 1e4]), J, 3.0)
    expected = np.linalg.inv(1e-4 * np.eye(2) + J.T @ J / 3.0)
    np.testing.assert_allclose(whole, expected, rtol=1e-6)
    assert np.trace(J @ whole @ J.T) < 6.0 < 1e-3 * whole[0, 0] * (J[:, 0] @ J[:, 0])


def test_moves_of_all_sizes_leave_a_covariance_that_readings_can_have(truth: Model) -> None:
    """The difference of two large matrices was negative by rounding: `explain` ended at saving."""
    found = fit(truth, stated(truth))
    errors = np.sqrt(np.diag(known_model(found).uncertainty.covariance)) / found.problem.scale
    rng = np.random.default_rng(4)
    for _ in range(40):
        moves = errors * 10.0 ** rng.uniform(-6.0, 9.0, len(errors))
        moves[rng.random(len(errors)) < 0.2] = 0.0
        told = known_model(replace(found, selection_uncertainty=moves)).uncertainty
        size = np.maximum(told.std, 1e-300)
        assert np.linalg.eigvalsh(told.covariance / np.outer(size, size)).min() > -1e-10


def test_a_remainder_is_found_with_its_size(truth: Model) -> None:
    """A base that rocks is left out of the model; held against refits at poses left out."""
    rocking = truth + effect(truth.robot, "base_rocking")
    rocking = rocking.with_public(
        **{f"base_rocking:base_link.stiffness_{axis}": 8e6 for axis in "xy"}
    )
    readings = stated(rocking, poses=20, seed=7)
    found = fit(truth, readings)
    left = known_model(found).uncertainty.remainder
    squares = []
    for label in readings.poses:
        own = np.array([pose == label for pose in readings.pose])
        without = fit(truth, replace(readings, use=~own), noise=found.problem.noise)
        gap = readings.displacement[own] - without.model.predict(found.problem.load_cases.rows(own))
        squares.append((gap**2).mean(axis=0))
    held_out = np.sqrt(np.mean(squares, axis=0) - 2.0 * SIGMA**2)
    assert left.significant and left.grows
    np.testing.assert_allclose(left.rms, np.sqrt(np.mean(held_out**2)), rtol=0.25)
    assert (left.upper > left.rms).all() and (left.upper < 2.0 * left.rms.max()).all()


def test_a_spring_that_does_not_show_makes_what_depends_on_it_unknown(robot: Robot) -> None:
    """Forces at a point on the last joint's axis put no torque on it."""
    six = joint_spring_model(robot, [1.4e6, 4e5, 9e5, 3e5, 3e5, 3e5])
    readings = replace(stated(six), point=np.zeros(3), force_point=np.zeros(3))
    readings = replace(readings, displacement=six.predict(load_cases_of(robot, readings)))
    rng = np.random.default_rng(2)
    noisy = readings.displacement + SIGMA * rng.normal(size=readings.displacement.shape)
    known = known_model(fit(six, replace(readings, displacement=noisy, zero="separate")))
    assert len(known.uncertainty.unseen) == 1
    (written,) = yaml.safe_load(model_text(known))["uncertainty"]["parameters"][5:]
    assert written["name"].startswith("joint_springs:joint_6_t") and written["std"] is None
    again = model_from_text(model_text(known)).uncertainty
    np.testing.assert_allclose(again.std, known.uncertainty.std, rtol=1e-8)
    load = np.array([[100.0, 200.0, -300.0, 0.0, 0.0, 0.0]])
    on_axis = predict_with_uncertainty(known, load_case(robot, robot.rest, load))
    assert np.isfinite(on_axis.std_parameters).all() and on_axis.blame == ((),)
    away = load_case(robot, robot.rest, load, point=[0.2, 0.1, 0.0])
    off_axis = predict_with_uncertainty(known, away)
    assert np.isinf(off_axis.std_parameters).any()
    assert off_axis.blame == (("joint_springs:joint_6_t.stiffness",),)


def test_a_spring_on_its_bound_is_not_sure(truth: Model, robot: Robot) -> None:
    """The wrist is rigid in truth: some of its compliances are estimated as zero exactly."""
    six = joint_spring_model(robot, [1.4e6, 4e5, 9e5, 3e5, 3e5, 3e5])
    found = fit(six, stated(truth, seed=5))
    assert found.at_bound.any()
    known = known_model(found).uncertainty
    assert (known.std[found.at_bound] > 0.0).all()


def test_a_gap_that_nothing_tells_from_noise_may_be_either(truth: Model) -> None:
    """One load a pose and no statement: the file said nothing of what the model may lack."""
    readings = without_statement(readings_of(truth, schedule=Schedule("ascending", 1), poses=30))
    found = fit(truth, readings)
    known = known_model(found).uncertainty
    left = known.remainder
    assert left is not None and not left.significant and left.probability > 0.05
    assert (0.3 * found.rms < left.upper).all() and (left.upper < 1.5 * found.rms).all()
    assert known.freedom == 87.0
    assert known.reach() > 1.96
