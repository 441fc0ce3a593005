"""What the sizes of an effect's parameters cost, with values that may lie on their bound."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.special import comb

from sk120stiff.explain.candidates.regression import Regression
from sk120stiff.explain.candidates.sums import solve_sets
from sk120stiff.explain.select.size_prices import _Held, price_of_sizes, prices_of_sizes
from tests.explain.test_regression import regression

PARTS = np.array([2, 3, 4])


def priced(found: Regression) -> float:
    """Price of one effect of three columns beside a base of two."""
    sums = found.sums()
    solved = solve_sets(sums, [np.arange(5)], found.lower, found.plausible)
    return float(prices_of_sizes(found, sums, solved, [[PARTS]])[0])


def misfit(found: Regression, columns: list[int]) -> float:
    return float(np.linalg.lstsq(found.X[:, columns], found.y, rcond=None)[1][0])


def positive(weak: float, *, known: bool = True) -> Regression:
    """Three positive values of one effect that go together, two of them hardly seen."""
    found = regression(known=known)
    rng = np.random.default_rng(5)
    X = found.X.copy()
    X[:, 3] += 0.6 * X[:, 4]
    y = X[:, :5] @ np.array([4.0, 3.0, 0.5, weak, weak]) + rng.normal(size=len(X))
    return replace(found, X=X, y=y, lower=np.zeros(X.shape[1]))


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("weak", [0.1, 0.15, 0.2, 0.3, 1.5])
def test_a_value_is_held_at_zero_where_that_is_cheaper(weak: float, known: bool):
    found = positive(weak, known=known)
    whole, base = misfit(found, [0, 1, 2, 3, 4]), misfit(found, [0, 1])
    rows = len(found.y)
    unit = 1.0 if known else whole / rows
    ways = [price_of_sizes((base - whole) / unit, 3, rows)]
    for kept in (1, 2):  # of each number the best choice, which is the greedy one here
        left = min(misfit(found, [0, 1, *own]) for own in combinations((2, 3, 4), kept))
        price = price_of_sizes((base - left) / unit, kept, rows)
        ways.append((left - whole) / unit + price + 2.0 * np.log(comb(3, kept)))
    assert priced(found) == pytest.approx(min(ways), abs=1e-4)
    if weak == 1.5:
        assert priced(found) == pytest.approx(ways[0], abs=1e-4)


def test_values_without_a_bound_are_priced_as_they_are():
    found = positive(0.1)
    free = replace(found, lower=np.full(found.X.shape[1], -np.inf))
    gain = misfit(free, [0, 1]) - misfit(free, [0, 1, 2, 3, 4])
    assert priced(free) == pytest.approx(float(price_of_sizes(gain, 3, len(free.y))), abs=1e-4)
    assert priced(found) < priced(free)


def test_a_hair_above_zero_costs_as_much_as_zero_but_for_the_choice():
    found = positive(0.0)
    noise = found.y - found.X[:, :5] @ np.array([4.0, 3.0, 2.0, 0.0, 0.0])
    away = noise - found.X[:, :5] @ np.linalg.lstsq(found.X[:, :5], noise, rcond=None)[0]
    prices = []
    for hair in (-1e-3, 1e-3):  # just beyond the bound and just within
        y = found.X[:, :5] @ np.array([4.0, 3.0, 2.0, hair, 1.0]) + away
        prices.append(priced(replace(found, y=y)))
    assert prices[1] - prices[0] == pytest.approx(2.0 * np.log(3.0), abs=0.05)


def test_growth_is_that_of_refits_one_after_the_other():
    rng = np.random.default_rng(2)
    X = rng.normal(size=(60, 5)) @ rng.normal(size=(5, 5))
    values = np.linalg.lstsq(X, rng.normal(size=60), rcond=None)[0]
    y, variance, total = X @ values, 2.5, 0.0
    ways, kept = _Held(np.linalg.inv(X.T @ X), values, variance), [0, 1, 2, 3, 4]
    for place in (3, 1, 4):
        kept.remove(place)
        total += variance * ways.growth(place)
        ways.hold(place)
        assert total == pytest.approx(np.linalg.lstsq(X[:, kept], y, rcond=None)[1][0], rel=1e-8)


def test_two_effects_that_do_each_others_work_are_not_both_spared():
    rng = np.random.default_rng(7)
    found = regression()
    X = found.X.copy()
    X[:, 5] = X[:, 3] + 0.3 * rng.normal(size=len(X))
    noise = rng.normal(size=len(X))
    noise -= X[:, :6] @ np.linalg.lstsq(X[:, :6], noise, rcond=None)[0]
    y = X[:, :6] @ np.array([4.0, 3.0, 2.0, 0.2, 2.0, 0.2]) + noise
    both = replace(found, X=X, y=y, lower=np.zeros(X.shape[1]))
    whole = misfit(both, list(range(6)))
    sums = both.sums()
    solved = solve_sets(sums, [np.arange(6)], both.lower, both.plausible)
    assert solved.moves.all()
    for place in (3, 5):  # each alone is nearly for nothing, both together are not
        assert misfit(both, [k for k in range(6) if k != place]) - whole < 4.0
    assert misfit(both, [0, 1, 2, 4]) - whole > 8.0
    parts = [np.array([2, 3]), np.array([4, 5])]
    rows, prices = len(y), []
    for held in ((), (3,), (5,), (3, 5)):
        left = misfit(both, [k for k in range(6) if k not in held])
        own = [[k for k in part if k not in held] for part in parts]
        price = left - whole + 2.0 * np.log(2.0) * len(held)
        for mine in own:
            alone = misfit(both, [0, 1]) - misfit(both, [0, 1, *mine])
            price += float(price_of_sizes(alone, len(mine), rows))
        prices.append(price)
    # not to the digit: a gain is counted as that of the values found, not as that of a refit alone
    found_price = float(prices_of_sizes(both, sums, solved, [parts])[0])
    assert found_price == pytest.approx(min(prices), abs=1.0)
