"""What arrays hold, in one number."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import lengths_of, of_length_one


def test_a_column_of_rounding_has_no_length() -> None:
    """A sum that cancels leaves some 1e-16 in no direction: divided by its length it is noise."""
    rng = np.random.default_rng(0)
    column = rng.normal(size=50)
    nothing = (column + 0.1) - 0.1 - column
    assert 0.0 < np.linalg.norm(nothing) < 1e-14
    small = 1e-9 * rng.normal(size=50)
    columns = np.column_stack([column, nothing, small])
    lengths = lengths_of(columns)
    assert lengths[1] == 0.0
    np.testing.assert_allclose(lengths[[0, 2]], [np.linalg.norm(column), np.linalg.norm(small)])
    found = of_length_one(columns)
    np.testing.assert_allclose(np.linalg.norm(found, axis=0), [1.0, 1.0])
    np.testing.assert_allclose(found[:, 1], small / np.linalg.norm(small))
    assert lengths_of(np.zeros((5, 2))).tolist() == [0.0, 0.0]
