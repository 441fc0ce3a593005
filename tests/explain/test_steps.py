"""Held-out figures: one number for one model, and nothing chosen on what is predicted."""

import numpy as np
import pytest

from sk120stiff.effects import all_effects, load_cases_of
from sk120stiff.explain import Options, explain
from sk120stiff.explain.judge.steps import gap_steps, nested
from sk120stiff.explain.options import candidates_for
from sk120stiff.explain.select.stepwise import Selection, select
from sk120stiff.identify import fit, held_out, refitted
from sk120stiff.measurements import NoiseModel
from tests.explain.readings import NOISE, SIGMA, base_fit, hidden
from tests.hidden.generator.causes_elastic import BaseRocking

ROCKING = BaseRocking("base_link", {"x": 2e-7, "y": 2e-7})


@pytest.fixture(scope="module")
def clean() -> Selection:
    """Readings with nothing missing, but noise."""
    readings = hidden(poses=12, loads=2)
    model = base_fit(readings).problem.model
    effects = candidates_for(model, readings, Options())
    return select(model, readings, NOISE, effects, max_effects=1, alpha=0.01)


def test_explain_and_identify_give_one_number_for_one_model() -> None:
    readings = hidden(ROCKING, poses=12, loads=3)
    model = base_fit(readings).problem.model
    answer = explain(model, readings)
    (error,) = held_out(readings, refitted(model))
    assert answer.steps[0].heldout_rms == pytest.approx(error.rms, rel=1e-12)
    assert answer.steps[-1].heldout_rms < 0.5 * error.rms
    assert answer.steps[-1].heldout_rms == pytest.approx(np.sqrt(2.0) * SIGMA, rel=0.25)


def test_an_effect_that_all_readings_brought_must_be_found_again_without_a_pose(clean) -> None:
    """The best of 57 effects fits noise; it earns nothing where noise is predicted."""
    regression = clean.regression
    assert clean.chosen == ()
    falls = {}
    for effect in regression.candidates:
        if len(effect.parameters) <= 2:
            try:
                both = fit(clean.base.model + effect, clean.base.problem.measurements, noise=NOISE)
            except Exception:  # noqa: BLE001  (not every effect has a fit)
                continue
            falls[effect] = clean.base.chi_square - both.chi_square
    impostor = max(falls, key=lambda each: falls[each])
    assert falls[impostor] > 3.0
    steps = gap_steps(clean, [impostor], None, seed=0)
    assert steps[1].fit_rms < steps[0].fit_rms
    # every part refuses the impostor: the procedure is not credited with it
    assert steps[1].heldout_rms == pytest.approx(steps[0].heldout_rms, rel=1e-12)


def test_noise_and_names_are_those_of_the_readings_at_hand(clean) -> None:
    readings = hidden(ROCKING, poses=12, loads=2)
    base, one = nested(clean, (0, 1))(readings)
    assert base.problem.noise == NoiseModel(SIGMA, zero="shared")
    assert {e.id for e in one.model.effects} - {e.id for e in base.model.effects} == {
        "base_rocking:base_link"
    }
    again, none = nested(clean, (0, 1))(hidden(poses=12, loads=2, seed=9))
    assert again.model.names == none.model.names


def test_the_candidates_are_those_of_the_robot(clean) -> None:
    measured = clean.base.problem.measurements
    robot = clean.base.model.robot
    known = {e.id for e in all_effects(robot, poses=measured.poses, timed=False)}
    assert {e.id for e in clean.candidates} <= known
    assert load_cases_of(robot, measured).count == measured.n_readings
