"""What readings leave open, calibrations of instruments close, and nothing else."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sk120stiff.effects import effect, load_cases_of
from sk120stiff.errors import Refusal
from sk120stiff.identify import Fit, Problem, fit, known_model, solving, weak_directions
from sk120stiff.identify.solve.beforehand import COUNTS
from sk120stiff.identify.solve.polish import Evaluate, Minimum, polish
from sk120stiff.identify.solve.prior import Prior
from sk120stiff.measurements import NoiseStatement
from sk120stiff.model import (
    CALIBRATED,
    Model,
    model_from_text,
    model_text,
    predict_with_uncertainty,
)
from sk120stiff.robot import Robot
from tests.identify.conftest import readings_of, without_statement

SIGMA = 5e-6
USUAL = np.sqrt(0.12 * 0.01)  # of a gain, between typical and plausible
GAINS = {
    f"force_scale:sensor.scale_{axis}": s
    for axis, s in zip("xyz", (0.03, -0.01, -0.02), strict=True)
}


@pytest.fixture(scope="module")
def truth(springs: Model, robot: Robot) -> Model:
    return (springs + effect(robot, "force_scale", "sensor")).with_public(**GAINS)


@pytest.fixture(scope="module")
def found(truth: Model, springs: Model, robot: Robot) -> Fit:
    readings = readings_of(truth, poses=15, sigma=SIGMA)
    stated = replace(readings, noise=NoiseStatement(sigma=SIGMA))
    return fit(springs + effect(robot, "force_scale", "sensor"), stated)


def test_springs_are_known_up_to_the_gain(found: Fit, truth: Model) -> None:
    """Against a dense Bayesian covariance in which every gain has its usual error."""
    assert found.identifiable.all()
    scale = found.problem.scale
    prior = np.array([0.0, 0.0, 0.0, *(scale[3:] / USUAL) ** 2])
    dense = np.linalg.inv(found.jacobian.T @ found.jacobian + np.diag(prior))
    np.testing.assert_allclose(
        np.sqrt(np.diag(found.covariance)), np.sqrt(np.diag(dense)), rtol=0.02
    )
    for own, true in zip(found.parameters, truth.parameters, strict=True):
        assert own.std is not None and abs(own.value - true.value) < 2.5 * own.std
        assert own.origin == CALIBRATED
    for spring in found.parameters[:3]:
        assert spring.std / spring.value == pytest.approx(USUAL / np.sqrt(3.0), rel=0.1)


def test_a_calibration_is_no_noise_of_readings(truth: Model, springs: Model, robot: Robot) -> None:
    """Where the scatter tells their noise, and it is not what was assumed, a gain stays a gain."""
    readings = without_statement(readings_of(truth, poses=15, sigma=2e-6))
    found = fit(springs + effect(robot, "force_scale", "sensor"), readings)
    assert abs(np.log(found.unit)) > 0.5
    for spring in found.parameters[:3]:
        assert spring.std / spring.value == pytest.approx(USUAL / np.sqrt(3.0), rel=0.1)


def test_of_all_that_fit_alike_the_likeliest_sensor_is_taken(found: Fit) -> None:
    gains = np.array([p.internal for p in found.parameters[3:]])
    assert abs(gains.mean()) < 0.1 * USUAL
    true = np.array(list(GAINS.values()))
    np.testing.assert_allclose(gains - gains.mean(), true - true.mean(), atol=3e-3)


def test_it_is_said(found: Fit) -> None:
    (said,) = [each for each in weak_directions(found) if "move together" in each]
    assert "only 5 of 6 combinations" in said
    assert "usual error of a calibration (force scale 3.5 %)" in said


def test_predictions_for_reported_loads_are_none_the_worse(found: Fit, truth: Model) -> None:
    """An error that all springs and the gain share cancels there, after a file too."""
    known = model_from_text(model_text(known_model(found)))
    cases = load_cases_of(known.robot, readings_of(truth, poses=6, seed=9))
    std = predict_with_uncertainty(known, cases).std_parameters
    assert np.nanmax(std) < 2.0 * SIGMA  # of springs alone it would be 2 % of some 600 um
    assert np.abs(known.predict(cases) - truth.predict(cases)).max() < 4.0 * np.nanmax(std)


def test_a_search_that_ends_nowhere_is_made_with_calibrations(
    found: Fit, springs: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(evaluate: Evaluate, *rest: Any, **options: Any) -> Minimum:
        if getattr(evaluate, "__func__", None) is Problem.evaluate:
            raise Refusal("the least-squares fit did not converge")
        return polish(evaluate, *rest, **options)

    monkeypatch.setattr(solving, "polish", lost)
    again = solving.solve_near(found.problem, found.x)
    std = np.sqrt(np.diag(found.covariance))
    assert (np.abs(again.x - found.x) < 0.1 * std).all()
    plain = Problem(springs, found.problem.measurements, found.problem.noise)
    with pytest.raises(Refusal, match="did not converge"):
        solving.solve_near(plain, found.x[:3])


def test_a_search_that_creeps_does_not_creep_for_long(
    found: Fit, springs: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int | None] = []

    def counted(*rest: Any, steps: int | None = None, **options: Any) -> Minimum:
        asked.append(steps)
        return polish(*rest, steps=steps, **options)

    monkeypatch.setattr(solving, "polish", counted)
    solving.solve_near(found.problem, found.x)
    assert asked[0] == solving.VALLEY
    plain = Problem(springs, found.problem.measurements, found.problem.noise)
    asked.clear()
    solving.solve_near(plain, found.x[:3])
    assert asked == [None]
    with pytest.raises(Refusal, match="did not converge"):
        polish(found.problem.evaluate, 3.0 * found.x, found.problem.bounds, found.problem.span,
               steps=1)  # fmt: skip


def test_an_axis_along_which_nothing_pulled_stays_untold(springs: Model, robot: Robot) -> None:
    """Its usual error is no finding: nothing was read of it."""
    readings = readings_of(springs, poses=15, sigma=SIGMA)
    cases = load_cases_of(robot, readings)
    force = np.einsum("nji,nj->ni", cases.rotation, readings.wrench[:, :3])
    force[:, 1] = 0.0  # of the tool
    wrench = np.zeros((readings.n_readings, 6))
    wrench[:, :3] = np.einsum("nij,nj->ni", cases.rotation, force)
    flat = replace(readings, wrench=wrench)
    moved = springs.predict(load_cases_of(robot, flat))
    found = fit(springs + effect(robot, "force_scale", "sensor"), replace(flat, displacement=moved))
    told = {p.spec.name: seen for p, seen in zip(found.parameters, found.identifiable, strict=True)}
    assert told == {"stiffness": True, "scale_x": True, "scale_y": False, "scale_z": True}


def test_nothing_is_added_where_the_readings_tell_all(springs: Model, robot: Robot) -> None:
    """A sensor that is mounted turned shows in the directions; its calibration has no say."""
    model = springs + effect(robot, "force_rotation", "sensor")
    turned = model.with_public(**{"force_rotation:sensor.angle_x": 0.03})
    fitted = fit(model, readings_of(turned, poses=15, sigma=SIGMA))
    assert len(fitted.beforehand.calibrations.sizes) == 0
    np.testing.assert_array_equal(fitted.informed, fitted.small[0])
    assert CALIBRATED not in {p.origin for p in fitted.parameters}


def test_compliances_that_lie_on_one_another_stay_open() -> None:
    """No calibration holds a spring: of two that the readings add up nothing more is known."""
    jacobian, span = np.array([[1e3, 1e3, 0.0], [0.0, 0.0, 5.0]]), np.full(3, 10.0)
    held = np.zeros(3, dtype=bool)
    none = Prior.of(jacobian, held, span, np.full(3, np.inf), 1.0, COUNTS)
    assert none.rows().shape == (0, 3)
    np.testing.assert_array_equal(none.step(np.array([1.0, 2.0, 3.0])), 0.0)
    one = Prior.of(jacobian, held, span, np.array([np.inf, 2.0, np.inf]), 1.0, COUNTS)
    (row,) = one.rows()
    # along (1, -1) the second may be off by 2: so may the first
    assert abs(row @ [2.0, -2.0, 0.0]) == pytest.approx(1.0)
    step = one.step(np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(step, [2.0, -2.0, 0.0], atol=1e-6)  # the second to zero
    np.testing.assert_allclose(one.beside(np.array([3.0, 1.0, 4.0])), [4.0, 0.0, 4.0], atol=1e-6)


@pytest.mark.parametrize("unit", [0.2, 1.0, 10.0])
@pytest.mark.parametrize("faint", [0.0, 0.03, 0.3, 0.6, 3.0, 30.0])
def test_what_is_hardly_read_and_what_a_calibration_says_add_up(faint: float, unit: float) -> None:
    """A sum is read, and the second alone as well, so faintly; it is off by 2 as is usual.

    Of both the inverse variances add, whichever tells more, and whatever the noise turns out to be.
    """
    faint *= unit
    jacobian = np.array([[1e3, 1e3], [0.0, faint]])
    usual, span = np.array([np.inf, 2.0]), np.full(2, 10.0)
    open_ = Prior.of(jacobian, np.zeros(2, dtype=bool), span, usual, unit, COUNTS)
    told = np.vstack([jacobian, open_.rows()])
    variance = unit**2 * np.linalg.inv(told.T @ told)[1, 1]
    assert variance == pytest.approx(1.0 / ((faint / unit) ** 2 + 0.25), rel=1e-3)
    assert len(open_.sizes) == (faint < 5.0 * unit)
