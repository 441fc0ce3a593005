"""Two laws of one gear share their probability with a law of its position that does as well."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain.judge.one_gear import imitated_together
from sk120stiff.explain.judge.remainder import Remainder
from sk120stiff.explain.localise.suspects import suspect_named
from sk120stiff.explain.select.stepwise import refit
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import Measurements
from tests.explain.readings import NOISE, hidden
from tests.hidden.generator.causes_joint import FrictionHysteresis, GearHardening

JOINT = "joint_2_l"
WAVES = f"the position of {JOINT}, on which its own stiffness depends in 2 waves a turn"
LAWS = ("gear_hardening", "friction_hysteresis")


@pytest.fixture(scope="module")
def springs():
    return base_model(load_robot("motoman_sk120"))


def explained(springs, readings: Measurements, *laws: str) -> tuple[Fit, list]:
    """Springs and these laws of one gear."""
    base = fit(springs, readings, noise=NOISE)
    names = [effect(springs.robot, law, JOINT) for law in laws]
    found = refit(base, names)
    return found, [each for each in found.model.effects if each.id in {n.id for n in names}]


def by_position(springs, readings: Measurements, by: float) -> Measurements:
    """The gear is softer at some angles than at others; `by` [m] rms."""
    cause = suspect_named(WAVES, springs, load_cases_of(springs.robot, readings))
    assert cause is not None and cause.drive == JOINT
    columns = cause.columns[..., 0]
    moved = np.array(readings.displacement) + by * columns / np.sqrt((columns**2).mean())
    return replace(readings, displacement=moved)


def test_a_stiffness_that_goes_with_the_position_is_no_two_laws_of_the_torque(springs):
    readings = by_position(springs, hidden(poses=15, loads=1, seed=3), 2e-4)
    (told,) = imitated_together(*explained(springs, readings, *LAWS))
    assert told.ids == tuple(f"{law}:{JOINT}" for law in LAWS)
    assert told.probability > 0.9
    assert "2 waves" in told.suspect and told.suspect in told.sentence()


def test_two_laws_that_are_there_keep_their_probability(springs):
    causes = (
        GearHardening(JOINT, {"first": 0.5}, {"T1": 60.0}),
        FrictionHysteresis(JOINT, {"half_width": 1e-4}),
    )
    readings = hidden(*causes, poses=20, loads=4, schedule="up_down")
    (told,) = imitated_together(*explained(springs, readings, *LAWS))
    assert told.probability < 0.01


def test_one_law_alone_is_not_asked(springs):
    readings = by_position(springs, hidden(poses=8, loads=1, seed=3), 2e-4)
    assert imitated_together(*explained(springs, readings, LAWS[0])) == ()


def test_what_may_stand_in_their_place_counts_as_something_else(springs):
    readings = hidden(poses=8, loads=2, seed=3)
    left = Remainder(explained(springs, readings, LAWS[0])[0], something_else=0.2)
    assert left.unless([0.5]).something_else == pytest.approx(0.6)
    assert left.unless([]) is left
