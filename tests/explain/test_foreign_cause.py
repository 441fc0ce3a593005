"""Springs beside a cause that no effect in the model is: their errors hold what it did to them."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain.judge.foreign_cause import moved_by_a_foreign_cause
from sk120stiff.explain.judge.remainder import remainder_of
from sk120stiff.identify import fit
from sk120stiff.identify.uncertainty.errors_of_poses import with_model_form
from sk120stiff.measurements import NoiseModel
from tests.explain.readings import NOISE, hidden
from tests.hidden.generator.causes_foreign import AxialLink, TrackerStand
from tests.hidden.generator.sk120 import sk120
from tests.identify.conftest import readings_of

SIGMA = 5e-6


@pytest.mark.parametrize(
    "cause",
    [
        AxialLink("link_2_l", {"compliance": 3e-8}),
        TrackerStand("tracker", {"compliance": 3e-8}, {"at": (2.0, -2.5, 0.5)}),
    ],
)
def test_what_a_foreign_cause_did_to_springs_is_in_their_errors(cause):
    springs = base_model(load_robot("motoman_sk120"))
    readings = hidden(cause)
    found = fit(springs, readings, noise=with_model_form(fit(springs, readings, noise=NOISE)))
    remains = remainder_of(found).rms
    together = moved_by_a_foreign_cause(found, remains)
    moved = np.sqrt(np.diag(together)) * found.problem.scale
    true = np.array([1.0 / sk120().typical.joint[p.effect.where] for p in found.parameters])
    off = np.array([p.internal for p in found.parameters]) - true
    std = np.array([p.internal_std for p in found.parameters])
    assert np.abs(off / std).max() > 4.0
    assert np.abs(off / np.hypot(std, moved)).max() < 2.5
    assert not moved_by_a_foreign_cause(found, 0.0).any()
    # It moves them together: as a whole, too, they are where their joint errors allow.
    whole = together * np.outer(found.problem.scale, found.problem.scale) + np.diag(std**2)
    assert np.linalg.eigvalsh(together).min() > -1e-9 * np.trace(together)
    assert off @ np.linalg.solve(whole, off) < 16.3  # 99.9 % of χ² of the three springs
    assert off @ np.linalg.solve(np.diag(std**2), off) > 16.3


def test_a_foreign_cause_does_not_undo_a_calibration():
    """Gains and springs share a factor that no reading tells: it is the sensor's usual error."""
    robot = load_robot("ur5e")
    model = base_model(robot) + effect(robot, "force_scale", "sensor")
    gains = zip("xyz", (0.03, -0.02, 0.01), strict=True)
    truth = model.with_public(**{f"force_scale:sensor.scale_{axis}": s for axis, s in gains})
    readings = readings_of(truth, poses=30, sigma=SIGMA, seed=3)
    cases, softer = load_cases_of(robot, readings), truth.values.copy()
    softer[2] *= 1.2
    teeth = np.sin(11.0 * readings.joints[:, 2])[:, None]  # a cause that the model lacks
    more = truth.predict(cases, softer) - truth.predict(cases)
    readings = replace(readings, displacement=readings.displacement + teeth * more)
    noise = NoiseModel(SIGMA, zero="separate")
    found = fit(model, readings, noise=with_model_form(fit(model, readings, noise=noise)))
    moved = np.sqrt(np.diag(moved_by_a_foreign_cause(found, remainder_of(found).rms)))
    moved *= found.problem.scale
    for own, by_cause in zip(found.parameters, moved, strict=True):
        share = by_cause / (own.internal if own.effect.joint_spring else 1.0)
        assert 0.0 < share < 0.1
