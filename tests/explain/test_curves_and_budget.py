"""One curve of a gear has one name; what it does is told in micrometres, and what to do next."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff import InputError, base_model, load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain import Options
from sk120stiff.explain.answer.next_step import next_step
from sk120stiff.explain.answer.sizes import whole_size
from sk120stiff.explain.judge.budget import error_budget
from sk120stiff.explain.judge.gear_curve import STEPS, gear_curves
from sk120stiff.explain.priors import PRIORS, USUAL, price, priors_from
from sk120stiff.identify import fit
from sk120stiff.model.budget import shares as error_shares
from tests.explain.readings import NOISE, answered, hidden
from tests.hidden.generator.causes_curves import MaxwellSlip, Reversible, SmoothPlay
from tests.hidden.generator.sk120 import sk120

GEARS = Options(
    only=("lost_motion", "gear_hardening", "friction_hysteresis", "zero_offset", "joint_tilt")
)


@pytest.fixture(scope="module")
def springs():
    return base_model(load_robot("motoman_sk120"))


#: 100 µrad whose flanks close over 60 and 20 N·m, far above the noise
PLAY = SmoothPlay("joint_1_s", {"half_width": 1e-4}, {"flank": 40.0, "skew": 0.5})


@pytest.fixture(scope="module")
def skewed(springs):
    return answered(springs, hidden(PLAY, sigma=4e-6), options=GEARS)


def test_skewed_play_with_flanks_has_one_name(skewed):
    assert [finding.effect.id for finding in skewed.findings] == ["lost_motion:joint_1_s"]
    assert not skewed.adequacy.lacking


def test_a_maxwell_slip_gear_is_friction_and_nothing_else(springs):
    gear = MaxwellSlip(
        "joint_1_s", {"half_width": 9e-5}, {"shares": (0.5, 0.3, 0.2), "reach": (2e-5, 8e-5, 2e-4)}
    )
    answer = answered(springs, hidden(gear, schedule="up_down", sigma=4e-6), options=GEARS)
    names = [finding.effect.id for finding in answer.findings]
    assert names == ["friction_hysteresis:joint_1_s"]
    (curve,) = gear_curves(answer.final, names)
    # round the bench once: the loop's area is the work that friction takes, 2 h by 2 T less corners
    whole = slice(STEPS - 1, None)
    lost = -np.trapezoid(curve.twist[whole], curve.torque[whole])
    box = 4.0 * 9e-5 * curve.torque.max()
    assert 0.6 * box < lost < box


def test_the_found_curve_is_that_of_the_gear(skewed):
    """Spring and skewed flanks as the generator has them; no loop; the plain law is another."""
    (curve,) = gear_curves(skewed.final, ["lost_motion:joint_1_s"])
    compliance = 1.0 / sk120().typical.joint["joint_1_s"]
    true = compliance * curve.torque + PLAY.curve(curve.torque, compliance)
    off = np.abs(curve.twist - true)
    assert off.max() < 6e-6  # of 820 µrad
    assert (off <= 2.0 * curve.band + 2e-6).mean() > 0.9
    whole = slice(STEPS - 1, None)
    assert np.abs(np.trapezoid(curve.twist[whole], curve.torque[whole])) < 1e-9
    assert np.abs(curve.ideal - true).max() > 3e-5
    read = np.interp(curve.measured[:, 0], np.sort(curve.torque), np.sort(curve.twist))
    assert len(curve.measured) > 30
    assert np.sqrt(np.mean((curve.measured[:, 1] - read) ** 2)) < 1.5e-5


def test_no_gear_has_no_curve(skewed):
    assert gear_curves(skewed.final, ["joint_tilt:joint_2_l"]) == ()


def test_the_budget_adds_up_as_vectors(skewed):
    fitted = skewed.final
    _, derivative = fitted.model.predict_with_sensitivities(fitted.problem.load_cases)
    whole = fitted.model.predict(fitted.problem.load_cases)
    first_order = derivative @ fitted.model.values
    assert np.abs(first_order - whole).max() < 2e-3 * np.abs(whole).max()
    found = {share.name: share for share in skewed.budget}
    play = derivative[:, :, 3:] @ fitted.model.values[3:]
    assert found["lost_motion:joint_1_s"].rms == pytest.approx(np.sqrt(np.mean(play**2)))
    assert 0.0 < found["lost_motion:joint_1_s"].std < 0.1 * found["lost_motion:joint_1_s"].rms
    assert [share.rms for share in skewed.budget] == sorted(
        (share.rms for share in skewed.budget), reverse=True
    )


def test_what_moves_nothing_has_no_share_from_rounding(springs):
    whole = error_shares(springs, np.full((4, 3, 3), 1e-7), None)
    assert {share.rms for share in whole} == {0.0}


def test_the_error_of_a_share_is_that_of_drawn_readings(springs):
    """Thirty draws of the noise scatter as the budget says."""
    clean = hidden(sigma=1e-12)
    rng = np.random.default_rng(3)
    sizes, told = [], []
    for _ in range(30):
        drawn = hidden(seed=int(rng.integers(1 << 30)), poses=4, loads=3)
        shares = error_budget(fit(springs, drawn, noise=NOISE), load_cases_of(springs.robot, clean))
        (own,) = (share for share in shares if share.name == "joint_springs:joint_2_l")
        sizes.append(own.rms)
        told.append(own.std)
    assert np.std(sizes) == pytest.approx(np.median(told), rel=0.5)


def test_play_is_told_as_one_size_and_jumps_only_where_it_does(skewed):
    """200 µrad from flank to flank, gone over 20 and 60 N·m: nowhere at once."""
    (finding,) = skewed.findings
    whole = whole_size(skewed, finding)
    assert (whole.name, whole.unit) == ("lost_motion", "rad")
    assert abs(whole.value - 2e-4) < max(3.0 * whole.std, 1.5e-5)
    assert 0.0 < whole.std < 0.2 * whole.value
    assert f"{1e6 * whole.value:.0f} ± " in whole.sentence
    assert ("no jump was found" in whole.sentence) or ("nowhere at once" in whole.sentence)
    assert "jumps" not in finding.effect.sentence()
    assert skewed.document().effects[0].size.std == whole.std


def test_a_gear_that_stiffens_is_told_by_its_stiffness_not_by_signs(springs):
    hardening = effect(springs.robot, "gear_hardening", "joint_1_s")
    found = fit(springs + hardening, hidden(poses=8, loads=3), noise=NOISE)
    k2, k3 = 4e-10, -2e-13
    spring = found.model.parameter("joint_springs:joint_1_s.stiffness").name
    values = {f"{hardening.id}.quadratic": k2, f"{hardening.id}.cubic": k3, spring: 1e6}
    bent = SimpleNamespace(model=found.model.with_public(values), problem=found.problem,
                           covariance=found.covariance, reach=found.reach)  # fmt: skip
    whole = whole_size(SimpleNamespace(final=bent), SimpleNamespace(effect=hardening))
    torque = hardening.largest_torque(found.problem.load_cases)
    slope = 1e-6 - 2.0 * k2 * torque - 3.0 * k3 * torque**2
    assert whole.value == pytest.approx(1e-6 / slope, rel=0.03)
    assert "kN·m/rad about no torque" in whole.sentence
    assert not any("positive: stiffer" in spec.meaning for spec in hardening.parameters)


def test_what_to_do_now_says_what_the_model_is_worth(skewed):
    said = next_step(skewed)
    assert said.startswith("Use model.yaml: at poses that no fit saw")
    assert "lost_motion:joint_1_s brings the most" in said


def test_nobody_is_sent_to_look_first_where_a_share_is_not_known(skewed):
    """139 ± 176 µm is no reason to take an arm apart; the sum of two effects was well known."""
    vague = replace(skewed)
    vague.__dict__["budget"] = tuple(replace(s, std=s.rms) for s in skewed.budget)
    assert "these readings do not tell" in next_step(vague)
    assert "look there first" not in next_step(vague)


@pytest.mark.parametrize(("robot", "weighs"), [("motoman_sk120", False), ("ur5e", True)])
def test_where_nothing_is_confirmed_the_masses_of_the_urdf_are_put_in_doubt(skewed, robot, weighs):
    """Gears and bolts are preloaded by them; with wrong ones a clear cause has no name."""
    model = base_model(load_robot(robot))
    for gravity, told in ((None, weighs), (np.zeros(3), False)):
        final = replace(skewed.final, model=model.under(gravity))
        said = next_step(replace(skewed, verdict="outside", final=final))
        assert ("write gravity: 0 into the YAML file" in said) == (gravity is None)
        assert ("about the preload by the arm's own weight" in said) == told
        assert ("The robot file states no masses" in said) == (gravity is None and not weighs)


def test_priors_are_prices(springs):
    tilt = effect(springs.robot, "joint_tilt", "joint_2_l")
    rocking = effect(springs.robot, "base_rocking")
    assert price(rocking, {}) == 0.0
    assert price(tilt, {}) == pytest.approx(1.0, abs=0.02)
    assert price(tilt, {"joint_tilt": USUAL}) == 0.0
    likely = {"joint_tilt": 0.9, "joint_tilt:joint_2_l": 0.5}
    assert price(tilt, likely) == pytest.approx(-2.0 * np.log(9.0))
    assert all(0.0 < each.probability < 1.0 and each.source for each in PRIORS.values())


def test_priors_as_they_are_typed():
    typed = ["base_rocking=0.5", "joint_tilt:joint_2_l=0.3"]
    assert priors_from(typed) == {"base_rocking": 0.5, "joint_tilt:joint_2_l": 0.3}
    for wrong in ("base_rocking", "base_rocking=1", "base_rocking=x", "rocking=0.5"):
        with pytest.raises(InputError):
            priors_from([wrong])


class OneWayGear(Reversible):
    """A gear that gives way more under negative torque. Sizes: share of its compliance."""

    name = "gear_hardening"

    def curve(self, torque, compliance):
        return self.size("share") * compliance * np.minimum(torque, 0.0)


def test_a_gear_that_is_softer_one_way_is_no_bearing(springs):
    """The neighbour's bearing tilts about the same axis, and had two stiffnesses to do it with."""
    readings = hidden(OneWayGear("joint_2_l", {"share": 0.3}), poses=24)
    answer = answered(springs, readings)
    (finding,) = answer.findings
    assert finding.effect.id == "gear_hardening:joint_2_l"
    assert "torque of one sign" in finding.effect.sentence()
    (own,) = [p for p in answer.final.parameters if p.effect == finding.effect]
    spring = answer.final.model.parameter("joint_springs:joint_2_l.stiffness")
    assert own.internal / spring.internal == pytest.approx(0.3, abs=0.02)
    whole = whole_size(answer, finding)
    assert "1.3" in whole.sentence and "times as soft" in whole.sentence
    assert answer.steps[-1].heldout_rms < 1.2 * np.sqrt(2) * 8e-6
