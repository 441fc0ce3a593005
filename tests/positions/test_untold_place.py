"""A tool that hangs alike at all poses: the marker along it trades against the tracker."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.measurements.placing.placing import Placing, place
from tests.positions.arm import NAMES, Array, errors, poses, tracked, write

COUNT = 40
POINT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\nmassless"


def hanging(tilt: float) -> Array:
    """(40, 6) poses whose last axis hangs straight down but for some tilt."""
    a = poses(COUNT, 3)
    a[:, 3] = 0.0
    a[:, 4] = 0.5 * np.pi - a[:, 1] - a[:, 2]
    return a + tilt * np.random.default_rng(4).normal(size=a.shape) * np.eye(6)[4]


def placed(folder: Path, a: Array) -> Placing:
    x = tracked(errors(4).stands(a)[0])
    x = x + 1e-4 * np.random.default_rng(5).normal(size=x.shape)
    path = write(folder, a, x, POINT)
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    found = place(robot, sk.read(path).with_joints(NAMES))
    assert found is not None
    return found


@pytest.mark.parametrize("tilt", [0.0, 1e-5])
def test_the_stated_place_is_kept_along_it_and_that_is_said(tilt: float, tmp_path: Path) -> None:
    found = placed(tmp_path, hanging(tilt))
    assert abs(found.marker[0]) < 0.01
    np.testing.assert_allclose(found.marker[1:], [-0.08, 0.12], atol=0.01)
    (said,) = [note for note in found.notes if "do not tell where the marker sits" in note]
    assert "along x of the tool frame" in said
    assert found.rms < 3e-3


def test_a_tool_that_tilts_enough_tells_all_of_it(tmp_path: Path) -> None:
    found = placed(tmp_path, hanging(0.3))
    np.testing.assert_allclose(found.marker, [0.05, -0.08, 0.12], atol=0.02)
    assert not [note for note in found.notes if "do not tell where the marker" in note]
