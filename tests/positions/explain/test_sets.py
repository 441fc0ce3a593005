"""Sets of names against sets: scores all at once, what stands instead, and what takes a place."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.explain.positions.judge import sets
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.judge.sets import WINDOW, Sets
from sk120stiff.explain.positions.judge.smooth_error import of_errors
from sk120stiff.explain.positions.select.choose import Chosen
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.explain.priors import FALLEN
from sk120stiff.robot import load_robot
from tests.positions.explain.test_linear import ROWS, linear

ROBOT = load_robot("motoman_sk120")


def shown(*sizes: float, stated: bool = True, positive: bool = False) -> Linear:
    """Four zeros of joints, of one number each."""
    zeros = tuple(effect(ROBOT, "joint_offset", joint) for joint in ROBOT.actuated[:4])
    return replace(linear(*sizes, stated=stated, positive=positive), candidates=zeros)


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("positive", [True, False])
@pytest.mark.parametrize("chosen", [(), (0,), (0, 2)])
def test_scores_all_at_once_are_those_of_each(
    chosen: tuple[int, ...], positive: bool, stated: bool
) -> None:
    """Of candidates with two columns too; where a sign rule binds, they only point the way."""
    made = shown(1.0, -0.8, 0.6, stated=stated, positive=positive)
    tilt = effect(ROBOT, "joint_tilt", ROBOT.actuated[0])
    assert len(tilt.parameters) == 2
    made = replace(made, slices=(slice(0, 1), slice(1, 2), slice(2, 4)))
    made = replace(made, candidates=(*made.candidates[:2], tilt))
    noise = 1.0 if stated else made.noise(chosen)
    found, exact = made.joined(chosen, noise)
    others = [e for e in range(3) if e not in chosen]
    assert np.isneginf(found[list(chosen)]).all()
    meant = np.array([made.score((*chosen, e), noise) for e in others])
    told = exact[others]
    assert told.all() or positive
    np.testing.assert_allclose(found[others][told], meant[told], atol=1e-8)
    if positive and 1 in others:
        assert not exact[1]  # its size is negative


def test_beside_errors_scores_all_at_once_are_those_of_each() -> None:
    made = shown(1.0, 0.8)
    at = np.linspace(0.0, 1.0, ROWS)
    smooth = np.exp(-((at[:, None] - at) ** 2) / 0.02)
    errors = of_errors(made, (np.eye(ROWS) + size * smooth for size in (0.0, 1.0, 30.0)))
    found, exact = errors.joined((0,))
    assert exact.all()
    np.testing.assert_allclose(found[1:], [errors.score((0, e)) for e in (1, 2, 3)], atol=1e-8)


def weighed(**weights: float) -> Sets:
    """Sets by the digits of their names, about 01."""
    whole = sum(weights.values())
    found = {frozenset(map(int, name[1:])): w / whole for name, w in weights.items()}
    return Sets(found, frozenset((0, 1)), 4)


def test_what_sets_hold_instead_stands_in_a_names_place() -> None:
    """2 stands where 0 lacks; 3 comes and goes whether 0 is there or not."""
    found = weighed(_01=0.6, _12=0.2, _013=0.12, _123=0.04, _1=0.001, _13=0.0002)
    assert found.in_its_place(0) == (2,)
    assert found.in_its_place(1) == ()
    often = weighed(_01=0.27, _013=0.63, _1=0.03, _13=0.07)
    assert often.in_its_place(0) == ()
    assert found.with_any((0, 2)) == pytest.approx(1.0, abs=0.002)


def test_of_two_that_stand_for_one_the_first_tells_of_both() -> None:
    assert weighed(_01=0.5, _123=0.45, _12=0.05).in_its_place(0) == (2,)
    assert weighed(_01=0.97, _12=0.03).in_its_place(0) == ()  # by 1 in 20, as everywhere


def twins(seed: int) -> Linear:
    """What 0 and 1 bring together is mostly what 2 brings alone, and that is the truth."""
    made = shown(0.0, 0.0, 3.0)
    columns = made.columns.copy()
    rng = np.random.default_rng(seed)
    apart = 0.35 * rng.normal(size=(ROWS, 2))
    both = (columns[:, [2, 2]] + columns[:, [0, 1]] * [1.0, -1.0]) / np.sqrt(2.0) + apart
    both -= made.base @ (made.base.T @ both)
    columns[:, :2] = both
    return replace(made, columns=columns)


def test_one_name_takes_the_place_of_two_that_stood_for_it() -> None:
    made = twins(3)
    posterior = Posterior(made, (0, 1))
    other = posterior.likelier(Chosen((0, 1), {}), ())
    assert other is not None and other.order == (2,)
    assert "the readings are likelier with" in other.dropped[0]
    assert posterior.sets.with_any((2,)) > 0.95
    assert posterior.likelier(Chosen((0, 1), {2: "fell"}), ()) is None
    assert posterior.likelier(Chosen((0, 1), {}), {frozenset((2,))}) is None
    assert Posterior(made, (2,)).likelier(Chosen((2,), {}), ()) is None
    assert Posterior(shown(3.0, 2.0), (0,)).likelier(Chosen((0,), {}), ()) is None  # no more names


def test_no_set_that_is_nearly_the_likeliest_is_missed() -> None:
    made = shown(0.6, 0.5, -0.4)
    noise = made.noise((0,))
    every = [each for k in range(5) for each in combinations(range(4), k)]
    score = np.array([made.score(each, noise) - len(each) * np.log(4.0) for each in every])
    near = {frozenset(every[k]) for k in np.flatnonzero(score > score.max() - WINDOW)}
    weights = Posterior(made, (0,)).sets.weights
    assert 3 < len(near) <= len(near & weights.keys())
    assert sum(weights.values()) == pytest.approx(1.0)


def test_all_that_poses_left_out_refute_are_held_back_however_many_stand_for_one_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each counts against what there is without it: all together have a fraction, not each."""
    made = shown(1.4)
    columns = made.columns.copy()
    columns[:, 1:3] = columns[:, [0]] + 0.01 * columns[:, 1:3]
    monkeypatch.setattr(sets, "confirmed", lambda *_: False)
    found = Posterior(replace(made, columns=columns), ()).sets
    alone = [found.with_any((e,)) for e in range(3)]
    assert max(alone) < 1.001 * FALLEN / (1.0 + FALLEN)
    assert max(alone) > 0.9 * FALLEN / (1.0 + FALLEN)  # and no more than that
    certain = replace(made, residual=300.0 * made.residual)  # beyond what exp() of the odds holds
    assert np.isfinite([*Posterior(certain, (1,)).sets.weights.values()]).all()


def test_what_nearly_every_set_holds_has_nothing_in_its_place() -> None:
    """What is likely besides is no rival, though the few sets without the name hold it."""
    beside = {frozenset({0, 1}): 0.925, frozenset({0}): 0.07, frozenset({1}): 0.005}
    assert Sets(beside, frozenset({0}), 2).in_its_place(0) == ()
    instead = {frozenset({0}): 0.9, frozenset({1}): 0.1}
    assert Sets(instead, frozenset({0}), 2).in_its_place(0) == (1,)
