"""Shares where nothing but the gap could tell the noise: of the gap itself, and that is said."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.explain import Localisation, localise, where_sentences
from sk120stiff.identify import Fit
from tests.explain.readings import base_fit, hidden
from tests.hidden.generator.causes_elastic import JointTilt

TILT = JointTilt("joint_3_u", {"first": 4e-7, "second": 4e-7})


@pytest.fixture(scope="module")
def fitted() -> Fit:
    """One load at each of 30 poses, and no word about the noise."""
    return base_fit(hidden(TILT, poses=30, loads=1, stated=False), noise=None)


@pytest.fixture(scope="module")
def found(fitted: Fit) -> Localisation:
    return localise(fitted)


def test_no_noise_is_made_up(found) -> None:
    assert found.noise_from == "unknown"
    assert found.noise is None
    assert {pose.noise for pose in found.poses} == {level.noise for level in found.levels} == {None}
    text = " ".join(where_sentences(found))
    assert "Nothing tells how large the noise is" in text
    assert "exceeds the noise" not in text


def test_poses_stand_in_the_order_of_their_gaps(fitted, found) -> None:
    square = (fitted.gap**2).sum(axis=1)
    share = dict(zip(fitted.problem.load_cases.poses, square / square.sum(), strict=True))
    assert {p.label: p.share for p in found.poses} == pytest.approx(share)
    worst = max(found.poses, key=lambda pose: pose.share)
    assert worst.share > 2.0 / 30
    assert f"{worst.label}, carries" in " ".join(where_sentences(found)) or (
        f"Pose {worst.label} stands out" in " ".join(where_sentences(found))
    )


def test_directions_are_shares_of_the_gap(fitted, found) -> None:
    per_axis = (fitted.gap**2).sum(axis=0)
    world = [d.share for d in found.directions if d.axes == "world"]
    assert world == pytest.approx(list(per_axis / per_axis.sum()))
    assert max(d.share for d in found.directions) < 0.97


def test_not_every_suspect_takes_all(found) -> None:
    shares = np.array([s.explained for s in found.suspects])
    assert shares[0] > 0.9  # the tilting bearing, with noise a few per cent of the gap
    assert (shares > 0.98).sum() <= 2
    assert np.median(shares) < 0.5


def test_a_pose_that_is_off_stands_out() -> None:
    readings = hidden(poses=30, loads=1, stated=False)
    assert readings.displacement is not None
    off = np.zeros_like(readings.displacement)
    off[4, 0] = 3e-4
    found = localise(base_fit(replace(readings, displacement=readings.displacement + off), None))
    worst = max(found.poses, key=lambda pose: pose.share)
    assert worst.label == readings.pose[4]
    assert worst.probability < 1e-3
    assert sum(pose.probability < 0.01 for pose in found.poses) == 1


def test_a_stated_noise_that_makes_most_of_the_gap_is_no_denominator() -> None:
    """A cause that hides in the noise: its share is of the gap, and small."""
    weak = JointTilt("joint_3_u", {"first": 2.5e-8, "second": 2.5e-8})
    found = localise(base_fit(hidden(weak)))
    assert found.noise_from == "stated"
    assert found.whole == "gap"
    assert max(s.explained for s in found.suspects) < 0.3
    assert all(abs(pose.share) <= 1.0 for pose in found.poses)
