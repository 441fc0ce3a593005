"""Distances alone, of fixed points in axes that nobody knows: a ball bar, a laser to points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.words import ABOUT, unseen
from sk120stiff.model import predict
from sk120stiff.model.predicted import prediction_table
from tests.positions.arm import NAMES, Array, errors, poses, tracked, write
from tests.positions.test_forms import FINE, FINELY, agrees, calibrated, rows

A = poses(70, 2)
POINTS = np.array([[2.0, 1, 0.5], [1.5, -2, 0], [0, 2.5, 1]])
UNKNOWN = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
X = errors(1).stands(A)[0]


def measured(folder: Path, points: Array, settings: str = UNKNOWN, *, a: Array = A,
             length: float = 1e3, place: float = 1.0, wild: int = 0) -> Path:  # fmt: skip
    """Distances to the points (F, 3) in turn, points stated in the instrument's axes."""
    rng = np.random.default_rng(8)
    at = points[np.arange(len(a)) % len(points)]
    far = np.linalg.norm(X[: len(a)] - at, axis=1) + FINE * rng.normal(size=len(a))
    far[:wild] += 0.05
    cells = rows(np.column_stack([length * far, place * tracked(at)]))
    nothing = np.full((len(a), 3), np.nan)
    return write(
        folder, a, nothing, settings + FINELY, more=",l[mm],ax[m],ay[m],az[m]", cells=cells
    )


@pytest.mark.parametrize("count", [3, 1])
def test_distances_in_unknown_axes_give_the_springs(count: int, tmp_path: Path) -> None:
    found = calibrated(measured(tmp_path, POINTS[:count], wild=1))
    agrees(found)
    assert np.flatnonzero(found.wild).tolist() == [0]
    marker = [found.model.parameter(f"tool_offset:tool.offset_{axis}").value for axis in "xyz"]
    assert marker == pytest.approx([0.05, -0.08, 0.12], abs=0.01)
    frame = [why for name, why in unseen(found).items() if name.startswith("tracker_frame")]
    assert frame == ([] if count == 3 else [ABOUT] * 6)
    assert any("fixed point" in note for note in found.notes) == (count == 1)


@pytest.mark.parametrize(
    ("spoilt", "said"),
    [
        ({"length": 1.0}, "distances look 1000 times too small"),
        ({"place": 1e3}, "places of the fixed points look 1000 times"),
        ({"a": np.radians(A)}, "look like radians, not degrees"),
        ({"a": A[::-1]}, "rows of joints and distances belong together"),
        ({"a": A[:12]}, "fewer than 6 distances to each fixed point"),
        (
            {"settings": "point: {xyz: [50, -80, 120], unit: mm}\n"},
            "(?s)not where ax, ay, az state them.*frame: unknown",
        ),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(
    spoilt: dict[str, Any], said: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said):
        calibrated(measured(tmp_path, POINTS, **spoilt))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_turn_about_one_point_or_two_changes_no_distance(count: int, tmp_path: Path) -> None:
    """As was said, and not with three."""
    found = calibrated(measured(tmp_path, POINTS[:count]))
    names, values = found.model.names, found.model.values.copy()
    frame = [names.index(f"tracker_frame:tracker.{k}") for k in ("x", "y", "z", "rx", "ry", "rz")]
    fixed = tracked(POINTS[:count])
    axis = np.array([0.6, 0.0, 0.8]) if count == 1 else fixed[1] - fixed[0]
    turn = Rotation.from_rotvec(0.1 * axis / np.linalg.norm(axis))
    before = found.problem.channel_gap(values)[0]
    values[frame[:3]] = fixed[0] + turn.apply(values[frame[:3]] - fixed[0])
    values[frame[3:]] = (turn * Rotation.from_rotvec(values[frame[3:]])).as_rotvec()
    change = np.abs(found.problem.channel_gap(values)[0] - before).max()
    assert change < 1e-8 if count < 3 else change > 1e-2


def test_a_prediction_tells_the_gap_of_wires(tmp_path: Path) -> None:
    path = measured(tmp_path, POINTS)
    found, data = calibrated(path), sk.read(path)
    columns = prediction_table(data.with_joints(NAMES), predict(found.model, data))
    gap = np.array(columns["gap_l[um]"], dtype=float)
    left = found.problem.of_channels.undo(found.residual)
    assert np.sqrt(np.mean(gap**2)) == pytest.approx(1e6 * np.sqrt(np.mean(left**2)), rel=1e-3)
    read, said = (np.array(columns[name], dtype=float) for name in ("l[mm]", "predicted_l[mm]"))
    assert np.allclose(1e3 * (read - said), gap)


def test_a_fixed_point_may_be_blank_where_no_distance_was_read(tmp_path: Path) -> None:
    path = measured(tmp_path, POINTS)
    lines = path.read_text().splitlines()
    head = lines[3].split(",")[:-4]
    path.write_text("\n".join([*lines[:3], ",".join([*head, "", "", "", ""]), *lines[4:]]))
    read = sk.read(path).absolute
    assert read is not None and read.channels.distance is not None
    assert np.flatnonzero(np.isnan(read.channels.distance)).tolist() == [2]
    assert read.channels.anchor is not None and np.isnan(read.channels.anchor[2]).all()
    for cells in (["1", "2", "", "4"], ["", "1.6", "", "0.1"], ["1", "", "", ""]):
        path.write_text("\n".join([*lines[:3], ",".join([*head, *cells]), *lines[4:]]))
        with pytest.raises(InputError, match=r"line 4.*lacks a coordinate"):
            sk.read(path)
