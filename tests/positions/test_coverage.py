"""A smaller run of scripts/14_positions_coverage.py: errors near the bound, intervals that hold."""

import numpy as np

from tests.positions.coverage import campaigns


def test_errors_are_near_the_bound_and_intervals_hold() -> None:
    outcomes = campaigns(8, 1, 3)
    assert {"j2", "j3"} <= {o.joint for o in outcomes} and len(outcomes) >= 16
    assert 0.5 < np.sqrt(np.mean([o.error**2 for o in outcomes])) < 1.5
    assert sum(not o.held for o in outcomes) <= 4
