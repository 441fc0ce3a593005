"""What predictions count for what a calibration lacks, where nobody stated the noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.residuals.remainder import (
    left_beyond_noise,
    remainder_at_other_poses,
)
from tests.positions.arm import poses, tracked, write
from tests.positions.test_forms import _with
from tests.positions.test_payload_place import COMPLIANCE, FIT, robot_of

SIGMA = 2e-5


def calibrated(folder: Path, times: int) -> Calibration:
    """Clean positions, each read so many times; nobody states their noise."""
    a = np.repeat(poses(60, 4), times, axis=0)
    arm = _with()
    arm.compliance, arm.shift, arm.turn = COMPLIANCE, np.zeros((6, 3)), np.zeros((6, 3))
    x = tracked(arm.stands(a)[0]) + SIGMA * np.random.default_rng(3).normal(size=(len(a), 3))
    cells = [f"P{k // times}" for k in range(len(a))]
    path = write(folder, a, x, FIT, more=",pose", cells=cells)
    model = sk.base_model(robot_of(path))
    assert model is not None
    found = sk.fit(model, sk.read(path))
    assert isinstance(found, Calibration)
    return found


def test_a_gap_that_may_be_noise_or_what_is_missing_counts_for_what_is_missing(
    tmp_path: Path,
) -> None:
    """Intervals of camera data held three quarters of what they should."""
    found = calibrated(tmp_path, 1)
    assert left_beyond_noise(found) is None
    left = remainder_at_other_poses(found)
    assert left is not None and not left.significant
    assert (left.rms == 0.0).all() and left.probability == 1.0
    np.testing.assert_allclose(left.upper, SIGMA, rtol=0.15)


def test_repeats_tell_that_the_gap_is_noise(tmp_path: Path) -> None:
    found = calibrated(tmp_path, 4)
    assert left_beyond_noise(found) is None
    left = remainder_at_other_poses(found)
    assert left is not None and not left.significant
    assert (left.upper < 0.6 * SIGMA).all()
    assert left.probability == pytest.approx(0.5, abs=0.45)
