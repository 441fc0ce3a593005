"""A name that imitates is told from one that stands beside a cause without a name."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.errors import Refusal
from sk120stiff.explain import Options
from sk120stiff.explain.judge import beside_form, imitation
from sk120stiff.explain.judge.attribution import _objection as objection
from sk120stiff.explain.judge.attribution import findings_of
from sk120stiff.explain.judge.beside_form import beside_model_form
from sk120stiff.explain.judge.imitation import Lineup, imitated, instead_of, spread_over_poses
from sk120stiff.explain.judge.misspecified import CURVE
from sk120stiff.explain.judge.misspecified import _length as length
from sk120stiff.explain.judge.outweighed import outweighed
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.explain.select.stepwise import refit, select
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import Measurements, ModelForm
from tests.explain.readings import NOISE, answered, hidden
from tests.hidden.generator.causes_elastic import BaseSliding, JointTilt
from tests.hidden.generator.causes_foreign import QuadraticMount, TrackerStand
from tests.hidden.generator.causes_joint import GearHardening
from tests.hidden.generator.causes_sensor import ForceBias, ForceCrosstalk

ROUGH = replace(NOISE, form=ModelForm(0.01, 0.0))
COUPLING = ("closure_coupling", "joint_2_l,joint_3_u")
PLACES = [("joint_tilt", f"joint_{where}") for where in ("1_s", "2_l", "3_u", "5_b")]
TILT = JointTilt("joint_2_l", {"first": 8e-7, "second": 0.0})


@pytest.fixture(scope="module")
def springs():
    return base_model(load_robot("motoman_sk120"))


def fitted(springs, readings: Measurements, name: str, where: str | None = None) -> Fit:
    """Springs and one effect beside a hundredth of every pose's compliance."""
    base = fit(springs, readings, noise=ROUGH)
    return refit(base, [effect(springs.robot, name, where)])


def named(found: Fit):
    return found.model.effects[-1]


@pytest.mark.parametrize("spread", [0.0, 0.7])
def test_the_spread_of_a_size_over_poses_comes_out(springs, spread):
    """Every pose has a tilt of its own size about the mean; the springs are alike everywhere."""
    with_it, without = hidden(TILT, poses=25, loads=4), hidden(poses=25, loads=4)
    ways = np.where(np.arange(25) % 2, 1.0, -1.0)
    share = dict(zip(with_it.poses, spread * ways, strict=True))
    factor = np.array([share[pose] for pose in with_it.pose])[:, None]
    signature = with_it.displacement - without.displacement  # the same noise in both
    readings = replace(with_it, displacement=with_it.displacement + factor * signature)
    found = fitted(springs, readings, "joint_tilt", "joint_2_l")
    told, gain = spread_over_poses(found, named(found))
    if spread:
        size = max(p.internal for p in found.parameters if p.effect == named(found))
        assert told * size == pytest.approx(spread * TILT.sizes["first"], rel=0.2)
        assert gain > 100.0
        assert imitated(found, [named(found)]) is not None
    else:
        assert told < 0.1
        assert gain < 4.0
        assert imitated(found, [named(found)]) is None


def test_poses_that_differ_in_all_that_yields_are_nothing_against_one_name(springs):
    """Loads that were off by a fifth or two at every pose: springs and tilt differ alike."""
    with_it = hidden(TILT, poses=25, loads=4)
    ways = np.random.default_rng(6).normal(size=25)
    share = dict(zip(with_it.poses, 1.0 + 0.4 * ways, strict=True))
    factor = np.array([share[pose] for pose in with_it.pose])[:, None]
    readings = replace(with_it, displacement=factor * with_it.displacement)
    found = fitted(springs, readings, "joint_tilt", "joint_2_l")
    assert imitated(found, [named(found)]) is None


@pytest.mark.parametrize("known", [True, False])
def test_the_spread_is_the_same_whether_or_not_the_noise_was_stated(springs, known):
    """The likeliest noise of a model that lets poses differ is smaller; their spread is not."""
    with_it, without = hidden(TILT, poses=25, loads=4), hidden(poses=25, loads=4)
    ways = np.where(np.arange(25) % 2, 1.0, -1.0)
    share = dict(zip(with_it.poses, 0.7 * ways, strict=True))
    factor = np.array([share[pose] for pose in with_it.pose])[:, None]
    signature = with_it.displacement - without.displacement
    readings = replace(with_it, displacement=with_it.displacement + factor * signature)
    noise = ROUGH if known else replace(ROUGH, freedom=0, sigma=20.0 * ROUGH.sigma)
    tilt = effect(springs.robot, "joint_tilt", "joint_2_l")
    found = refit(fit(springs, readings, noise=noise), [tilt])
    size = max(p.internal for p in found.parameters if p.effect == tilt)
    told = spread_over_poses(found, tilt)[0] * size
    assert told == pytest.approx(0.7 * TILT.sizes["first"], rel=0.25)


def test_a_rotation_that_stands_for_crosstalk_has_a_better_place(springs):
    """The force sensor's crosstalk is twice an antisymmetric part, a rotation, and as much more."""
    misread = hidden(ForceCrosstalk("sensor", {"xy": 0.06, "zx": -0.04}))
    found = fitted(springs, misread, "force_rotation")
    other = instead_of(found, [named(found)])
    assert other.effects == ("force_rotation:sensor",)
    assert other.better > 50.0
    assert "better with" in imitated(found, [named(found)])[1]
    right = fitted(springs, misread, "force_crosstalk")
    assert imitated(right, [named(right)]) is None


def test_a_cause_beside_another_of_another_place_stands(springs):
    """A bias of the force and a tilt: what is left of the tilt is no reason against the bias."""
    both = hidden(ForceBias("sensor", {"x": 12.0, "y": -9.0, "z": 5.0}), TILT)
    found = fitted(springs, both, "force_bias")
    assert imitated(found, [named(found)]) is None


@pytest.mark.parametrize("along", [True, False])
def test_constants_along_the_turn_of_a_joint_are_no_zero_offsets(springs, along):
    """A drive that does not begin every pose alike; and a tracker that moved, any way."""
    clean = hidden(poses=20, loads=3)
    load_cases = load_cases_of(springs.robot, clean)
    rng = np.random.default_rng(4)
    turn = load_cases.nominal.linear_jacobian[:, :, 0]  # of joint_1_s
    twist = dict(zip(clean.poses, 6e-5 * rng.normal(size=20), strict=True))
    moved = dict(zip(clean.poses, 5e-5 * rng.normal(size=(20, 3)), strict=True))
    offset = np.array([twist[p] * turn[k] if along else moved[p] for k, p in enumerate(clean.pose)])
    readings = replace(clean, displacement=clean.displacement + offset)
    only = Options(only=("zero_offset", "joint_tilt", "base_rocking"))
    answer = answered(springs, readings, options=only)
    names = [finding.effect.id for finding in answer.findings]
    assert names == ([] if along else ["zero_offset:tracker"])


def test_the_free_form_of_a_names_own_law_is_no_reason_against_it(springs):
    """Anchors that yield with the square of the moment: the floor rocks, by another law."""
    floor = QuadraticMount("base_link", {"x": 4e-7, "y": 3e-7}, {"full": 800.0})
    found = fitted(springs, hidden(floor), "base_rocking")
    assert instead_of(found, [named(found)]) is None


@pytest.mark.parametrize(("name", "seed"), [("tool_compliance", 7), ("base_sliding", 11)])
def test_what_says_the_same_with_fewer_columns_is_no_reason_against_a_name(springs, name, seed):
    """Loads along one direction: a base that slides, a tool that gives, and what a link carries."""
    sliding = BaseSliding("base_link", dict.fromkeys("xyz", 1.3e-7))
    readings = hidden(sliding, schedule="one_direction", seed=seed)
    found = refit(fit(springs, readings, noise=NOISE), [effect(springs.robot, name)])
    assert instead_of(found, [named(found)]) is None


def test_a_name_stands_beside_a_cause_of_which_another_imitates_part(springs):
    """A tracker that turns with the floor: what is left of that looks like a coupling of joints.

    A misread displacement, which comes near to it, holds no share of what the names themselves
    bring.
    """
    stand = TrackerStand("tracker", {"compliance": 5e-8}, {"at": [4.0, 1.0, 1.0]})
    base = fit(springs, hidden(TILT, stand), noise=ROUGH)
    names = [effect(springs.robot, *n) for n in (("joint_tilt", "joint_2_l"), COUPLING)]
    assert instead_of(refit(base, names), names).effects == (names[1].id,)
    assert imitated(refit(base, names[:1]), names[:1]) is None


def test_the_search_begins_beside_what_confirmed_names_leave(springs):
    """Else what they explain counts as model-form error, and hides them."""
    base = fit(springs, hidden(TILT), noise=NOISE)
    tilt = effect(springs.robot, "joint_tilt", "joint_2_l")
    sizes = []

    def under(noise):
        sizes.append(noise.form.proportional)
        raise Refusal("seen")

    for names in ([], [tilt]):
        at, ids = refit(base, names), [each.id for each in names]
        with pytest.raises(Refusal, match="seen"):
            beside_model_form(at, under, names=ids, seed=0)
    assert sizes[0] > 0.01
    assert sizes[1] < 0.1 * sizes[0]


def test_a_round_that_takes_the_noise_for_larger_does_not_unsay_a_stated_sigma(springs):
    """What was stated is asked again in the next round, and stays the yardstick."""
    base = fit(springs, hidden(TILT), noise=NOISE)
    asked, names = [], iter(["first", "second", "third"])

    def larger(at):
        asked.append(at.problem.noise.known)
        return replace(at.problem.noise, freedom=0)

    def under(noise):
        final = replace(base, problem=replace(base.problem, noise=noise))
        return SimpleNamespace(final=final, total=0.0, scored=SimpleNamespace(score=0.0))

    def judged(found, **_):
        name = SimpleNamespace(effect=SimpleNamespace(id=next(names)))
        return found, SimpleNamespace(findings=(name,))

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(beside_form, "with_model_form", larger)
        patched.setattr(beside_form, "judged", judged)
        beside_form._settled(base, under, (), 0)
    assert asked == [True, True, True]


def test_beside_model_form_error_a_name_is_at_few_places(springs):
    """What fits at many joints is part of what has no name."""
    for noise, stands in ((NOISE, True), (ROUGH, False)):
        candidates = [effect(springs.robot, *where) for where in PLACES]
        found = select(springs, hidden(TILT), noise, candidates, max_effects=1, alpha=0.01)
        findings, _ = findings_of(found, seed=0)
        many = replace(findings[0], alternatives=tuple(each.id for each in candidates))
        assert (objection(found, [many], 0, -np.inf) is None) == stands


@pytest.mark.parametrize(("gain", "falls"), [(8.0, True), (50.0, False)])
def test_a_second_law_of_a_gear_must_show_by_more_than_its_law_is_inexact(springs, gain, falls):
    """Whatever stands first: play takes more micrometres where the curve bends anyway."""
    gear = GearHardening("joint_2_l", {"cubic": 0.8}, {"T": 700.0})
    kinds = [("gear_hardening", "joint_2_l"), ("lost_motion", "joint_2_l"),
             ("lost_motion", "joint_3_u")]  # fmt: skip
    bend, play, elsewhere = (effect(springs.robot, *where) for where in kinds)
    found = select(springs, hidden(gear), NOISE, [bend, play, elsewhere],
                   max_effects=1, alpha=0.01)  # fmt: skip
    assert [each.id for each in found.effects] == [bend.id]
    first = findings_of(found, seed=0)[0][0]
    whole = length(found, bend, [bend])
    assert whole == pytest.approx(np.sqrt(first.evidence.misfit_gain), rel=1e-6)
    assert np.sqrt(8.0) < CURVE * whole < np.sqrt(50.0)
    sure = {each.id: 1.0 for each in (bend, play, elsewhere)}
    slight, strong = (replace(first.evidence, misfit_gain=g, odds=sure) for g in (gain, 60.0))
    second = replace(first, effect=play, evidence=slight)
    first = replace(first, evidence=strong)
    said = objection(found, [second, first], 0, -np.inf)
    assert (said is not None and said.misspecification) == falls
    assert objection(found, [second, first], 1, -np.inf) is None
    apart = replace(second, effect=elsewhere)
    assert objection(found, [apart, first], 0, -np.inf) is None


def test_what_other_poses_refuted_lends_a_set_no_probability(springs):
    """A bearing with P = 0.02 stood first in a set that a rival which had fallen made likely."""
    tilt = effect(springs.robot, "joint_tilt", "joint_2_l")
    found = select(springs, hidden(JointTilt("joint_2_l", {"first": 4e-7, "second": 2e-7})), NOISE,
                   [tilt], max_effects=1, alpha=0.01)  # fmt: skip
    (first,), _ = findings_of(found, seed=0)
    odds = {tilt.id: 0.02, "force_crosstalk:sensor": 0.95}
    said = replace(first.evidence, odds=odds)
    both = replace(first, alternatives=("force_crosstalk:sensor",), evidence=said)
    assert objection(found, [both], 0, -np.inf) is None
    fallen = objection(found, [both], 0, -np.inf, {"force_crosstalk:sensor"})
    assert fallen is not None and "less likely at work than not" in fallen.reason


@pytest.mark.parametrize("share", [1.0, 0.05])
def test_a_name_that_takes_less_than_remains_may_imitate_part_of_it(springs, share):
    """A tilting joint beside a tracker on the same floor: the larger one, and the smaller."""
    tilt = JointTilt("joint_2_l", {"first": 8e-7 * share, "second": 0.0})
    stand = TrackerStand("tracker", {"compliance": 3e-8}, {"at": (2.0, -2.5, 0.5)})
    found = fitted(springs, hidden(tilt, stand), "joint_tilt", "joint_2_l")
    base = fit(springs, found.problem.measurements, noise=ROUGH)
    reason = outweighed(SimpleNamespace(base=base, final=found), [named(found)])
    assert (reason is None) == (share == 1.0)
    assert reason is None or "remain without a name" in reason[1]
    exact = fit(springs, found.problem.measurements, noise=NOISE)
    assert outweighed(SimpleNamespace(base=exact, final=found), [named(found)]) is None


@pytest.mark.parametrize(
    ("alike", "falls"),
    [((), True), (("link_bending:link_2_l",), True), (("tool_compliance:tool0",), False)],
)
def test_the_free_form_of_what_cannot_be_told_from_a_name_is_no_reason_against_it(
    springs, alike, falls
):
    """Tilt of the last bearing or a tool that turns: the moment on the tool says the same."""
    names = [effect(springs.robot, "joint_tilt", "joint_2_l")]
    found = refit(fit(springs, hidden(TILT), noise=NOISE), names)
    columns = np.array([[1.0, 0.9], [0.0, np.sqrt(0.19)]])
    law = Suspect("law", "it", np.zeros((1, 3, 1)), columns[0], "", frees=("tool_compliance",))
    line = Lineup(
        suspects=(law,),
        gram=columns.T @ columns,
        moment=columns.T @ (30.0 * columns[:, 1]),
        names=[np.array([0])],
        parts=[np.array([1])],
        unit=4.0,
        drawn={},
    )
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(imitation, "line_up_with", lambda *_: line)
        assert (imitated(found, names, [alike]) is not None) == falls
