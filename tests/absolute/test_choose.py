"""What is confirmed at poses left out: each model counts as it would be fitted by itself."""

from __future__ import annotations

import numpy as np

import sk120stiff as sk
from sk120stiff.explain.absolute.choose import gain
from sk120stiff.explain.absolute.linear import Linear


def test_what_stands_in_for_a_cause_beyond_usual_sizes_only_does_not_make_it_needless() -> None:
    """The second column is the first, 100 times its usual size: it costs nothing."""
    rng = np.random.default_rng(3)
    column = rng.normal(size=60)
    columns = np.column_stack([column, (column + 1e-4 * rng.normal(size=60)) / 100.0])
    linear = Linear(
        residual=column + 1e-3 * rng.normal(size=60),
        base=np.zeros((60, 0)),
        columns=columns,
        positive=np.zeros(2, dtype=bool),
        candidates=sk.base_model(sk.load_robot("motoman_sk120")).effects[:2],
        sizes=np.ones(2),
        slices=(slice(0, 1), slice(1, 2)),
        row=np.arange(60) // 3,
        fold=np.arange(60) // 3 % 5,
        stated=False,
    )
    assert gain(linear, (0, 1), 0).share > 0.9
