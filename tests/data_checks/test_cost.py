"""Many readings and many joints are searched in bounded work: a suite that hangs is a failure."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.data_checks import find_slip
from sk120stiff.measurements import Measurements
from tests.attacks.loads import long_chain
from tests.data_checks.random_arms import random_arm
from tests.data_checks.readings import ARMS, joints_times, spoilt

pytestmark = pytest.mark.timeout(120)  # seconds at most, where milliseconds are usual


@pytest.mark.parametrize("count", [100, 2000, 50_000])
def test_a_slip_is_found_among_many_readings(count: int) -> None:
    """Every reading at a pose of its own, a slip in them: the search goes twice over all of it."""
    data = many(count)
    known = ARMS["sk120"]()
    found = find_slip(known.robot, joints_times(data, 1, -1.0))
    assert found is not None and "joint_2_l" in found.said


@pytest.mark.parametrize(
    ("slip", "said"),
    [("joints shifted,-2", "2 rows too high"),
     ("readings reversed", "reverse order"), ("", None)],
)  # fmt: skip
def test_rows_that_moved_are_found_among_very_many(slip: str, said: str | None) -> None:
    """Only stretches of a large file are looked at, zero readings and masked rows among them."""
    known = ARMS["sk120"]()
    data = many(30_001)
    use = data.use.copy()
    use[1000:9000:3] = False
    data = replace(data, use=use)
    joints, _, shift = slip.partition(" shifted,")
    if joints == "joints":
        data = replace(data, joints=np.roll(data.joints, int(shift), axis=0))
    elif slip:
        data = spoilt(replace(known, readings=data), slip)
    found = find_slip(known.robot, data)
    assert (found is None) if said is None else (found is not None and said in found.said)


def test_nonsense_from_an_arm_of_many_joints_comes_to_an_end() -> None:
    """The signs of sixteen joints are 65 536 conventions: they are not gone through."""
    known = random_arm(load_robot(long_chain(16)), 4)
    noise = np.random.default_rng(2).normal(0.0, 1e-3, known.readings.wrench[:, :3].shape)
    assert find_slip(known.robot, replace(known.readings, displacement=noise)) is None


def many(count: int) -> Measurements:
    known = ARMS["sk120"]()
    rows = np.resize(np.arange(known.readings.n_readings), count)
    data = replace(known.readings.select(rows), order=None, zero_order=None, zero="separate")
    nudge = np.random.default_rng(0).uniform(-1e-4, 1e-4, data.joints.shape)
    return replace(
        data,
        pose=tuple(str(k) for k in range(count)),
        joints=data.joints + nudge,
        zero_group=np.arange(count),
    )
