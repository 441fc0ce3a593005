"""A tracker that moved between readings: each place has a frame, and the arm is one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.checks.parts import _one_after_the_other
from sk120stiff.identify.positions.checks.reregistration import placed_anew
from sk120stiff.measurements import write_measurements
from sk120stiff.model import Model, read_model, write_model
from sk120stiff.show.scene.building import poses_of
from tests.positions.arm import NAMES, Arm, Array, errors, poses, tracked, write

SIGMA, ANGLE = 2e-5, 3e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um, rotation: 30, rotation_unit: urad}\n"
ELSEWHERE, AWAY = Rotation.from_rotvec([-0.3, 0.8, -1.7]), np.array([-2.5, 1.0, 0.9])


def seen(x: Array, station: Array) -> Array:
    """Positions as the tracker sees them from either of two places."""
    return np.where(station[:, None] == 0, tracked(x), ELSEWHERE.apply(x) + AWAY)


def read(
    folder: Path, count: int, seed: int, stations: Array, arm: Arm | None = None,
    label: bool = True, settings: str = FIT,
) -> Path:  # fmt: skip
    """Positions of a soft, crooked arm, with a column of where the tracker stood or without."""
    folder.mkdir(exist_ok=True)
    a, rng = poses(count, seed), np.random.default_rng(seed)
    x = seen((arm or errors(4)).stands(a)[0], stations) + SIGMA * rng.normal(size=(count, 3))
    cells = [("north", "south")[k] for k in stations]
    more = {"more": ",station", "cells": cells} if label else {}
    return write(folder, a, x, settings + NOISE, **more)


def calibrated(path: Path) -> Calibration:
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    model = sk.base_model(robot)
    assert model is not None
    return calibrate(model, sk.read(path).with_joints(NAMES))


def half(count: int) -> Array:
    return np.arange(count) % 2


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Calibration:
    return calibrated(read(tmp_path_factory.mktemp("two"), 80, 41, half(80)))


def test_new_positions_are_foretold_from_both_places(two: Calibration, tmp_path: Path) -> None:
    """Against an arm that the product does not compute, seen without noise."""
    a, stations = poses(60, 9), half(60)
    x = seen(errors(4).stands(a)[0], stations)
    cells = [("north", "south")[k] for k in stations]
    path = write(tmp_path, a, x, FIT + NOISE, more=",station", cells=cells)
    readings = sk.read(path).with_joints(NAMES)
    off = np.asarray(sk.predict(two.model, readings).position) - x
    assert np.sqrt(np.mean(off**2)) < SIGMA
    names = {p.name.rpartition(":")[2] for p in two.parameters if "tracker_frame" in p.name}
    assert {"tracker.north.x", "tracker.south.rz"} < names and len(names) == 12
    write_model(two.model, tmp_path / "model.yaml")
    again = read_model(tmp_path / "model.yaml")
    assert np.allclose(sk.predict(again, readings).position, x + off, rtol=0, atol=1e-9)


def test_the_arm_is_that_of_one_place(two: Calibration, tmp_path: Path) -> None:
    """Springs and frames as from one station, as far as noise along other axes allows."""
    one = calibrated(read(tmp_path, 80, 41, np.zeros(80, dtype=int), label=False))
    mine = {p.name: p for p in two.parameters if p.name.startswith(("joint_", "tool_"))}
    shared = [p for p in one.parameters if p.name in mine]
    assert len(shared) > 15
    told = [(mine[p.name], p) for p in shared if p.internal_std and mine[p.name].internal_std]
    z = [(a.internal - b.internal) / np.hypot(a.internal_std, b.internal_std) for a, b in told]
    assert len(z) > 15 and np.abs(z).max() < 3.0 and np.sqrt(np.mean(np.square(z))) < 1.2


def test_targets_turn_with_the_arm_from_both_places(tmp_path: Path) -> None:
    a, stations, rng = poses(60, 2), half(60), np.random.default_rng(7)
    x, axes = errors(1).stands(a)
    frames = Rotation.from_matrix(
        np.stack([Rotation.from_rotvec([0.4, -1.9, 1.2]).as_matrix(), ELSEWHERE.as_matrix()])
    )
    turned = frames[stations] * Rotation.from_matrix(axes)
    turned = Rotation.from_rotvec(ANGLE * rng.normal(size=x.shape)) * turned
    x = seen(x, stations) + SIGMA * rng.normal(size=x.shape)
    cells = [
        ",".join(f"{v:.12g}" for v in vector) + f",{label}"
        for vector, label in zip(turned.as_rotvec(), np.array(["n", "s"])[stations], strict=True)
    ]
    head = ",rx[rad],ry[rad],rz[rad],station"
    found = calibrated(write(tmp_path, a, x, FIT + NOISE, more=head, cells=cells))
    left = found.residual
    assert 0.8 < np.sqrt(np.mean(left**2)) < 1.2


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    readings = sk.read(read(tmp_path, 12, 3, half(12)))
    write_measurements(readings, tmp_path / "again.csv")
    again = sk.read(tmp_path / "again.csv").absolute
    assert again is not None and again.stations == ("north", "south") * 6
    assert again.select(np.array([1, 3])).stations == ("south", "south")


def test_too_few_positions_of_a_place_are_refused(tmp_path: Path) -> None:
    stations = np.array([0] * 20 + [1, 1])
    with pytest.raises(InputError, match=r"where the tracker stood: south \(2\)"):
        calibrated(read(tmp_path, 22, 5, stations))


def test_in_base_axes_the_column_is_a_label(tmp_path: Path) -> None:
    a, rng = poses(40, 6), np.random.default_rng(6)
    x = errors(4).stands(a)[0] + SIGMA * rng.normal(size=(40, 3))
    settings = "point: {xyz: [0, 0, 0], unit: mm, fit: true}\n" + NOISE
    cells = [f"s{k % 20}" for k in range(40)]  # as a program that bundles its stations writes them
    found = calibrated(write(tmp_path, a, x, settings, more=",station", cells=cells))
    assert not any("tracker" in p.name for p in found.parameters)
    assert np.sqrt(np.mean(found.residual**2)) < 1.2


def test_distances_know_no_stations(tmp_path: Path) -> None:
    a = poses(30, 8)
    x = errors(4).stands(a)[0]
    fixed = np.array([1.5, -1.0, 0.2])
    cells = [
        f"{1e3 * np.linalg.norm(p - fixed):.6f},1.5,-1.0,0.2,{'ab'[k % 2]}" for k, p in enumerate(x)
    ]
    nothing = np.full((30, 3), np.nan)
    head = ",l[mm],ax[m],ay[m],az[m],station"
    path = write(tmp_path, a, nothing, FIT + NOISE, more=head, cells=cells)
    with pytest.raises(InputError, match="distances to fixed points know no stations"):
        calibrated(path)


def test_a_place_that_the_model_does_not_know_is_told(two: Calibration, tmp_path: Path) -> None:
    path = read(tmp_path, 12, 3, half(12))
    path.write_text(path.read_text().replace("south", "east"))
    readings = sk.read(path).with_joints(NAMES)
    with pytest.raises(InputError, match="stood for east; it knows north and south"):
        sk.predict(two.model, readings)
    unlabelled = sk.read(read(tmp_path, 12, 3, half(12), label=False)).with_joints(NAMES)
    with pytest.raises(InputError, match=r"stood for \(none\)"):
        sk.predict(two.model, unlabelled)


def gap(model: Model, path: Path) -> float:
    readings = sk.read(path).with_joints(NAMES)
    off = sk.predict(model, readings).gap(readings)
    return float(np.sqrt(np.mean(off**2)))


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> Calibration:
    path = read(tmp_path_factory.mktemp("one"), 80, 41, np.zeros(80, dtype=int), label=False)
    return calibrated(path)


@pytest.mark.parametrize("label", [True, False])
def test_held_out_readings_from_elsewhere_are_placed_anew(
    one: Calibration, two: Calibration, label: bool, tmp_path: Path
) -> None:
    model = two.model if label else one.model
    path = read(tmp_path, 40, 77, np.ones(40, dtype=int), label=label)
    path.write_text(path.read_text().replace("south", "east"))
    rows = path.read_text().splitlines()
    cells = rows[5].split(",")
    cells[6] = f"{float(cells[6]) + 4.0:.6f}"  # 4 mm off: no place of the tracker is sought for it
    path.write_text("\n".join([*rows[:5], ",".join(cells), *rows[6:]]) + "\n")
    readings = sk.read(path).with_joints(NAMES)
    found = placed_anew(model, readings)
    assert found is not None and not found.marker
    assert "stands elsewhere" in found.sentence()
    off = sk.predict(found.model, readings).gap(readings)
    assert abs(np.linalg.norm(off[4]) - 4e-3) < 1e-4
    assert np.sqrt(np.mean(np.delete(off, 4, axis=0) ** 2)) < 1.5 * SIGMA
    own = _own(tmp_path / "x", label)
    held = explain_positions(Model(model.robot), own, holdout=readings).heldout
    assert held is not None and held.rms < 1.5 * SIGMA and held.anew is not None
    poses_of(model.robot, readings, {"fitted": model})  # a scene of it can be drawn


@pytest.mark.parametrize("behind", [0, 14, 30])
def test_rows_without_a_station_are_of_those_that_the_model_knows_one_after_the_other(
    two: Calibration, behind: int, tmp_path: Path
) -> None:
    where = (np.arange(30) >= behind).astype(int)
    readings = sk.read(read(tmp_path, 30, 83, where, label=False)).with_joints(NAMES)
    found = placed_anew(two.model, readings)
    assert found is not None and found.model is two.model and found.readings.absolute is not None
    assert found.readings.absolute.stations == tuple("north" if k == 0 else "south" for k in where)
    off = sk.predict(found.model, found.readings).gap(found.readings)
    assert np.sqrt(np.mean(off**2)) < 1.5 * SIGMA
    lines = {0: "lines 2 to 31 from south", 14: "lines 2 to 15 from north and lines 16 to 31 from "
             "south", 30: "lines 2 to 31 from north"}  # fmt: skip
    assert f"the model knows several: {lines[behind]} are taken" in found.sentence()
    poses_of(two.model.robot, readings, {"fitted": two.model})  # a scene of it can be drawn


def test_rows_without_a_station_from_another_place_are_placed_anew(
    two: Calibration, tmp_path: Path
) -> None:
    path = read(tmp_path, 40, 77, np.ones(40, dtype=int), label=False)
    x = sk.read(path).with_joints(NAMES)
    assert x.absolute is not None and x.absolute.channels.position is not None
    away = replace(x.absolute.channels, position=x.absolute.channels.position + [1.0, 0.0, 0.5])
    x = replace(x, absolute=replace(x.absolute, channels=away))
    found = placed_anew(two.model, x)
    assert found is not None and "stands elsewhere" in found.sentence()
    off = sk.predict(found.model, found.readings).gap(found.readings)
    assert np.sqrt(np.mean(off**2)) < 1.5 * SIGMA


def _own(folder: Path, label: bool) -> sk.Measurements:
    own = read(folder, 60, 3, half(60) if label else np.zeros(60, dtype=int), label=label)
    return sk.read(own).with_joints(NAMES)


def test_a_marker_that_was_mounted_anew_is_told_too(one: Calibration, tmp_path: Path) -> None:
    other = replace(errors(4), marker=np.array([0.02, 0.05, 0.06]))
    path = read(tmp_path, 40, 78, np.ones(40, dtype=int), other, label=False)
    found = placed_anew(one.model, sk.read(path).with_joints(NAMES))
    assert found is not None and found.marker and "and the marker sit" in found.sentence()
    assert gap(found.model, path) < 1.5 * SIGMA


@pytest.mark.parametrize("worse", [1.0, 3.0])
def test_an_arm_that_changed_is_not_placed_away(
    one: Calibration, worse: float, tmp_path: Path
) -> None:
    """What a model lacks stays in the gap, although another frame would take some of it."""
    other = errors(4)
    other = replace(other, compliance=worse * other.compliance)
    path = read(tmp_path, 40, 79, np.zeros(40, dtype=int), other, label=False)
    assert placed_anew(one.model, sk.read(path).with_joints(NAMES)) is None
    assert (gap(one.model, path) > 5.0 * SIGMA) == (worse > 1.0)


def test_a_tracker_never_goes_back() -> None:
    """One row of the first half fits the second station by chance; the order may be another one."""
    squares = np.ones((2, 12))
    squares[0, :6], squares[1, 6:], squares[1, 2] = 0.1, 0.1, 0.0
    own, left = _one_after_the_other(squares, np.arange(12.0))
    assert own.tolist() == [0] * 6 + [1] * 6 and left == pytest.approx(1.2)
    own, left = _one_after_the_other(squares[:, ::-1], np.arange(12.0)[::-1])
    assert own.tolist() == [1] * 6 + [0] * 6 and left == pytest.approx(1.2)


@pytest.mark.parametrize("shuffled", [False, True])
def test_the_order_in_which_stations_were_stood_for_is_found(
    two: Calibration, shuffled: bool, tmp_path: Path
) -> None:
    """South before north, in the order of the file or of a column."""
    where = (np.arange(30) < 16).astype(int)
    readings = sk.read(read(tmp_path, 30, 83, where, label=False)).with_joints(NAMES)
    rows = np.random.default_rng(1).permutation(30) if shuffled else np.arange(30)
    readings = replace(readings.select(rows), order=rows.astype(float))
    found = placed_anew(two.model, readings)
    assert found is not None and found.readings.absolute is not None
    told = np.array(found.readings.absolute.stations)
    assert ((told == "south") == (where[rows] == 1)).all()


def test_a_wild_row_tips_no_rows_into_another_station(two: Calibration, tmp_path: Path) -> None:
    where = (np.arange(30) >= 14).astype(int)
    readings = sk.read(read(tmp_path, 30, 83, where, label=False)).with_joints(NAMES)
    said = readings.absolute
    assert said is not None and said.channels.position is not None
    x = said.channels.position.copy()
    x[5] = 0.9 * x[20] + 0.1 * x[5]  # nearer to where the second station has it
    there = replace(said, channels=replace(said.channels, position=x))
    found = placed_anew(two.model, replace(readings, absolute=there))
    assert found is not None and found.readings.absolute is not None
    assert found.readings.absolute.stations == tuple("north" if k == 0 else "south" for k in where)


def test_few_rows_without_a_station_are_of_those_that_are_known(
    two: Calibration, tmp_path: Path
) -> None:
    readings = sk.read(read(tmp_path, 2, 83, np.ones(2, dtype=int), label=False))
    found = placed_anew(two.model, readings.with_joints(NAMES))
    assert found is not None and found.model is two.model
