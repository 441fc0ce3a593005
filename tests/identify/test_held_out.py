"""Parts in which poses are left out: nothing of a pose on both sides, everything predicted once."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.identify import Fit, fit, held_out, pose_parts, refitted
from sk120stiff.measurements import Measurements, NoiseModel
from tests.identify.conftest import readings_of

NOISE = NoiseModel(10e-6)


@pytest.fixture(scope="module")
def readings(springs) -> Measurements:
    """23 poses, 4 loads each; two labels for one posture."""
    made = readings_of(springs, poses=23, seed=3)
    joints = made.joints.copy()
    joints[made.rows_of("p7")] = joints[made.rows_of("p2")[0]]
    return replace(made, joints=joints)


@pytest.mark.parametrize("folds", [2, 5, 10, 40])
def test_parts_are_equal_and_all_poses_are_in_one(readings, folds) -> None:
    parts = pose_parts(readings, folds=folds, seed=1)
    assert parts.shape == (23,)
    sizes = np.bincount(parts)
    assert len(sizes) == min(folds, 22)
    assert sizes.min() >= 1
    assert sizes.max() - sizes.min() <= 2  # one posture has two labels
    labels = list(readings.poses)
    assert parts[labels.index("p7")] == parts[labels.index("p2")]


def test_what_is_learned_from_never_holds_what_is_predicted(springs, readings) -> None:
    learned: list[Measurements] = []

    def learn(train: Measurements) -> list[Fit]:
        learned.append(train)
        return [fit(springs, train, noise=NOISE)]

    (error,) = held_out(readings, learn)
    assert len(learned) == error.folds == 10
    everything = {tuple(row) for row in readings.joints}
    left_out = [everything - {tuple(row) for row in train.joints} for train in learned]
    assert all(left_out)
    assert not set.intersection(*left_out)
    assert set.union(*left_out) == everything
    assert sum(len(part) for part in left_out) == len(everything)  # every posture once
    for train in learned:  # a pose is in whole or out of it
        for label in train.poses:
            assert len(train.rows_of(label)) == len(readings.rows_of(label))
    assert (error.counts == 4 * 3).all() and error.squares.shape == (23,)
    assert (error.squares > 0.0).all()


def test_a_part_that_is_not_predicted_is_an_error(springs, readings) -> None:
    """No part is passed over in silence."""
    calls = 0

    def learn(train: Measurements) -> list[Fit]:
        nonlocal calls
        calls += 1
        return [] if calls == 3 else [fit(springs, train, noise=NOISE)]

    with pytest.raises(ValueError, match="not predicted"):
        held_out(readings, learn)


def test_of_many_poses_a_fifth_is_left_out_at_once(springs) -> None:
    many = readings_of(springs, poses=30, seed=4)
    (error,) = held_out(many, refitted(springs, noise=NOISE))
    assert error.folds == 5
    (fewer,) = held_out(many.select(many.pose_index < 29), refitted(springs, noise=NOISE))
    assert fewer.folds == 10
    assert fewer.rms == pytest.approx(error.rms, rel=0.1)
