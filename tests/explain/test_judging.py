"""What keeps a wrong name out: prices, noise that must not hide a cause, tests of what is left."""

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from scipy import stats

from sk120stiff import Model, base_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain import Options
from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.findings import Confirmation, Evidence, Finding
from sk120stiff.explain.judge.attribution import Fallen, Named
from sk120stiff.explain.options import candidates_for
from sk120stiff.explain.select.outliers import outlying_rows
from sk120stiff.explain.select.size_prices import price_of_sizes
from sk120stiff.identify import fit
from tests.explain.readings import SIGMA, answered, base_fit, hidden
from tests.hidden.generator.causes_detail import WarmUp
from tests.hidden.generator.causes_elastic import BaseRocking, JointTilt, LinkBending
from tests.hidden.generator.causes_foreign import QuadraticMount, RubberMount
from tests.hidden.generator.causes_joint import GearHardening
from tests.hidden.generator.causes_sensor import ForceBias


@pytest.fixture(scope="module")
def springs() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_the_level_of_a_chance_finding_is_the_same_for_one_parameter_and_for_six(count):
    """Where an effect just pays for its sizes and for looking, chance is as rare for all."""
    chance = 2e-4
    single = stats.chi2.isf(chance, 1)
    looking = single - price_of_sizes(single, 1, 1e9)
    gains = np.linspace(count + 0.1, 60.0, 4000)
    left = np.array([gain - price_of_sizes(gain, count, 1e9) for gain in gains])
    threshold = gains[np.argmax(left > looking)]
    assert 0.3 < stats.chi2.sf(threshold, count) / chance < 3.0


def test_strong_parameters_cost_what_the_information_criterion_asks():
    assert price_of_sizes(1e6, 2, 300.0) == pytest.approx(2.0 * np.log(300.0))
    assert price_of_sizes(0.5, 2, 300.0) == pytest.approx(2.0)


def test_a_floor_that_yields_with_the_square_is_not_called_noise_that_grows(springs):
    mount = QuadraticMount("base_link", {"x": 1.0e-7, "y": 1.4e-7}, {"full": 1500.0})
    unnamed = Options(exclude=("base_rocking",))
    answer = answered(springs, hidden(mount, poses=12, loads=4), options=unnamed)
    told = "the moment that tips the base, not in proportion to it"
    assert answer.verdict == "outside"
    assert answer.remainder.significant
    assert told in answer.remainder.where[0]
    tests = answer.adequacy.tests
    assert tests[f"together with {told}"] == min(tests.values())


@pytest.mark.parametrize(
    ("cause", "name", "end"),
    [
        (QuadraticMount("base_link", {"x": 2e-7, "y": 2.8e-7}, {"full": 1500.0}), "rock", "_at_"),
        (
            QuadraticMount("base_link", {"x": 2e-7, "y": 2.8e-7}, {"full": 1500.0, "gap": True}),
            "rock",
            "_positive",
        ),
        (RubberMount("tool0", {"compliance": 3e-7}, {"full": 300.0}), "tool", "_at_"),
    ],
    ids=["more and more", "one way", "less and less"],
)
def test_what_yields_out_of_proportion_is_named_by_its_law(springs, cause, name, end):
    answer = answered(springs, hidden(cause))
    assert answer.verdict == "named"
    (finding,) = answer.findings
    assert finding.effect.name == {"rock": "base_rocking", "tool": "tool_compliance"}[name]
    assert any(end in spec.name for spec in finding.effect.parameters)
    assert not answer.remainder.significant


def test_what_fits_beyond_belief_is_told(springs):
    """A bearing that tilts by 2e-5 rad/(N m) is nobody's bearing, but it is not hidden."""
    loose = JointTilt("joint_2_l", {"first": 2e-5, "second": 2e-5})
    names = Options(only=("base_sliding", "joint_tilt"))
    answer = answered(springs, hidden(loose, poses=14, loads=3), options=names)
    (told,) = (said for said in answer.unnamed if "--assume joint_tilt" in said)
    assert "N*m/rad, softer than what is believed" in told
    sound = JointTilt("joint_2_l", {"first": 1e-7, "second": 2e-7})
    answer = answered(springs, hidden(sound, poses=14, loads=3), options=names)
    assert not [said for said in answer.unnamed if "--assume" in said]


def test_the_noise_has_one_number_before_and_after(springs):
    """A floor that yields one way bends the readings of a pose; that is no noise of the springs."""
    mount = {"x": 6e-7, "y": 8e-7}, {"full": 1500.0, "gap": True}
    answer = answered(springs, hidden(QuadraticMount("base_link", *mount), stated=False))
    assert answer.verdict == "named" and answer.yardstick.source == "scatter"
    assert f"noise alone makes ({1e6 * answer.noise_floor:#.3g} µm" in answer.where[0]


def test_a_tracker_that_warms_up_is_named_by_its_course(springs):
    warming = WarmUp("tracker", {"x": 9e-6, "y": -7e-6, "z": 5e-6}, {"time": 25.0})
    answer = answered(springs, hidden(warming, sigma=4e-6))
    assert [finding.effect.id for finding in answer.findings] == ["reading_drift:tracker"]
    assert any("_over_" in spec.name for spec in answer.findings[0].effect.parameters)
    assert not answer.remainder.significant


def test_a_bias_that_the_catalogue_lacks_does_not_hide_behind_zero_offsets(springs):
    bias = ForceBias("sensor", {"x": -18.0, "y": 8.0, "z": 8.0})
    readings = hidden(bias, poses=12, loads=4, stated=False)
    names = Options(only=("force_bias", "zero_offset"))
    assert answered(springs, readings, options=names).verdict == "named"
    answer = answered(springs, readings, options=Options(exclude=("force_bias",)))
    assert answer.verdict == "outside"
    assert "a constant error of the load in tool axes" in " ".join(answer.adequacy.tests)


def test_a_gear_that_stiffens_in_steps_is_named_by_steps(springs):
    steps = GearHardening("joint_1_s", {"first": 0.6, "second": 0.2}, {"T1": 120.0, "T2": 320.0})
    answer = answered(springs, hidden(steps, sigma=4e-6))
    assert [finding.effect.id for finding in answer.findings] == ["gear_hardening:joint_1_s"]
    assert answer.verdict == "named"
    assert any("extra_below" in name for name in answer.final.model.names)
    soft = answer.final.model.parameter("joint_springs:joint_1_s.stiffness")
    assert soft.value == pytest.approx(1.41e6, rel=0.03)


def test_a_notebook_shows_the_name_its_size_and_the_gap(springs):
    rocking = hidden(BaseRocking("base_link", {"x": 2e-7, "y": 2e-7}))
    answer = answered(springs, rocking, options=Options(only=("base_rocking", "joint_tilt")))
    shown = answer._repr_html_()
    page = ET.fromstring(f"<div>{shown}</div>")
    text = " ".join(page.itertext())
    assert "base_rocking:base_link" in text
    cells = ["".join(cell.itertext()) for row in page.iter("tr") for cell in row]
    (row,) = (k for k, cell in enumerate(cells) if cell.endswith("stiffness_x"))
    assert "±" in cells[row + 1] and cells[row + 4].endswith("N·m/rad")
    assert f"{1e6 * answer.steps[-1].heldout_rms:#.3g}" in cells
    assert all(text.count(said) <= 1 for said in answer.where)


def test_a_gear_that_stiffens_smoothly_is_named_by_its_series(springs):
    answer = answered(
        springs, hidden(GearHardening("joint_1_s", {"cubic": 0.8}, {"T": 700.0}), sigma=4e-6)
    )
    assert "gear_hardening:joint_1_s.cubic" in answer.final.model.names


@pytest.mark.parametrize(
    ("name", "where", "least"),
    [
        ("gear_hardening", "joint_2_l", 7),
        ("lost_motion", "joint_2_l", 7),
        ("base_rocking", None, 4),
        ("joint_tilt", "joint_2_l", 3),
        ("tool_compliance", None, 3),
        ("reading_drift", None, 5),
    ],
)
def test_every_law_of_a_part_leads_to_all_others(springs, name, where, least):
    usual = effect(springs.robot, name, where)
    load_cases = load_cases_of(springs.robot, hidden())
    family = {usual, *usual.other_laws(load_cases)}
    assert len(family) >= least and {law.id for law in family} == {usual.id}
    for law in family:
        assert {law, *law.other_laws(load_cases)} == family


def test_a_gear_of_two_steps_is_no_play_with_wide_flanks(springs):
    """The usual law of data sheets; the softer first step is crossed at every torque but few."""
    law = {"first": 1.2, "second": 0.27}, {"T1": 135.0, "T2": 369.0}
    answer = answered(springs, hidden(GearHardening("joint_1_s", *law), sigma=15e-6))
    assert answer.findings[0].effect.id == "gear_hardening:joint_1_s"
    assert len(answer.findings[0].effect.breaks) == 2


def test_a_gear_that_stiffens_at_a_small_torque_is_no_play_beyond_doubt(springs):
    steps = GearHardening("joint_1_s", {"first": 0.5, "second": 0.1}, {"T1": 70.0, "T2": 140.0})
    answer = answered(springs, hidden(steps, sigma=10e-6))
    (found,) = answer.findings
    assert "gear_hardening:joint_1_s" in (found.effect.id, *found.alternatives)


def test_a_gear_that_stiffens_needs_a_spring_to_stiffen(springs):
    readings = hidden()
    offered = {e.id for e in candidates_for(springs, readings, Options())}
    asked = candidates_for(springs, readings, Options(only=("gear_hardening:joint_4_r",)))
    assert "gear_hardening:joint_1_s" in offered
    assert "gear_hardening:joint_4_r" not in offered
    assert [e.id for e in asked] == ["gear_hardening:joint_4_r"]


def test_readings_without_a_yardstick_are_not_held_to_be_lacking(springs):
    """Three loads a pose, nobody stated the noise: nothing can tell what is left over."""
    answer = answered(springs, hidden(loads=3, stated=False, seed=3))
    assert answer.verdict == "none"
    assert answer.adequacy.probability > 0.01


@pytest.mark.parametrize("kind", ["shared", "separate"])
def test_how_zeros_were_shared_is_found_where_nobody_said(springs, kind):
    readings = hidden(seed=12)
    if kind == "separate":
        rng = np.random.default_rng(5)
        clean = base_fit(readings)
        displacement = clean.problem.measured - clean.gap
        noise = np.sqrt(2.0) * SIGMA * rng.normal(size=displacement.shape)
        readings = replace(readings, displacement=displacement + noise)
    answer = answered(springs, replace(readings, zero="unknown"))
    assert answer.noise.zero == kind
    assert answer.verdict == "none"


def test_clean_readings_without_a_stated_noise_have_no_outliers(springs):
    """The whole catalogue is fitted before outliers are sought, and takes some of the noise."""
    found = 0
    for seed in range(12):
        readings = hidden(stated=False, seed=300 + seed)
        base = base_fit(readings, noise=None)
        candidates = candidates_for(springs, readings, Options())
        regression = regression_at(base, candidates, ("joint_springs",), alpha=0.01)
        found += bool(len(outlying_rows(regression, base.problem.whitener)))
    assert found <= 1


def test_springs_hold_their_truth_under_every_name_that_is_possible(springs):
    """A column that bends looks like torque that moves the other joint, with other springs."""
    answer = answered(springs, hidden(LinkBending("link_1_s", {"flexibility": 1e-7})))
    (finding,) = answer.findings
    assert answer.verdict == "ambiguous"
    ends = dict(zip(answer.final.parameters, answer.final.intervals(), strict=True))
    names = {finding.effect.id, *finding.alternatives}
    assert {"closure_coupling:joint_2_l,joint_3_u", "link_bending:link_1_s"} <= names
    alone = {
        p.name: p.internal_std
        for p in fit(answer.final.model, hidden(), noise=answer.noise).parameters
    }
    for joint, stiffness in {"joint_1_s": 1.41e6, "joint_2_l": 4.0e5, "joint_3_u": 9.4e5}.items():
        spring = answer.final.model.parameter(f"joint_springs:{joint}.stiffness")
        assert abs(spring.internal - 1.0 / stiffness) <= 1.96 * spring.internal_std
        assert spring.internal_std >= 0.9 * alone[spring.name]
        low, high = ends[spring]
        assert low <= stiffness <= high


def test_what_the_law_of_a_beam_leaves_over_is_no_second_cause(springs):
    """Its taper lies between two that are tried."""
    beam = LinkBending("link_2_l", {"flexibility": 8e-7}, {"taper": 0.52})
    answer = answered(springs, hidden(beam, sigma=4e-6))
    assert [finding.effect.id for finding in answer.findings] == ["link_bending:link_2_l"]
    assert "the law of link_bending:link_2_l leaves over" in " ".join(answer.unnamed)


@pytest.mark.parametrize(
    ("improved", "gain", "frequency", "rival", "foretells", "holds"),
    [
        (5, 0.1, 0.9, 0.05, True, True),
        (4, -0.5, 0.9, 0.05, True, True),  # one fold far outside decides nothing
        (3, 0.1, 0.9, 0.05, True, True),
        (3, -0.1, 0.9, 0.05, True, False),
        (2, 0.1, 0.9, 0.05, True, False),
        (5, 0.1, 0.4, 0.1, True, True),  # nothing else comes near
        (5, 0.1, 0.4, 0.3, True, False),
        (5, 0.1, 0.2, 0.0, True, False),
        (1, -0.2, 0.9, 0.05, False, True),  # draws say nothing of other poses
    ],
)
def test_a_name_has_to_be_confirmed(improved, gain, frequency, rival, foretells, holds):
    found = Confirmation(improved, 5, gain, 0.2, frequency, rival, foretells)
    assert found.holds is holds


def test_a_bias_beside_a_strong_beam_is_still_named(springs):
    """No taper of a link makes a force sensor read wrong."""
    beam = LinkBending("link_2_l", {"flexibility": 1e-6})
    answer = answered(springs, hidden(beam, ForceBias("sensor", {"x": 8.0, "y": 4.0, "z": 0.0})))
    assert {finding.effect.name for finding in answer.findings} == {"link_bending", "force_bias"}


def test_another_law_that_the_readings_refute_leaves_no_doubt(springs):
    """Nobody stated the noise, and it is far finer than what a fit starts from."""
    steps = GearHardening("joint_1_s", {"first": 0.6, "second": 0.2}, {"T1": 120.0, "T2": 320.0})
    answer = answered(springs, hidden(steps, sigma=1e-6, stated=False))
    assert [finding.effect.id for finding in answer.findings] == ["gear_hardening:joint_1_s"]
    assert answer.final.selection_uncertainty is not None
    spring = answer.final.model.parameter("joint_springs:joint_1_s.stiffness")
    assert spring.internal_std < 0.05 * spring.internal


@pytest.mark.parametrize(("flexibility", "doubted"), [(4e-7, False), (2e-7, True)])
def test_a_beams_stiffness_is_as_uncertain_as_its_taper(springs, flexibility, doubted):
    """What turns the end as far under a moment means the same whatever the beam's shape.

    The larger bend tells its taper, between the two that were looked at first.
    """
    beam = LinkBending("link_2_l", {"flexibility": flexibility}, {"taper": 0.45})
    answer = answered(springs, hidden(beam, sigma=10e-6))
    assert [finding.effect.id for finding in answer.findings] == ["link_bending:link_2_l"]
    doubt = answer.final.selection_uncertainty
    assert doubt is not None
    ((moved, stiffness),) = (  # in its plane it bends as the spring of joint 2 yields
        (moved, p)
        for moved, p in zip(doubt, answer.final.parameters, strict=True)
        if p.spec.quantity in {"EI", "EI_out_of_plane"}
    )
    assert bool(moved > 0.0) is doubted
    assert ("taper_45" in stiffness.name) is not doubted
    assert abs(stiffness.internal - flexibility) < 2.0 * stiffness.internal_std


@pytest.mark.parametrize(("flexibility", "taper"), [(4e-7, 0.4), (8e-7, 0.2)])
def test_a_taper_next_to_the_usual_one_is_found_without_a_second_name(springs, flexibility, taper):
    """What the nearest taper leaves over looks like another length of the link."""
    beam = LinkBending("link_2_l", {"flexibility": flexibility}, {"taper": taper})
    answer = answered(springs, hidden(beam, sigma=4e-6))
    assert [finding.effect.id for finding in answer.findings] == ["link_bending:link_2_l"]
    (stiffness,) = (p for p in answer.final.parameters if p.effect.name == "link_bending")
    assert stiffness.spec.name in {"EI_taper_45", "EI_taper_15"}
    assert stiffness.internal == pytest.approx(flexibility, rel=0.02)  # the usual taper: 0.03 off


def test_who_falls_again_on_the_same_ground_is_told_of_once():
    drift = "drift fits, but poses differ in its size by {} %; it is not named."
    fallen = [Fallen("drift", drift.format(share)) for share in ("82", "77.5", "80")]
    tilts = [f"joint_tilt:joint_{k} fits, but takes off 2.1 µm; it is not named." for k in (1, 2)]
    fallen[1:1] = [Fallen(said.partition(" ")[0], said) for said in tilts]
    assert Named((), tuple(fallen)).reasons == (*tilts, drift.format("80"))


def test_what_is_in_the_set_of_a_name_is_not_said_to_have_fallen(springs):
    """A set says that either may be at work; that one of them fell would say the opposite."""
    tilt = effect(springs.robot, "joint_tilt", "joint_2_l")
    seen = Evidence(9.0, 9.0, None, np.inf, Confirmation(5, 5, 1.0, 0.1, 1.0, 0.0), {})
    finding = Finding(tilt, ("link_bending:link_2",), (), seen)
    ids = ("link_bending:link_2", tilt.id, "drift")
    fallen = tuple(Fallen(name, f"{name} fits; it is not named.") for name in ids)
    assert Named((finding,), fallen).reasons == ("drift fits; it is not named.",)
