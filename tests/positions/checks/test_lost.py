"""Rows that say 0, 0, 0 where a tracker saw nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.words import findings
from tests.positions.arm import errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm, fit: true}\n"


@pytest.mark.parametrize("count", [1, 9])
def test_they_are_told_and_stand_in_no_number(tmp_path: Path, count: int) -> None:
    a = poses(60, 5)
    x = tracked(errors(2).stands(a)[0]) + 2e-5 * np.random.default_rng(1).normal(size=(60, 3))
    gone = np.arange(count) * 6 + 2
    x[gone] = 0.0
    data = sk.read(write(tmp_path, a, x, FIT))
    found = sk.fit(sk.base_model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Calibration)
    assert np.flatnonzero(found.wild).tolist() == gone.tolist()
    told = findings(found, data)
    (line,) = [each for each in told if "exactly 0, 0, 0" in each]
    assert ("in line 4," in line) if count == 1 else ("in lines 4, 10," in line), line
    assert found.rms < 3e-5


def test_a_campaign_of_zeros_is_refused_as_before(tmp_path: Path) -> None:
    data = sk.read(write(tmp_path, poses(20, 5), np.zeros((20, 3)), FIT))
    with pytest.raises(sk.ToolkitError):
        sk.fit(sk.base_model(sk.load_robot(data.robot, base="base", tool="tool")), data)
