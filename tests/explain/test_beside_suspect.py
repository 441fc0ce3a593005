"""A known cause beside one that the catalogue lacks: both have their place in the model."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import Model, base_model, load_robot
from sk120stiff.effects import effect
from sk120stiff.explain import explain
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.judge.attribution import Fallen, Named
from sk120stiff.explain.judge.beside_suspect import (
    _holds,
    _with_the_last_fallen,
)
from sk120stiff.explain.judge.goes_with import NOT_FORETOLD, GoesWith, foretold
from sk120stiff.explain.judge.nuisance import nuisance
from sk120stiff.explain.select.stepwise import select
from sk120stiff.measurements import NoiseStatement
from tests.explain.readings import NOISE, SIGMA, answered, hidden
from tests.hidden.generator.causes_elastic import ToolCompliance
from tests.hidden.generator.causes_foreign import TrackerStand
from tests.hidden.generator.causes_joint import GearHardening, PeriodicGear
from tests.hidden.generator.sk120 import sk120

TEETH = PeriodicGear("joint_2_l", {"share": 0.2}, {"count": 1, "phase": 1.0})
GEAR = GearHardening("joint_1_s", {"cubic": 0.8}, {"T": 700.0})
STAND = TrackerStand("tracker", {"compliance": 5e-8}, {"at": (3.5, -0.8, -0.3)})
TOLD = "with that beside the names, nothing is left beyond the noise"


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


def test_a_name_that_fell_and_came_back_is_not_added_twice(springs: Model):
    ways = [effect(springs.robot, "gear_hardening", f"joint_{k}") for k in ("1_s", "2_l")]
    found = select(springs, hidden(GEAR), NOISE, ways, max_effects=1, alpha=0.01)
    assert [each.id for each in found.effects] == ["gear_hardening:joint_1_s"]
    for name, fits in (("gear_hardening:joint_1_s", []), ("gear_hardening:joint_2_l", [2])):
        fallen = Named((), (Fallen(name, "so"),))
        beside = _with_the_last_fallen(found, fallen)
        assert [len({p.effect.id for p in fit.parameters} & {each.id for each in ways})
                for fit in beside] == fits  # fmt: skip
    assert _with_the_last_fallen(found, Named((), ())) == []


def test_a_suspect_that_holds_a_name_is_known_by_its_columns(springs):
    """A misread displacement holds a tracker that is turned, and no gear."""
    readings = hidden(TEETH, poses=8, loads=4)
    robot = springs.robot
    wanted = [
        effect(robot, "reading_rotation", "tracker"),
        effect(robot, "gear_hardening", "joint_1_s"),
    ]
    found = select(springs, readings, NOISE, wanted, max_effects=0, alpha=0.01)
    free = nuisance("a misread displacement in reading axes", found.base)
    by_id = {each.id: each for each in found.regression.candidates}
    assert _holds(free, by_id["reading_rotation:tracker"], found)
    assert not _holds(free, by_id["gear_hardening:joint_1_s"], found)


def test_a_name_stands_beside_a_cause_without_one(springs):
    """Gear 1 stiffens, and a cause is at work that no effect is: one is named, the other told."""
    answer = explain(springs, hidden(GEAR, STAND))  # as users ask, poses left out and all
    assert [finding.effect.id for finding in answer.findings] == ["gear_hardening:joint_1_s"]
    assert answer.remainder.significant
    told = "the moment that tips the floor under base and tracker"
    assert told in answer.remainder.where[0]
    assert TOLD in answer.remainder.where[0]
    foretold = answer.remainder.where[1]
    assert foretold.startswith("Poses that are left out are foretold to ")
    beside, alone = (float(part.split()[-1]) for part in (
        foretold.partition(" µm")[0], foretold.partition(" without")[0]))  # fmt: skip
    assert alone == pytest.approx(1e6 * answer.steps[-1].heldout_rms, rel=5e-3)
    assert beside < alone
    without = hidden(GEAR).displacement - hidden(GEAR, STAND).displacement
    assert answer.remainder.rms < 1.05 * np.sqrt(np.mean(without**2))
    for spring, true in zip(answer.final.parameters, sk120().typical.joint.values(), strict=False):
        assert abs(spring.value - true) < 3.0 * spring.std


@pytest.mark.parametrize(("left", "said"), [(6e-6, "Most of it goes"), (8e-6, "Part of it goes")])
def test_most_of_it_is_more_than_half_of_its_squares(left: float, said: str) -> None:
    goes_with = GoesWith("the moon", left, 1e-5, beside_names=False)
    assert goes_with.sentences() == (
        f"{said} with the moon: with that in the model, {1e6 * left:.2f} of 10.0 µm rms per axis "
        "are left.",
    )
    assert goes_with.most == (said == "Most of it goes")


@pytest.mark.parametrize("gap", [4e-6, 4.9e-6, 6e-6])
def test_what_foretells_other_poses_no_better_is_no_law(gap: float) -> None:
    told = foretold("Poses that are left out are", gap, 5e-6)
    assert told is not None
    assert told.better == (gap < 4.75e-6) == (NOT_FORETOLD not in told.sentence())
    assert f"to {1e6 * gap:.2f} µm rms per axis with it and to 5.00 without" in told.sentence()
    assert foretold("Poses that are left out are", float("nan"), 5e-6) is None


def test_a_name_shows_beside_a_cause_that_takes_most_of_the_rest(springs):
    """Two gears are softer at some angles: beside both the third, which stiffens, is outweighed."""
    waves = PeriodicGear("joint_2_l", {"share": 0.3}, {"count": 1, "phase": 1.0})
    others = PeriodicGear("joint_3_u", {"share": 0.15}, {"count": 2, "phase": 2.0})
    answer = answered(springs, hidden(GEAR, waves, others, poses=16, loads=3))
    assert [finding.effect.id for finding in answer.findings] == ["gear_hardening:joint_1_s"]
    assert answer.remainder.where[0].startswith("Most of it goes with the position of joint_2_l")
    left = float(answer.remainder.where[0].partition("names, ")[2].partition(" of")[0])
    assert 0.0 < 1e-6 * left < 0.7 * answer.remainder.rms
    assert "Most of the rest goes with the position of joint_2_l" in next_step(answer)


def test_a_sigma_that_was_stated_too_small_hides_no_account(springs):
    """Less than a third too small: what is left has no structure, and its size is let free."""
    readings = replace(hidden(GEAR, TEETH), noise=NoiseStatement(sigma=0.72 * SIGMA))
    answer = answered(springs, readings)
    assert [finding.effect.id for finding in answer.findings] == ["gear_hardening:joint_1_s"]
    assert "the position of joint_2_l" in answer.remainder.where[0]
    assert TOLD in answer.remainder.where[0]


def test_what_hides_behind_a_name_that_fell_is_looked_for(springs):
    """A gear's teeth outweigh a soft tool, which falls; beside it they show, and it stands."""
    waves = PeriodicGear("joint_2_l", {"share": 0.2}, {"count": 7, "phase": 1.0})
    tool = ToolCompliance("tool0", {"rx": 2e-5, "ry": 2e-5})
    answer = answered(springs, hidden(tool, waves))
    assert [finding.effect.id for finding in answer.findings] == ["tool_compliance:tool0"]
    assert "its own stiffness depends in 7 waves a turn" in answer.remainder.where[0]
    assert TOLD in answer.remainder.where[0]
