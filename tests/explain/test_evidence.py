"""Folds, resampling, posterior and the state of a finding, on small arrays."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.explain.findings import NAMED, Confirmation, Evidence, Finding
from sk120stiff.explain.judge import attribution, beside_form, selection_uncertainty
from sk120stiff.explain.judge import confirm as confirming
from sk120stiff.explain.judge.adequacy import Adequacy, adequacy, explained
from sk120stiff.explain.judge.attribution import Named
from sk120stiff.explain.judge.posterior import NONE, doubted, in_full, posterior, until_covered
from sk120stiff.explain.judge.remainder import Remainder
from sk120stiff.explain.priors import FALLEN, FURTHER_IMPOSTOR
from sk120stiff.explain.select.score import score_set
from sk120stiff.identify.uncertainty.left_over import LeftOver
from sk120stiff.identify.uncertainty.variance_components import Components
from sk120stiff.measurements import ModelForm
from sk120stiff.robot import load_robot
from tests.explain.readings import base_fit, hidden
from tests.explain.test_regression import POSES, regression

SEEN = Confirmation(5, 5, 1.0, 0.1, 1.0, 0.0)


def weighed(reg):
    """Sums in which poses count so often, over every column."""
    return reg.weighing(np.arange(reg.X.shape[1]))


def test_the_held_out_gain_is_that_of_plain_least_squares_fold_by_fold():
    reg = regression()
    model = score_set(reg, reg.sums(), (0,))
    rng = np.random.default_rng(0)
    fold_gain, pose_gain, error, axes = confirming._held_out_gain(reg, weighed(reg), model, 0, rng)
    by_chance = np.zeros(POSES)
    fold = confirming.drawn_parts(POSES, confirming.FOLDS, np.random.default_rng(0))
    assert sorted(np.bincount(fold)) == [2, 2, 2, 3, 3]
    assert axes == reg.rows
    for k in range(confirming.FOLDS):
        test = fold[reg.group] == k
        left = []
        for columns in ([0, 1], [0, 1, 2]):
            v, *_ = np.linalg.lstsq(reg.X[~test][:, columns], reg.y[~test], rcond=None)
            left.append((reg.y - reg.X[:, columns] @ v)[test])
        misfit = [(each**2).sum() for each in left]
        np.add.at(by_chance, reg.group[test], 2.0 * left[1] * (left[0] - left[1]))
        assert fold_gain[k] == pytest.approx(misfit[0] - misfit[1], rel=1e-6)
        assert pose_gain[fold == k].sum() == pytest.approx(fold_gain[k])
    assert error == pytest.approx(np.linalg.norm(by_chance), rel=1e-6)


def test_a_gain_that_noise_brings_as_often_is_chance():
    """Of two standard errors one in twenty; of poses that can tell nothing, none."""
    reg = regression()
    seen = confirming.confirm(reg, score_set(reg, reg.sums(), (0,)), 0, ())
    assert replace(seen, gain=1.96, gain_error=1.0).chance == pytest.approx(0.05, abs=1e-3)
    assert replace(seen, gain=-3.0, gain_error=1.0).chance == 1.0
    assert replace(seen, gain=0.0, gain_error=0.0).chance == 1.0
    assert replace(seen, gain=-3.0, gain_error=1.0, foretells=False).chance == 0.0


def test_poses_are_drawn_again_whole_and_with_replacement():
    reg = regression()
    drawn = confirming._resampled(weighed(reg), POSES, np.random.default_rng(1))
    picked = np.random.default_rng(1).integers(0, POSES, POSES)
    assert len(set(picked)) < POSES
    rows = np.concatenate([np.flatnonzero(reg.group == pose) for pose in picked])
    assert drawn.gram == pytest.approx(reg.X[rows].T @ reg.X[rows])
    assert drawn.moment == pytest.approx(reg.X[rows].T @ reg.y[rows])
    assert drawn.count == len(rows)


def test_a_true_effect_wins_on_all_drawings_and_noise_on_none():
    reg = regression()
    model = score_set(reg, reg.sums(), (0,))
    found = confirming.confirm(reg, model, 0, ())
    assert found.frequency == 1.0
    assert found.folds_improved == found.folds == confirming.FOLDS
    assert found.holds
    chance = score_set(reg, reg.sums(), (0, 1))
    noise = confirming.confirm(reg, chance, 1, ())
    assert not noise.holds


def test_a_rival_that_wins_on_some_drawings_counts_against_the_name():
    reg = regression()
    X = reg.X.copy()
    X[:, 3] = X[:, 2] + 0.1 * np.random.default_rng(1).normal(size=len(X))
    reg = replace(reg, X=X)
    found = confirming.confirm(reg, score_set(reg, reg.sums(), (0,)), 0, ())
    rival = reg.candidates[1].id
    assert 0.0 < found.others[rival] == found.rival_frequency < found.frequency
    assert found.frequency + found.rival_frequency == pytest.approx(1.0)


def test_named_effects_explain_what_the_base_model_cannot_imitate():
    """Of a signature (2, 2) the base model makes the first part alone."""
    J = np.array([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    named = [SimpleNamespace(effect=SimpleNamespace(id=name)) for name in ("base", "cause")]
    made = SimpleNamespace(parameters=named, jacobian=J, x=np.array([5.0, 2.0]))
    assert explained(made, {"cause"}) == pytest.approx(2.0)
    assert explained(made, ()) == 0.0


def test_probabilities_are_shares_of_the_evidence():
    found = posterior({"a": 4.0, "b": 4.0 + 2.0 * np.log(3.0)}, none=4.0 + 2.0 * np.log(6.0))
    weights = np.array([1.0, 1.0 / 3.0, 1.0 / 6.0])
    assert list(found.values()) == pytest.approx(list(weights[:2] / weights.sum()))


def test_names_are_listed_until_nearly_all_is_covered():
    odds = {"a": 0.80, "b": 0.09, "c": 0.05, "d": 0.02}  # 0.04 are left to none of them
    assert until_covered(odds, {"a"}) == ("b", "c", "d")
    assert until_covered(odds, {"a", "d"}) == ("b", "c")
    assert until_covered({"a": 0.94, "b": 0.009}, {"a"}) == ()
    assert until_covered({"a": 0.50, "b": 0.02}, {"a"}) == ()
    # A name that is unsettled because it may imitate what has no name does not stand alone.
    assert until_covered({"a": 0.918, "b": 0.038, "c": 0.004}, {"a"}) == ("b",)


def test_an_open_answer_lists_its_names_and_gains_nothing_by_that():
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    odds, rivals = {tilt.id: 0.80, "b": 0.12, "c": 0.02}, {"b": 4.0, "c": 7.5}
    before = Finding(tilt, (), (), Evidence(9.0, 9.0, "b", 4.0, SEEN, odds, rivals))
    after = in_full(before)
    assert after.alternatives == ("b",)
    assert (after.evidence.runner_up, after.evidence.runner_up_gap) == ("c", 7.5)
    sure = replace(before, evidence=replace(before.evidence, odds={tilt.id: 0.97, "b": 0.02}))
    assert in_full(sure) is sure


@pytest.mark.parametrize(
    ("odds", "alternatives", "exact", "settled"),
    [
        ({"a": 0.99}, (), (), True),
        ({"a": 0.80}, (), (), False),  # it may be chance
        ({"a": 0.60, "b": 0.39}, ("b",), (), False),  # other poses would tell
        ({"a": 0.60, "b": 0.39}, ("b",), ("b",), True),  # one class, whatever is measured
        ({"a": 0.60, "b": 0.10}, ("b",), ("b",), False),
    ],
)
def test_a_name_stands_alone_from_its_probability_on(odds, alternatives, exact, settled):
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    own = {tilt.id if name == "a" else name: share for name, share in odds.items()}
    found = Finding(tilt, alternatives, exact, Evidence(9.0, 9.0, None, np.inf, SEEN, own))
    assert found.probability == pytest.approx(sum(odds.values()))
    assert found.settled == settled == (settled and found.probability >= NAMED)
    half = found.doubted(0.5)
    assert half.probability == pytest.approx(0.5 * found.probability)
    assert not half.settled


def test_a_name_may_be_at_as_many_places_as_its_alternatives_that_could_be_told_from_it():
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    bent, alias = "link_bending:link_2_l", "link_bending:link_1_s"
    names = (bent, "lost_motion:joint_2_l", alias)
    found = Finding(tilt, names, (alias,), Evidence(9.0, 9.0, None, np.inf, SEEN, {}))
    assert set(found.others) == {bent, "lost_motion:joint_2_l"}
    assert found.places == 2


def test_adequacy_is_lacking_by_its_smallest_probability_alone():
    fine = Adequacy(0.002, 1.0, 5.0, {})
    assert not fine.lacking
    assert Adequacy(0.0009, 1.0, 5.0, {}).lacking
    assert fine.chance is None


def test_each_look_at_what_is_left_counts_in_its_probability():
    """Noise alone: of five tests one is at 0.05, as one of five is every fourth time."""
    left = adequacy(base_fit(hidden(seed=1)), ())
    rarest = min(left.tests.values())
    assert len(left.tests) == 5 and 0.02 < rarest < 0.1
    assert left.probability == pytest.approx(5 * rarest)


def test_what_is_left_is_significant_where_structure_alone_says_so():
    """Random effects that differ from pose to pose hardly see what is alike at all of them."""
    found = Components(ModelForm(0.01), 1.0, 0.0, 1.0, 0.0)
    size = LeftOver(17e-6, (6e-6, 28e-6), 30e-6, True, found, 0.024)
    left = Remainder(size, something_else=0.45)
    assert not left.significant
    assert left.beside(0.5) is left
    seen = left.beside(1e-12)
    assert seen.significant
    assert seen.something_else > 0.999
    assert seen.rms == left.rms
    # p = 0.001 speaks for it by 1 / (e p ln 1/p) = 53 at most, against odds of 1 to 9
    assert left.beside(1e-3).something_else == pytest.approx(53.26 / (53.26 + 9.0), abs=1e-3)


def test_names_that_fell_and_those_beside_something_else_are_less_probable():
    odds = {NONE: 0.1, "a": 0.5, "b": 0.4}
    assert doubted(odds, (), 0.0) == odds
    less = doubted(odds, {"a"}, 0.8)
    assert less["a"] == pytest.approx(FALLEN * 0.5)
    assert less["b"] == pytest.approx((1.0 - 0.8 * FURTHER_IMPOSTOR) * 0.4)
    assert less[NONE] == 0.1


@pytest.mark.parametrize(("imitates", "winner"), [(False, 0), (True, 1)])
def test_what_explains_something_else_does_not_take_an_effects_place(imitates, winner):
    """A stronger cause beside the effect, and the cause of which the effect is an imitation."""
    reg = regression()
    X = reg.X.copy()
    if imitates:
        X[:, 2] = X[:, 3] + 0.5 * X[:, 2]
    size = 0.0 if imitates else 0.6
    rng = np.random.default_rng(3)
    y = X[:, :5] @ np.array([4.0, -3.0, size, 1.5, 0.0]) + rng.normal(size=len(X))
    reg = replace(reg, X=X, y=y)
    model = score_set(reg, reg.sums(), (0,))
    assert score_set(reg, reg.sums(), (1,)).score < model.score
    assert confirming._winner(reg, model, 0, {0}, reg.sums()) == winner


def test_a_name_wins_by_a_plausible_law_where_its_likeliest_is_beyond_belief():
    reg = regression()
    X = reg.X.copy()
    X[:, 4] = 0.1 * X[:, 2] + 0.005 * X[:, 4]
    y = X[:, [0, 1, 4]] @ np.array([4.0, -3.0, 15.0]) + np.random.default_rng(5).normal(size=len(X))
    plausible = reg.plausible.copy()
    plausible[4] = 10.0
    reg = replace(
        reg, X=X, y=y, plausible=plausible, candidates=reg.candidates[:1], columns=reg.columns[:1],
        variants=((np.array([2]), np.array([4])),), laws=((reg.laws[0][0],) * 2,),
        tied=(-1,), usual=(1,),
    )  # fmt: skip
    model = score_set(reg, reg.sums(), (0,))
    assert model.plausible and model.variants == (0,)
    assert not score_set(reg, reg.sums(), (0,), start={0: 1}, only=()).plausible
    assert confirming._winner(reg, model, 0, {0}, reg.sums()) == 0


@pytest.mark.parametrize(
    ("others", "alternatives"),
    [
        ({"lost_motion:joint_2_l": 0.4, "force_scale:sensor": 0.1}, ("lost_motion:joint_2_l",)),
        ({"lost_motion:joint_3_u": 0.4, "force_scale:sensor": 0.1}, None),  # another gear
        ({"lost_motion:joint_2_l": 0.04, "force_scale:sensor": 0.5}, None),
    ],
)
def test_drawings_that_agree_on_the_gear_confirm_it_with_the_laws_that_won(
    monkeypatch, others, alternatives
):
    robot = load_robot("motoman_sk120")
    names = [("gear_hardening", "joint_2_l"), ("lost_motion", "joint_2_l")]
    names += [("lost_motion", "joint_3_u"), ("force_scale", None)]
    candidates = [effect(robot, *name) for name in names]
    own = 1.0 - sum(others.values()) - 0.1

    def asked(regression, scored, chosen, same, *, seed):
        with_it = {candidates[e].id for e in same}
        left = {name: share for name, share in others.items() if name not in with_it}
        share = own + sum(others.values()) - sum(left.values())
        return Confirmation(5, 5, 1.0, 0.1, share, max(left.values(), default=0.0), others=left)

    monkeypatch.setattr(attribution, "confirm", asked)
    found = SimpleNamespace(regression=SimpleNamespace(candidates=candidates), scored=None)
    finding = Finding(candidates[0], (), (), Evidence(9.0, 9.0, None, np.inf, SEEN, {}))
    told = attribution._confirmed(found, 0, finding, 0)
    assert told.evidence.confirmation.holds == (alternatives is not None)
    assert told.alternatives == (alternatives or ())


def test_an_alternative_that_is_no_candidate_beside_model_form_error_is_passed_over(monkeypatch):
    """Constants of single poses were told apart from a name before, and are part of that error."""
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    monkeypatch.setattr(selection_uncertainty, "_other_laws", lambda found, place: [])
    found = SimpleNamespace(regression=SimpleNamespace(candidates=(tilt,)))
    named = Finding(tilt, ("zero_offset:tracker",), (), Evidence(9.0, 9.0, None, np.inf, SEEN, {}))
    assert list(selection_uncertainty._others(found, [named])) == []


def test_names_that_nothing_tells_apart_share_one_piece_of_evidence():
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    odds = {tilt.id: 0.5, "link_bending:link_2_l": 0.25}
    one = Finding(tilt, (), (), Evidence(2.0, 9.0, None, np.inf, SEEN, odds))
    both = replace(one, alternatives=("link_bending:link_2_l",))
    assert one.gain == pytest.approx(2.0)
    none = 0.5 * np.exp(-1.0)  # what a gain of two says of the model without it
    assert both.gain == pytest.approx(2.0 * np.log(0.75 / none))


@pytest.mark.parametrize("start", ["springs", "springs and tilt"])
def test_a_confirmed_name_is_not_lost_where_sets_lead_to_one_another(monkeypatch, start):
    """Beside what the tilt leaves nothing stands, beside what springs leave it does: an odd number
    of rounds must not decide, nor that the end without a name has the better score."""
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    finding = Finding(tilt, (), (), Evidence(9.0, 9.0, None, np.inf, SEEN, {}))

    def judged(tried, *, seed, least):
        names = (finding,) if tried.beside == "springs" else ()
        final = "springs and tilt" if names else "springs"
        return SimpleNamespace(final=final, total=tried.total), Named(names)

    def under(noise):
        total = -20.0 if noise == "springs and tilt" else 0.0
        return SimpleNamespace(beside=noise, total=total)

    monkeypatch.setattr(beside_form, "with_model_form", lambda fit: fit)
    monkeypatch.setattr(beside_form, "asked_anew", lambda fit, at: fit)
    monkeypatch.setattr(beside_form, "judged", judged)
    names = {tilt.id} if "tilt" in start else set()
    found, named = beside_form._settled(start, under, names, 0)
    assert named.findings == (finding,)
    assert found.final == "springs and tilt"


@pytest.mark.parametrize("better", [True, False])
def test_where_nothing_is_named_the_search_begins_again_beside_the_nearest(monkeypatch, better):
    """The likelier end counts: an error that holds the cause, or the cause and a smaller error."""
    tilt = effect(load_robot("motoman_sk120"), "joint_tilt", "joint_2_l")
    finding = Finding(tilt, (), (), Evidence(9.0, 9.0, None, np.inf, SEEN, {}))
    scores = {"springs": -10.0, "springs and tilt": -11.0 if better else -9.0}

    def under(noise):
        # names that do not stand made the first end the likelier by 20
        unconfirmed = -20.0 if noise == "springs" else 0.0
        return SimpleNamespace(final=noise, total=scores[noise] + unconfirmed)

    def judged(tried, *, seed, least):
        standing = SimpleNamespace(final=tried.final, total=scores[tried.final])
        return standing, Named((finding,) if tried.final != "springs" else ())

    monkeypatch.setattr(beside_form, "with_model_form", lambda fit: fit)
    monkeypatch.setattr(beside_form, "asked_anew", lambda fit, at: fit)
    monkeypatch.setattr(beside_form, "judged", judged)
    monkeypatch.setattr(beside_form, "_nearest", lambda found: tilt)
    monkeypatch.setattr(beside_form, "refit", lambda fit, effects: f"{fit} and tilt")
    monkeypatch.setattr(beside_form, "unless_imitating", lambda found, named, seed: (found, named))
    found, named = beside_form.beside_model_form("springs", under, seed=0)
    assert named.findings == ((finding,) if better else ())
    assert found.final == ("springs and tilt" if better else "springs")
    # what stood against the noise alone is in the model that the search began beside
    found, named = beside_form.beside_model_form("springs", under, names={tilt.id}, seed=0)
    assert not named.findings and found.final == "springs"
