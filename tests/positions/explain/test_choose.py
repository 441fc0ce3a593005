"""What is confirmed at poses left out: each model counts as it would be fitted by itself."""

from __future__ import annotations

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.arrays import Array
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.select.choose import Chosen, by_likeliest, gain
from sk120stiff.explain.positions.select.linear import Linear


def seen(columns: Array, residual: Array, *, stated: bool) -> Linear:
    """Two candidates of one column each, (M, 2), at three numbers a reading."""
    count = np.arange(len(residual)) // 3
    return Linear(
        residual=residual,
        base=np.zeros((len(residual), 0)),
        columns=columns,
        positive=np.zeros(2, dtype=bool),
        candidates=sk.base_model(sk.load_robot("motoman_sk120")).effects[:2],
        sizes=np.ones(2),
        slices=(slice(0, 1), slice(1, 2)),
        row=count,
        fold=count % 5,
        stated=stated,
    )


def test_what_stands_in_for_a_cause_beyond_usual_sizes_only_does_not_make_it_needless() -> None:
    """The second column is the first, 100 times its usual size: it costs nothing."""
    rng = np.random.default_rng(3)
    column = rng.normal(size=60)
    columns = np.column_stack([column, (column + 1e-4 * rng.normal(size=60)) / 100.0])
    linear = seen(columns, column + 1e-3 * rng.normal(size=60), stated=False)
    assert gain(linear, (0, 1), 0).share > 0.9


def test_a_name_that_many_readings_show_is_sure_though_another_spring_may_be_there() -> None:
    """Without it the noise comes out larger than stated: each model at a noise of its own."""
    rng = np.random.default_rng(4)
    columns = rng.normal(size=(6000, 2))
    linear = seen(columns, 0.4 * columns[:, 0] + rng.normal(size=6000), stated=True)
    assert linear.noise(()) > 1.1
    assert linear.score((0,), 1.0) - linear.score((), linear.noise(())) > 300.0
    rivals, probability = Posterior(linear, (0,)).names[0]
    assert rivals == () and probability == pytest.approx(1.0)


def test_a_name_gives_way_to_one_that_is_clearly_likelier_and_to_no_equal() -> None:
    rng = np.random.default_rng(5)
    column = rng.normal(size=600)
    beside = column + 0.2 * rng.normal(size=600)
    near, same = np.column_stack([beside, column]), np.column_stack([column, 1.02 * column])
    noisy = column + 0.5 * rng.normal(size=600)
    found = by_likeliest(seen(near, noisy, stated=False), Chosen((0,), {}))
    assert found.order == (1,)
    assert by_likeliest(seen(near, noisy, stated=False), Chosen((1,), {})).order == (1,)
    # What was not confirmed does not come in again.
    assert by_likeliest(seen(near, noisy, stated=False), Chosen((0,), {1: ""})).order == (0,)
    for first in (0, 1):
        assert by_likeliest(seen(same, noisy, stated=False), Chosen((first,), {})).order == (first,)
