"""What a user stands an arm on, or puts on its flange, may be far softer than any drive."""

from collections.abc import Mapping

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect
from sk120stiff.explain import Options
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.findings import Evidence, Finding
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.confirm import UNTRIED
from sk120stiff.explain.judge.soft_parts import with_soft_parts
from sk120stiff.explain.options import candidates_for
from sk120stiff.explain.select.brought import brought, soft_rivals, softer_instead
from sk120stiff.explain.select.stepwise import Selection, refit
from tests.data_checks.readings import ARMS, loads_as_if
from tests.explain.readings import answered, base_fit, hidden
from tests.hidden.generator.causes_elastic import BaseRocking, JointTilt, ToolCompliance
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause

OTHERS = ("joint_tilt", "link_bending", "link_torsion", "closure_coupling", "base_sliding")
WHEELS = BaseRocking("base_link", {"x": 1 / 3e4, "y": 1 / 2e4})
RUBBER = ToolCompliance("tool0", {"rx": 1 / 800.0, "ry": 1 / 500.0})


@pytest.mark.parametrize(
    ("cause", "name"),
    [(WHEELS, "base_rocking:base_link"), (RUBBER, "tool_compliance:tool0")],
)
def test_it_is_named_with_its_size_and_springs_keep_theirs(cause: Cause, name: str) -> None:
    springs = base_model(load_robot("motoman_sk120"))
    assert springs is not None
    options = Options(only=("base_rocking", "tool_compliance", *OTHERS))
    answer = answered(springs, hidden(cause, poses=12), options=options)
    assert [finding.effect.id for finding in answer.findings] == [name]
    assert [said for said in answer.notes if said.startswith(name) and "than is customary" in said]
    for spring, true in zip(answer.final.parameters, sk120().typical.joint.values(), strict=False):
        assert abs(spring.value - true) < 3.5 * spring.std
    soft = [p for p in answer.final.parameters if p.effect.id == name and p.internal > 1e-5]
    sizes = sorted(size for size in cause.sizes.values() if size)
    for found, true in zip(sorted(soft, key=lambda p: p.internal), sizes, strict=True):
        assert abs(found.internal - true) < 3.5 * found.internal_std


@pytest.mark.parametrize(
    ("cause", "name"),
    [
        (BaseRocking("base_link", {"x": 1e-6, "y": 1e-6}), "base_rocking:base_link"),
        (ToolCompliance("tool0", {"rx": 1e-5, "ry": 2e-5}), "tool_compliance:tool0"),
        (JointTilt("joint_2_l", {"first": 4e-7, "second": 0.0}), "joint_tilt:joint_2_l"),
    ],
)
def test_what_is_customary_is_looked_for_within_that(cause: Cause, name: str) -> None:
    springs = base_model(load_robot("motoman_sk120"))
    assert springs is not None
    readings = hidden(cause, poses=12)
    candidates = candidates_for(springs, readings, Options())
    assert brought(base_fit(readings), candidates, alpha=0.01)[0] == frozenset()
    assert name in {each.id for each in candidates}


@pytest.mark.parametrize("factor", [1.0, 9.807])
def test_units_in_doubt_come_before_names(factor: float) -> None:
    arm = ARMS["sk120"]()
    readings = loads_as_if(arm.readings, factor)
    answer = answered(arm.model, readings, options=Options(only=("joint_tilt",)))
    first = "Make sure of the units before anything else"
    assert next_step(answer).startswith(first) == (factor != 1.0)
    assert (" If they are right: " in next_step(answer)) == (factor != 1.0)
    assert (answer.units is not None) == (factor != 1.0)
    assert answer.document().units == answer.units


@pytest.mark.parametrize(
    ("cause", "told"),
    [
        (ToolCompliance("tool0", {"tx": 1 / 3e5, "ty": 1 / 4e5}), True),
        (JointTilt("joint_2_l", {"first": 4e-7, "second": 3e-7}), False),
    ],
)
def test_a_soft_part_is_told_where_another_name_stands_for_it(cause: Cause, told: bool) -> None:
    """A tilt stands for a tool on rubber, and for itself: what is customary is no reading."""
    readings = hidden(cause, poses=12)
    base = base_fit(readings)
    options = Options(only=("tool_compliance", "joint_tilt"))
    candidates = candidates_for(base.model, readings, options)
    tilt = next(each for each in candidates if each.id == "joint_tilt:joint_2_l")
    final = refit(base, [tilt])
    ids = [effect.id for effect in base.model.effects]
    regression = regression_at(final, candidates, ids, alpha=0.01)
    place = [each.id for each in regression.candidates].index(tilt.id)
    nobody = np.zeros(0, dtype=np.intp)
    named = Selection(base, final, regression, (place,), nobody, candidates, 0.0, 0.0)
    said = softer_instead(soft_rivals(named))
    assert bool(said) == told
    if told:
        sentence = said[tilt.id]
        assert sentence.startswith("tool_compliance:tool0 would explain far more in place of joint")
        assert "stiffness_shift" in sentence and f"--exclude {tilt.id}" in sentence
    alone = Evidence(99.0, 99.0, None, np.inf, UNTRIED, {tilt.id: 0.999}, {})
    before = Named((Finding(tilt, (), (), alone),))
    found, after = with_soft_parts(named, before, soft_rivals(named), seed=0)
    if not told:
        assert (found, after) == (named, before)
        return
    (finding,) = after.findings
    assert finding.effect.id == "tool_compliance:tool0" and finding.effect in found.effects
    assert finding.probability > 0.95 and finding.evidence.confirmation.holds
    assert finding.evidence.runner_up == tilt.id and not finding.alternatives
    size = found.final.model.parameter("tool_compliance:tool0.stiffness_shift_x")
    assert size.value == pytest.approx(3e5, rel=0.05)


def test_a_soft_part_that_would_do_as_well_is_in_the_set() -> None:
    robot = load_robot("motoman_sk120")
    tilt = effect(robot, "joint_tilt", "joint_2_l")
    odds = {tilt.id: 0.95, "base_rocking:base_link": 0.04}
    said = Evidence(99.0, 99.0, None, np.inf, UNTRIED, odds, {"base_rocking:base_link": 6.3})
    wider = Finding(tilt, (), (), said).beside("tool_compliance:tool0", 2.0)
    assert wider.alternatives == ("tool_compliance:tool0",)
    shares = wider.evidence.odds
    assert shares["tool_compliance:tool0"] / shares[tilt.id] == pytest.approx(np.exp(-1.0))
    assert sum(shares.values()) == pytest.approx((0.99 + 0.95 * np.exp(-1.0)) / wider_whole(shares))


def wider_whole(shares: Mapping[str, float]) -> float:
    """What all shares were divided by."""
    return 0.04 / shares["base_rocking:base_link"]
