"""Sensitivities that were taken at one fit and serve the next."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.explain.candidates.linearised import NEAR, linearised_at
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.options import Options, candidates_for
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import ModelForm, NoiseModel
from tests.explain.readings import SIGMA, base_fit, hidden
from tests.hidden.generator.causes_elastic import JointTilt

READINGS = hidden(JointTilt("joint_2_l", {"first": 4e-7, "second": 2e-7}), poses=10, loads=4)
BASE = tuple(f"joint_springs:joint_{joint}" for joint in ("1_s", "2_l", "3_u"))


@pytest.fixture(scope="module")
def first() -> Fit:
    return base_fit(READINGS)


@pytest.fixture(scope="module")
def candidates(first: Fit):
    return candidates_for(first.model, READINGS, Options())


def other(first: Fit, **noise: object) -> Fit:
    """The same springs from the same readings, under other noise."""
    return fit(first.model, first.problem.measurements, noise=NoiseModel(SIGMA, **noise))


def test_under_other_noise_they_give_what_is_taken_there(first, candidates):
    at = other(first, form=ModelForm(proportional=0.1))
    assert np.abs(at.x / first.x - 1.0).max() > 1e-3  # the springs did move
    near = linearised_at(first, candidates, BASE)
    again = regression_at(at, candidates, BASE, alpha=0.01, near=near)
    anew = regression_at(at, candidates, BASE, alpha=0.01)
    assert again.linearised.sensitivities is near.sensitivities
    assert np.allclose(again.y, anew.y, rtol=0, atol=1e-3)  # of the noise
    size = np.linalg.norm(anew.X, axis=0)
    apart = np.linalg.norm(again.X - anew.X, axis=0)
    assert (apart <= 2.0 * NEAR * size).all()  # an offset turns springs and load alike
    assert apart.max() > 0.0
    assert np.array_equal(again.columns[3], anew.columns[3])


def test_other_readings_and_other_effects_have_their_own(first, candidates):
    near = linearised_at(first, candidates, BASE)
    few = np.arange(READINGS.n_readings) < 30
    less = fit(first.model, first.problem.measurements.select(few))
    same = replace(READINGS, displacement=1.0001 * np.array(READINGS.displacement))
    for at, wanted in (
        (less, candidates), (base_fit(same), candidates), (first, candidates[:-1]),
    ):  # fmt: skip
        found = linearised_at(at, wanted, BASE, near)
        assert found.sensitivities is not near.sensitivities
    assert linearised_at(first, candidates, BASE, near).sensitivities is near.sensitivities


@pytest.mark.parametrize("times", [1.0 + 2.0 * NEAR, 1.3])
def test_where_one_direction_moves_otherwise_they_are_taken_anew(first, candidates, times):
    near = linearised_at(first, candidates, BASE)
    displacement = np.array(READINGS.displacement) * [1.0, 1.0, times]
    softer = replace(near, predicted=near.predicted * [1.0, 1.0, times])
    assert linearised_at(first, candidates, BASE, near).sensitivities is near.sensitivities
    assert linearised_at(first, candidates, BASE, softer).sensitivities is not near.sensitivities
    at = fit(first.model, replace(READINGS, displacement=displacement))
    assert linearised_at(at, candidates, BASE, near).sensitivities is not near.sensitivities
