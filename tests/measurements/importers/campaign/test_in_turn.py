"""Several markers of every pose below one another, and the joints once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, Told, import_readings
from tests.positions.arm import Arm, errors, poses, tracked, urdf

PLACES = ((0.05, -0.08, 0.12), (-0.07, 0.05, 0.10), (0.02, 0.09, 0.18))  # m, on the tool


def imported(folder: Path, count: int, markers: int, *, stray: bool = False) -> Imported:
    """Points below one another, a blank line after each pose, and a file of joints."""
    a, arm = poses(count, 5), errors(2)
    seen = []
    for place in PLACES[:markers]:
        at = Arm(**{**vars(arm), "marker": np.array(place)})
        seen.append(tracked(at.stands(a)[0]))
    x = 1e3 * np.stack(seen, axis=1)
    if stray:  # points of nothing that is rigid
        x = x + 200.0 * np.random.default_rng(1).normal(size=x.shape)
    lines = ["\n".join(" ".join(f"{v:.4f}" for v in row) for row in pose) + "\n" for pose in x]
    (folder / "points.txt").write_text("\n".join(lines), encoding="utf-8")
    table = "\n".join("\t".join(f"{v:.5f}" for v in row) for row in np.degrees(a))
    (folder / "joints.txt").write_text(table, encoding="utf-8")
    (folder / "six.urdf").write_text(urdf(), encoding="utf-8")
    robot = sk.load_robot(str(folder / "six.urdf"))
    told = Told(length="mm", angle="deg")
    return import_readings(folder / "points.txt", robot, told, joints_file=folder / "joints.txt")


@pytest.mark.parametrize("markers", [2, 3])
def test_markers_in_turn_are_told_apart(tmp_path: Path, markers: int) -> None:
    imported(tmp_path, 20, markers).write(tmp_path / "own.csv")
    data = sk.read(tmp_path / "own.csv")
    assert data.absolute is not None
    assert data.absolute.markers == tuple(f"M{k + 1}" for k in range(markers)) * 20
    assert len(data.poses) == 20 and data.n_readings == 20 * markers
    np.testing.assert_allclose(data.joints[markers], poses(20, 5)[1], atol=1e-6)


def test_points_of_nothing_rigid_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="60 points, but 20 rows of joints"):
        imported(tmp_path, 20, 3, stray=True)
