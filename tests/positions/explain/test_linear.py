"""Evidence, held-out gaps and confirmation of causes of positions, on made-up columns."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import multivariate_normal

from sk120stiff.effects import effect
from sk120stiff.explain.positions.judge import sets
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.select.choose import (
    BEYOND_DOUBT,
    CLEAR,
    SHARE,
    SURE,
    SURE_OF_USUAL,
    USUAL,
    Gain,
    _backward,
    _next,
    confirmed,
    gain,
)
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.priors import FALLEN
from sk120stiff.identify.positions.solve.gauss_newton import gauss_newton
from sk120stiff.robot import load_robot

ROWS, FOLDS = 60, 5
NAMES = ("reading_scale", "reading_rotation", "force_scale", "force_bias")


def linear(
    *sizes: float, stated: bool = True, sigma: float = 1.0, positive: bool = False
) -> Linear:
    """Two base columns and four candidates of one column each, across the base; true `sizes`."""
    rng = np.random.default_rng(4)
    robot = load_robot("motoman_sk120")
    base, columns = np.split(np.linalg.qr(rng.normal(size=(ROWS, 6)))[0], [2], axis=1)
    columns = 8.0 * columns
    truth = np.resize([*sizes, 0.0, 0.0, 0.0, 0.0], 4)
    row = np.repeat(np.arange(ROWS // 3), 3)
    return Linear(
        residual=base @ [20.0, -15.0] + columns @ truth + sigma * rng.normal(size=ROWS),
        base=base,
        columns=columns,
        positive=np.full(4, positive),
        sizes=np.ones(4),
        candidates=tuple(effect(robot, name) for name in NAMES),
        slices=tuple(slice(k, k + 1) for k in range(4)),
        row=row,
        fold=row % FOLDS,
        stated=stated,
    )


def test_a_score_is_the_evidence_of_a_dense_gaussian():
    """Readings with noise one and usual sizes one, seen across the base."""
    made = linear(1.0, -0.5)
    across = np.linalg.svd(made.base)[0][:, 2:]  # (ROWS, ROWS - 2)
    y = across.T @ made.residual

    def evidence(chosen):
        A = across.T @ made.columns[:, list(chosen)]
        return multivariate_normal(np.zeros(len(y)), np.eye(len(y)) + A @ A.T).logpdf(y)

    for chosen in [(0,), (1, 2), (0, 1, 2, 3)]:
        found = made.score(chosen, 1.0) - made.score((), 1.0)
        assert found == pytest.approx(evidence(chosen) - evidence(()), abs=1e-6)


def test_poses_left_out_take_no_part_in_the_fit_that_is_held_against_them():
    made = linear(1.0, -0.5)
    gap = made.gap((0, 1), 1.0, held_out=True)
    A = np.column_stack([made.base, made.columns[:, :2]])
    prior = np.diag([0.0, 0.0, 1.0, 1.0])
    for f in range(FOLDS):
        test = made.fold == f
        seen, y = A[~test], made.residual[~test]
        x = np.linalg.solve(seen.T @ seen + prior, seen.T @ y)
        assert np.allclose(gap[test], made.residual[test] - A[test] @ x, atol=1e-8)


def test_parts_that_would_have_to_be_softer_than_rigid_are_rigid():
    made = linear(1.0, -1.0, positive=True)
    found = made.solved((0, 1), 1.0)
    A = np.column_stack([made.base, made.columns[:, :2]])
    padded = np.concatenate([A, np.diag([0.0, 0.0, 1.0, 1.0])])
    low = [-np.inf, -np.inf, 0.0, 0.0]
    best = lsq_linear(padded, np.append(made.residual, np.zeros(4)), (low, np.inf)).x
    assert best[3] == pytest.approx(0.0, abs=1e-9)
    assert found.pick.tolist() == [0, 1, 2]
    assert np.allclose(found.x, best[:3], atol=1e-6)


def test_what_is_left_counts_as_no_less_than_the_stated_noise():
    assert linear(1.0, sigma=0.2).noise((0,)) == 1.0
    assert linear(1.0, sigma=0.2, stated=False).noise((0,)) == pytest.approx(0.04, rel=0.4)
    assert linear(1.0, sigma=3.0).noise((0,)) == pytest.approx(9.0, rel=0.4)


def test_a_gain_is_what_the_gap_falls_by_at_poses_left_out():
    made = linear(1.0, -0.5)
    found = gain(made, (0, 1, 2), 0)
    after, before = (
        np.linalg.norm(made.gap(c, made.noise(c), held_out=True)) for c in ((0, 1, 2), (1, 2))
    )
    assert found.share == pytest.approx(1.0 - after / before)
    assert gain(made, (0, 1, 2), 2).share < 0.0 < found.share  # a fit would fall for both


@pytest.mark.parametrize(
    ("gained", "sure"),
    [
        (Gain(2 * SHARE, 2 * SURE, 5), True),
        (Gain(0.5 * SHARE, 2 * SURE, 5), False),
        (Gain(2 * SHARE, 0.5 * SURE, 5), False),
        (Gain(2 * SHARE, 2 * SURE, 3), False),
        (Gain(2 * SHARE, 0.5 * SURE, 3, expected=True), True),
        (Gain(2 * SHARE, 0.5 * SURE_OF_USUAL, 3, expected=True), False),
        (Gain(2 * SHARE, 0.5 * SURE, 4, evidence=2.0 * BEYOND_DOUBT), True),
        (Gain(2 * SHARE, 0.5 * SURE, 3, evidence=2.0 * BEYOND_DOUBT), False),
    ],
)
def test_a_cause_is_confirmed_by_its_size_its_doubt_and_most_parts(gained, sure):
    assert confirmed(gained, linear()) is sure


def test_what_every_arm_has_is_given_up_at_the_price_at_which_it_joined():
    """Between the two prices a spring stays, and a misread scale goes."""
    least = CLEAR + np.log(4.0)
    spring = effect(load_robot("motoman_sk120"), "joint_springs", "joint_2_l")
    for size in np.linspace(0.3, 0.8, 26):
        made = linear(size, 3.0)
        noise = made.noise((0, 1))
        brings = made.score((0, 1), noise) - made.score((1,), noise)
        if least - USUAL < brings < least:
            break
    assert _backward(made, (0, 1), least) == (1,)
    usual = replace(made, candidates=(spring, *made.candidates[1:]))
    assert _backward(usual, (0, 1), least) == (0, 1)


def test_a_gain_knows_its_evidence_and_what_every_arm_has():
    made = linear(1.0, -0.5)
    found, noise = gain(made, (0, 1), 0), made.noise((0, 1))
    assert found.evidence == pytest.approx(made.score((0, 1), noise) - made.score((1,), noise))
    spring = effect(load_robot("motoman_sk120"), "joint_springs", "joint_2_l")
    usual = replace(made, candidates=(spring, *made.candidates[1:]))
    assert gain(usual, (0, 1), 0).expected and not found.expected


def test_another_frame_that_shows_alike_stands_beside_a_frame():
    """Where other frames are off none is exact, and which of two is off is another question."""
    robot, made = load_robot("motoman_sk120"), linear(2.0, 3.0)
    joints = robot.actuated[:3]
    frames = tuple(effect(robot, "joint_frame", where) for where in joints)
    alike = made.columns.copy()
    alike[:, 2] = alike[:, 0] + 0.02 * alike[:, 2]
    made = replace(made, columns=alike, candidates=(*frames, made.candidates[3]))
    found = Posterior(made, (0, 1))
    rivals, probability = found.names[0]
    assert rivals == (2,) and probability > 0.99
    told = found.standing(0)
    assert told[frames[0].id] == pytest.approx(told[frames[2].id], abs=0.3)
    assert found.names[1][0] == ()


def test_a_cause_joins_by_more_evidence_the_more_were_looked_at():
    """Odds of e³ are asked of each, beyond those of one among four."""
    bar = CLEAR + np.log(4.0)
    for size in np.linspace(0.2, 1.2, 41):
        made = linear(size)
        noise = made.noise(())
        brought = max(made.score((e,), noise) for e in range(4)) - made.score((), noise)
        assert bool(_next(made, (), set(), at_once=False)) is bool(brought >= bar)


def test_a_name_is_as_probable_as_the_sets_that_hold_it():
    """All sixteen sets of four candidates, each name at odds of one to four before it is read."""
    made = linear(0.8)
    noise = made.noise((0,))
    every = [each for k in range(5) for each in combinations(range(4), k)]
    weight = np.array([made.score(each, noise) - len(each) * np.log(4.0) for each in every])
    weight = np.exp(weight - weight.max())
    holds = np.array([0 in each for each in every])
    meant = float(weight[holds].sum() / weight.sum())
    assert 0.9 < meant < 0.999
    rivals, probability = Posterior(made, (0,)).names[0]
    assert rivals == () and probability == pytest.approx(meant, rel=1e-5)


def test_geometry_is_drawn_to_where_its_prior_stands():
    """‖J x − y‖² + ‖(x − c) / s‖² of a linear problem has its minimum in closed form."""
    rng = np.random.default_rng(2)
    J, y = rng.normal(size=(9, 3)), rng.normal(size=9)
    span, centre = np.array([0.5, 1.0, 2.0]), np.array([1.0, -2.0, 3.0])
    weight = np.diag(span**-2.0)
    best = np.linalg.solve(J.T @ J + weight, J.T @ y + weight @ centre)
    free = (np.full(3, -np.inf), np.full(3, np.inf))
    found = gauss_newton(lambda x: (J @ x - y, J), np.zeros(3), free, span, centre)
    assert np.allclose(found.x, best, atol=1e-2)


@pytest.mark.parametrize("borne_out", [True, False])
def test_a_rival_that_poses_left_out_refute_is_less_likely_than_the_name_that_they_bear_out(
    monkeypatch, borne_out
):
    """A few readings far from all others make evidence of a column that is large there alone."""
    made = linear(1.2, 0.3)
    columns = made.columns.copy()
    columns[:, 1] += 4.0 * columns[:, 0]  # all of the truth
    made = replace(made, columns=columns)
    noise = made.noise((0,))
    assert made.score((1,), noise) > made.score((0,), noise)
    monkeypatch.setattr(sets, "confirmed", lambda gained, made: borne_out)
    found = Posterior(made, (0,))
    told = found.standing(0)
    own, rival = (told[made.candidates[e].id] for e in (0, 1))
    assert (rival > own) == borne_out
    if not borne_out:
        at_work = found.sets.with_any((1,))
        assert at_work / (1.0 - at_work) == pytest.approx(FALLEN, rel=1e-5)
