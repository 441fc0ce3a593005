"""The linear algebra of the search, held against plain least squares and dense Gaussians."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.stats import multivariate_normal

from sk120stiff.effects import effect
from sk120stiff.explain.candidates.form_rows import FormRows
from sk120stiff.explain.candidates.regression import Regression, price_of_choice
from sk120stiff.explain.candidates.sums import Solved, Sums, solve_sets
from sk120stiff.explain.select.beam import NEAR, beam_search, exchanged, in_its_place
from sk120stiff.explain.select.promises import promises
from sk120stiff.explain.select.score import (
    _Left,
    price_of_looking,
    score_set,
)
from sk120stiff.explain.select.size_prices import price_of_sizes
from sk120stiff.robot import load_robot

POSES, AXES = 12, 15


def regression(seed: int = 0, *, known: bool = True, lower: float = -np.inf) -> Regression:
    """Two base columns, three single effects, and one of twelve draws, on made-up columns."""
    rng = np.random.default_rng(seed)
    group = np.repeat(np.arange(POSES), AXES)
    offsets = np.kron(np.eye(POSES), np.ones((AXES, 1)))
    X = np.hstack([rng.normal(size=(POSES * AXES, 5)), offsets])
    y = X[:, :5] @ np.array([4.0, -3.0, 1.5, 0.0, 0.0]) + rng.normal(size=len(X))
    robot = load_robot("motoman_sk120")
    named = [effect(robot, "joint_springs", f"joint_{k}") for k in ("4_r", "5_b", "6_t")]
    zero = effect(robot, "zero_offset", poses=[str(k) for k in range(POSES)])
    columns = (np.array([2]), np.array([3]), np.array([4]), np.arange(5, 5 + POSES))
    return Regression(
        y=y,
        X=X,
        group=group,
        base=np.array([0, 1]),
        candidates=(*named, zero),
        columns=columns,
        variants=tuple((own,) for own in columns),
        laws=tuple((each,) for each in (*named, zero)),
        tied=(-1,) * len(columns),
        usual=(0,) * len(columns),
        lower=np.full(X.shape[1], lower),
        plausible=np.full(X.shape[1], 1e6),
        softness=1.0,
        springs=np.array([0, 1]),
        compliances=np.zeros(X.shape[1], dtype=bool),
        sigma_known=known,
        alpha=0.01,
        prior={},
    )


def test_sums_over_poses_are_the_whole():
    found = regression()
    sums = found.sums()
    assert np.allclose(sums.gram, found.X.T @ found.X)
    assert np.allclose(sums.moment, found.X.T @ found.y)
    twice = weighed(found, np.full(POSES, 2.0))
    assert np.allclose(twice.gram, 2.0 * sums.gram)


def test_draws_integrated_out_of_some_columns_are_those_of_all():
    sums, members, some = regression().sums(), np.arange(5, 5 + POSES), np.array([0, 3, 6])
    whole, part = sums.marginal(members, 1.5), sums.marginal(members, 1.5, some)
    pick = np.ix_(some, some)
    assert np.allclose(part.sums.gram[pick], whole.sums.gram[pick])
    assert np.allclose(part.sums.moment[some], whole.sums.moment[some])
    assert (part.price, part.sums.square) == (whole.price, whole.sums.square)
    none = sums.marginal(members, 1.5, np.zeros(0, dtype=np.intp))
    assert not none.sums.gram.any() and sums.marginal(members, 1.5).sums.gram.any()


def solved_over(found: Regression, sums: Sums, columns: np.ndarray) -> Solved:
    return solve_sets(sums, [columns], found.lower, found.plausible).each()[0]


def test_free_columns_are_least_squares():
    found = regression()
    pick = np.array([0, 1, 2])
    solved = solved_over(found, found.sums(), pick)
    values, rss, *_ = np.linalg.lstsq(found.X[:, pick], found.y, rcond=None)
    assert np.allclose(solved.values, values, rtol=1e-6)
    assert np.isclose(solved.rss, rss[0], rtol=1e-9)


def test_an_effect_pays_for_its_sizes_for_looking_and_for_its_law():
    found = regression()
    sums = found.sums()
    base, one = score_set(found, sums, ()), score_set(found, sums, (0,))
    fall = base.solved.rss - one.solved.rss
    n = POSES * AXES
    price = price_of_looking(found, n) + price_of_sizes(fall, 1, n) + price_of_choice(found, 0, 0)
    assert price_of_sizes(fall, 1, n) == pytest.approx(np.log(n))  # a strong one
    assert one.score - base.score == pytest.approx(price - fall, abs=1e-4)


@pytest.mark.parametrize("seed", range(8))
def test_bounded_columns_are_non_negative_least_squares(seed):
    found = regression(seed, lower=0.0)
    pick = np.arange(5)
    solved = solved_over(found, found.sums(), pick)
    values, norm = nnls(found.X[:, pick], found.y)
    assert np.array_equal(solved.columns, np.flatnonzero(values))
    assert np.isclose(solved.rss, norm**2, rtol=1e-6)


def test_gains_are_the_fall_of_the_misfit():
    found = regression()
    sums = found.sums()
    base = solved_over(found, sums, found.base)
    promised = promises(found, sums, base).most
    for own, promise in zip(found.columns, promised, strict=True):
        grown = np.concatenate([found.base, own])
        rss = np.linalg.lstsq(found.X[:, grown], found.y, rcond=None)[1][0]
        assert np.isclose(promise, base.rss - rss, rtol=1e-5)


def test_draws_cost_their_marginal_likelihood():
    """−2 ln p(y | v, τ) of the integrated sums, against the dense Gaussian N(X v, 1 + τ² Z Zᵀ)."""
    found = regression()
    members, size = found.columns[3], 1.5
    left = found.sums().marginal(members, size)
    v = np.array([3.9, -3.1, 1.4])
    columns = np.array([0, 1, 2])
    sums = left.sums
    misfit = sums.square - 2.0 * v @ sums.moment[columns]
    misfit += v @ sums.gram[np.ix_(columns, columns)] @ v
    Z = found.X[:, members]
    V = np.eye(len(found.y)) + size**2 * Z @ Z.T
    dense = multivariate_normal(found.X[:, columns] @ v, V).logpdf(found.y)
    constant = len(found.y) * np.log(2.0 * np.pi)
    assert np.isclose(misfit + left.price, -2.0 * dense - constant, rtol=1e-9)


@pytest.mark.parametrize("known", [True, False])
def test_the_search_finds_the_one_cause(known):
    ranked = beam_search(regression(3, known=known))
    assert ranked[0].effects == (0,)
    empty = next(model for model in ranked if not model.effects)
    assert empty.score - ranked[0].score > 50.0


def test_noise_alone_names_nothing():
    """One alarm in a hundred is allowed; sixty files of pure noise must not show four."""
    alarms = 0
    for seed in range(60):
        found = regression(seed)
        rng = np.random.default_rng(1000 + seed)
        y = found.X[:, :2] @ np.array([4.0, -3.0]) + rng.normal(size=len(found.y))
        clean = Regression(**{**vars_of(found), "y": y})
        alarms += bool(beam_search(clean)[0].effects)
    assert alarms <= 3


def test_chance_is_shared_by_all_that_are_looked_at():
    """An alarm in a hundred, of four candidates: χ² of one degree at 0.0025 each."""
    assert regression().least_fall == pytest.approx(9.1406, abs=1e-4)


def test_an_implausible_value_disqualifies():
    found = regression()
    narrow = found.plausible.copy()
    narrow[2] = 0.2
    tight = Regression(**{**vars_of(found), "plausible": narrow})
    assert not score_set(tight, tight.sums(), [0]).plausible


def test_a_soft_arm_may_have_soft_bearings():
    """Its own springs say how soft an arm is: 1 and 9 times as soft as usual are 3 times."""
    plain = regression()
    y = plain.X[:, [0, 1, 2]] @ [1.0, 9.0, 2.5]
    narrow = np.full(plain.X.shape[1], 1.0)
    for soft, hard in ((True, False), (False, True)):
        mine = {"y": y, "plausible": narrow, "compliances": np.full(plain.X.shape[1], soft)}
        made = Regression(**{**vars_of(plain), **mine})
        model = score_set(made, made.sums(), [0])
        limit = made.believed(model.solved)[model.solved.columns == 2]
        assert limit == pytest.approx(3.0 if soft else 1.0, rel=0.1)
        assert model.plausible != hard


def weighed(found: Regression, weights: np.ndarray) -> Sums:
    """Sums in which poses count so often."""
    return found.weighing(np.arange(found.X.shape[1]))(weights)


def vars_of(found: Regression) -> dict[str, object]:
    names = (
        "y", "X", "group", "base", "candidates", "columns", "variants", "laws", "tied", "usual",
        "prior", "lower", "plausible", "softness", "springs", "compliances", "sigma_known", "alpha",
    )  # fmt: skip
    return {name: getattr(found, name) for name in names}


def test_effects_settle_their_laws_one_after_the_other():
    """Two effects with three laws each: the right pair of nine is found, whatever comes first."""
    plain = regression()
    first, second = plain.columns[0], plain.columns[1]
    laws = [np.array([c]) for c in range(2, plain.X.shape[1])][:6]
    y = plain.X[:, laws[2]] @ [9.0] + plain.X[:, laws[4]] @ [7.0]
    variants = [(own,) for own in plain.columns]
    variants[0], variants[1] = (first, laws[0], laws[2]), (second, laws[3], laws[4])
    effects = [tuple([own[0]] * len(v)) for own, v in zip(plain.laws, variants, strict=True)]
    many = Regression(
        **{**vars_of(plain), "y": y, "variants": tuple(variants), "laws": tuple(effects)}
    )
    for start in ({}, {0: 1, 1: 1}, {0: 2}):
        found = score_set(many, many.sums(), [0, 1], start=start)
        assert found.by_variant == {0: 2, 1: 2}
    assert price_of_choice(many, 0, 1) > price_of_choice(many, 0, 0)


def test_what_is_implausible_by_one_law_is_looked_for_by_others():
    """The likelier law of two that are nearly alike is beyond its range: the other one is found."""
    plain = regression()
    X = plain.X.copy()
    rng = np.random.default_rng(8)
    X[:, 3] = 0.9 * X[:, 2] + 0.02 * rng.normal(size=len(X))
    narrow = plain.plausible.copy()
    narrow[2] = 1.0
    variants, laws = list(plain.variants), list(plain.laws)
    variants[0], laws[0] = (np.array([2]), np.array([3])), laws[0] * 2
    variants[1] = variants[2]  # no other effect has that column
    y = 9.0 * X[:, 2]
    found = {"y": y, "X": X, "plausible": narrow, "variants": tuple(variants), "laws": tuple(laws)}
    best = beam_search(Regression(**{**vars_of(plain), **found}))[0]
    assert best.by_variant.get(0) == 1


def test_an_effect_gives_way_to_one_of_better_evidence():
    """What stands in for the cause is exchanged for it, unless that may not be named."""
    plain = regression()
    X = plain.X.copy()
    X[:, 4] = 0.9 * X[:, 2] + 0.3 * np.random.default_rng(8).normal(size=len(X))
    found = Regression(**{**vars_of(plain), "X": X, "y": 9.0 * X[:, 2]})
    imitates = score_set(found, found.sums(), [2])
    assert exchanged(found, imitates).effects == (0,)
    assert exchanged(found, imitates, barred=[0]).effects == (2,)


def test_a_rival_is_not_judged_beside_a_law_that_suits_another():
    """A strong effect by its second law and an imitation explain what it and the cause do."""
    plain = regression()
    X = plain.X.copy()
    usual, other, cause, imitation = 2, 3, 4, 5
    X[:, other] = X[:, usual] + 0.3 * X[:, other]
    y = 40.0 * X[:, usual] + 9.0 * X[:, cause]
    X[:, imitation] = (y - 40.0 * X[:, other]) / 9.0
    columns = ((usual, other), (cause,), (imitation,))
    variants = tuple(tuple(np.array([c]) for c in laws) for laws in columns)
    laws = tuple((own[0],) * len(mine) for own, mine in zip(plain.laws, variants, strict=False))
    few = {"candidates": plain.candidates[:3], "columns": tuple(v[0][:1] for v in variants)}
    made = {
        "y": y,
        "X": X,
        "variants": variants,
        "laws": laws,
        "tied": (-1,) * 3,
        "usual": (0,) * 3,
    }
    found = Regression(**{**vars_of(plain), **few, **made})
    sums = found.sums()
    model = score_set(found, sums, [0, 2], start={0: 1}, only=())
    without = score_set(found, sums, [0], start={0: 1}, only=())
    beside_it = score_set(found, sums, [0, 1], start={0: 1}, only=())
    assert beside_it.score > model.score + 2 * NEAR
    (rival,) = (m for e, m in in_its_place(found, model, without, 2) if e == 1)
    assert rival.by_variant == {0: 0, 1: 0} and rival.score < model.score + 1.0


def test_sums_of_some_columns_score_their_models_as_all_do():
    found = beside_form(0.5)
    twice = np.full(found.poses, 2.0)
    twice[0] = 0.0
    columns = np.array([0, 1, 3])
    some, every = found.weighing(columns)(twice), weighed(found, twice)
    assert np.array_equal(np.flatnonzero(some.moment), columns)
    assert score_set(found, some, [1]).score == pytest.approx(score_set(found, every, [1]).score)
    assert score_set(found, some, []).score == pytest.approx(score_set(found, every, []).score)


def beside_form(share: float) -> Regression:
    """The same readings; in the first two axes of every three model-form error outweighs noise."""
    plain = regression()
    rows = np.arange(len(plain.y)) % 3 < 2
    form = FormRows(plain.y[rows], plain.X[rows], plain.group[rows], share)
    return Regression(**{**vars_of(plain), "form": form})


@pytest.mark.parametrize("pick", [[0, 1], [0, 1, 2]])
def test_every_model_has_its_own_size_of_model_form_error(pick):
    """The likeliest variance of the rows that it rules, beside σ as stated in the others."""
    found = beside_form(0.01)
    columns = np.array(pick)
    weights = np.ones(POSES)
    weights[0] = 0.0  # as in a fold
    sums = weighed(found, weights)
    solved = solved_over(found, sums, columns)
    rest = (found.y - found.X[:, columns] @ solved.values)[found.group > 0]
    own = np.arange(len(found.y))[found.group > 0] % 3 < 2
    likeliest = min(
        own.sum() * np.log(size) + (rest[own] ** 2).sum() / size
        for size in np.mean(rest[own] ** 2) * np.linspace(0.9, 1.1, 201)
    )
    expected = likeliest + (rest[~own] ** 2).sum()
    assert _Left.by(found, sums, solved).deviance(found) == pytest.approx(expected, rel=1e-6)


def test_no_model_leaves_less_than_the_noise():
    found = beside_form(1e6)
    solved = solved_over(found, found.sums(), np.arange(5))
    assert found.form is not None and found.form.noise_share == 1e6
    rows = len(found.form.y)
    left = found.sums().form.left_by(solved)
    expected = solved.rss - left + left / 1e6 + rows * np.log(1e6)
    assert _Left.by(found, found.sums(), solved).deviance(found) == pytest.approx(expected)
