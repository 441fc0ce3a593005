"""Rows of positions that were pasted twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.data_checks import without_copies
from sk120stiff.errors import ToolkitWarning
from sk120stiff.measurements import Measurements
from tests.positions.arm import NAMES, Array, errors, poses, tracked, write

A = poses(24, 3)
MARKERS = np.array([[0.20, 0.06, 0.20], [-0.05, -0.20, 0.20], [-0.15, 0.15, 0.20]])
POINT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\nmassless"


def path_of(folder: Path, *, step: float = 1e-6, poses_of: list[int] | None = None) -> Path:
    """Three markers at every pose, told in steps of so many metres."""
    which = np.arange(len(A)) if poses_of is None else np.array(poses_of)
    x, R = errors(4).stands(A)
    x = np.stack([tracked(x + R @ point) for point in MARKERS], axis=1)
    x = x + 2e-5 * np.random.default_rng(5).normal(size=x.shape)
    x = np.round(x / step) * step
    rows: Array = x[which].reshape(-1, 3)
    cells = [f"P{k},{m}" for k in range(len(which)) for m in (1, 2, 3)]
    return write(
        folder, np.repeat(A[which], 3, axis=0), rows, POINT, more=",pose,marker", cells=cells
    )


def read(path: Path) -> Measurements:
    return sk.read(path).with_joints(NAMES)


COPIED = [*range(12), 11, *range(12, 24)]


def test_a_pose_that_was_pasted_under_another_name_is_masked_and_told(tmp_path: Path) -> None:
    single, told = without_copies(read(path_of(tmp_path, poses_of=COPIED)))
    assert told is not None and told.startswith("3 rows repeat earlier ones")
    assert "(lines 38, 39, 40)" in told
    np.testing.assert_array_equal(np.flatnonzero(~single.use), [36, 37, 38])


def test_nothing_is_told_of_readings_of_their_own(tmp_path: Path) -> None:
    assert without_copies(read(path_of(tmp_path)))[1] is None


def test_readings_in_coarse_steps_may_be_alike(tmp_path: Path) -> None:
    assert without_copies(read(path_of(tmp_path, step=1e-4, poses_of=COPIED)))[1] is None


def test_explain_tells_it(tmp_path: Path) -> None:
    path = path_of(tmp_path, poses_of=COPIED)
    model = sk.Model(sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool"))
    with pytest.warns(ToolkitWarning, match="3 rows repeat earlier ones"):
        found = sk.explain(model, read(path))
    assert found is not None
