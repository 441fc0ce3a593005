"""The search is linear in the readings: under a second for a hundred, under five for 2000."""

import time
from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.slips import find_slip
from tests.slips.readings import ARMS, joints_times

MOST = {100: 1.0, 2000: 5.0}  # s of processor time


@pytest.mark.parametrize("count", MOST)
def test_the_search_takes_little_time(count: int) -> None:
    """Every reading at a pose of its own, a slip in them: the search goes twice over all of it."""
    known = ARMS["sk120"]()
    rows = np.resize(np.arange(known.readings.n_readings), count)
    data = replace(known.readings.select(rows), order=None, zero_order=None, zero="separate")
    nudge = np.random.default_rng(0).uniform(-1e-4, 1e-4, data.joints.shape)
    data = replace(
        data,
        pose=tuple(str(k) for k in range(count)),
        joints=data.joints + nudge,
        zero_group=np.arange(count),
    )
    find_slip(known.robot, data.select(np.arange(20)))  # what is loaded once
    started = time.process_time()
    found = find_slip(known.robot, joints_times(data, 1, -1.0))
    assert time.process_time() - started < MOST[count]
    assert found is not None and "joint_2_l" in found.said
