"""Targets whose axes are read: how they are turned on the tool is for the fit to find."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate
from sk120stiff.identify.positions.words import findings
from sk120stiff.measurements import write_measurements
from sk120stiff.model import Model, read_model, write_model
from sk120stiff.model.predicted import prediction_table
from tests.positions.arm import NAMES, TURN, Arm, Array, errors, poses, tracked, write

SIGMA, ANGLE = 2e-5, 3e-5
KNOWN = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm}\n"
ROUGH = KNOWN.replace("mm}", "mm, fit: true}")
NOISE = "noise: {sigma: 20, unit: um, rotation: 30, rotation_unit: urad}\n"
A = poses(60, 2)
SITS = Rotation.from_euler("xyz", [20.0, 100.0, -35.0], degrees=True)


def readings(
    folder: Path, settings: str, sits: Rotation, cells: list[str] | None = None, head: str = ""
) -> Path:
    """Positions and rotations of a target that sits turned on the tool."""
    rng = np.random.default_rng(7)
    x, axes = errors(1).stands(A)
    read = TURN * Rotation.from_matrix(axes) * sits
    read = Rotation.from_rotvec(ANGLE * rng.normal(size=x.shape)) * read
    turns = [",".join(f"{v:.12g}" for v in vector) for vector in read.as_rotvec()]
    x = tracked(x) + SIGMA * rng.normal(size=x.shape)
    more = [",".join(part) for part in zip(turns, *([cells] if cells else []), strict=True)]
    return write(folder, A, x, settings + NOISE, more=",rx[rad],ry[rad],rz[rad]" + head, cells=more)


def springs(path: Path) -> Model:
    model = sk.base_model(sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool"))
    assert model is not None
    return model


def calibrated(path: Path) -> Calibration:
    return calibrate(springs(path), sk.read(path).with_joints(NAMES))


def vector(found: Calibration, label: str = "") -> Array:
    return np.array(
        [
            found.model.parameter(f"target_rotation:tool.{label}{a}").value
            for a in ("rx", "ry", "rz")
        ]
    )


def frames(found: Calibration) -> dict[str, float]:
    return {
        p.name: p.internal for p in found.parameters if p.name.startswith(("joint_", "tracker_"))
    }


@pytest.mark.parametrize("settings", [ROUGH, KNOWN + "rotation: {axes: target}\n"])
def test_however_it_sits_the_arm_is_the_same(settings: str, tmp_path: Path) -> None:
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    plain = calibrated(readings(tmp_path / "a", settings, Rotation.identity()))
    turned = calibrated(readings(tmp_path / "b", settings, SITS))
    errors_of = np.array([p.internal_std for p in plain.parameters if p.name in frames(plain)])
    assert list(frames(turned)) == list(frames(plain))
    apart = np.array(list(frames(turned).values())) - np.array(list(frames(plain).values()))
    assert np.abs(apart / errors_of).max() < 0.5
    assert turned.misfit[2] > 1e-3
    between = Rotation.from_rotvec(vector(plain)).inv() * Rotation.from_rotvec(vector(turned))
    assert (between.inv() * SITS).magnitude() < 1e-4  # what the last joint is off is in both


def test_axes_of_the_tool_that_are_a_degree_off_are_told(tmp_path: Path) -> None:
    path = readings(tmp_path, KNOWN, Rotation.from_rotvec([0.01, -0.02, 0.015]))
    found = calibrated(path)
    told = next(said for said in findings(found, sk.read(path)) if "seems to sit turned" in said)
    assert "turned by 1.5" in told and "rotation: {axes: target}" in told
    assert found.misfit[2] < 1e-6
    with_target = calibrated(readings(tmp_path, KNOWN + "rotation: {axes: target}\n", SITS))
    assert with_target.misfit[2] > 1e-3


def test_explain_names_a_target_that_is_turned(tmp_path: Path) -> None:
    """Stated axes that are a little off are an effect like others."""
    path = readings(tmp_path, KNOWN, Rotation.from_rotvec([4e-3, -6e-3, 5e-3]))
    answer = explain_positions(springs(path), sk.read(path).with_joints(NAMES))
    named = {finding.effect.id for finding in answer.findings}
    assert "target_rotation:tool" in named


def test_each_of_two_markers_sits_in_its_own_way(tmp_path: Path) -> None:
    other = Rotation.from_euler("xyz", [-60.0, 10.0, 80.0], degrees=True)
    names = np.where(np.arange(len(A)) % 2, "B", "A")
    sits = Rotation.concatenate([other if name == "B" else SITS for name in names])
    settings = (
        "position: {frame: unknown}\npoints: {A: {xyz: [50, -80, 120], unit: mm, fit: true}, "
        "B: {xyz: [50, -80, 120], unit: mm, fit: true}}\n"
    )
    found = calibrated(readings(tmp_path, settings, sits, list(names), ",marker"))
    assert found.misfit[2] > 1e-3
    between = Rotation.from_rotvec(vector(found)).inv() * Rotation.from_rotvec(vector(found, "B."))
    assert ((SITS.inv() * other).inv() * between).magnitude() < 1e-4


def test_what_a_file_says_of_axes_is_written_and_read(tmp_path: Path) -> None:
    path = readings(tmp_path, KNOWN + "rotation: {axes: target}\n", SITS)
    found, data = calibrated(path), sk.read(path)
    write_measurements(data, tmp_path / "again.csv")
    again = sk.read(tmp_path / "again.csv")
    assert again.absolute is not None and again.absolute.fit_axes
    write_model(found.model, tmp_path / "model.yaml")
    model: Model = read_model(tmp_path / "model.yaml")
    assert model.effects == found.model.effects
    said = sk.predict(model, data.with_joints(NAMES))
    left = Rotation.from_matrix(said.rotation).inv() * Rotation.from_matrix(
        data.absolute.channels.rotation
    )
    assert np.sqrt(np.mean(left.magnitude() ** 2)) < 2.5 * ANGLE  # of three axes together
    table = prediction_table(data, said)
    gap = 1e-6 * np.array([table[f"gap_r{axis}[urad]"] for axis in "xyz"], dtype=float).T
    assert np.allclose(np.linalg.norm(gap, axis=1), left.magnitude(), rtol=1e-6)
    told = np.array([table[f"predicted_r{axis}[rad]"] for axis in "xyz"], dtype=float).T
    read = Rotation.from_rotvec(gap) * Rotation.from_rotvec(told)
    assert np.allclose(read.as_matrix(), data.absolute.channels.rotation, atol=1e-9)


def test_rotations_of_an_arm_whose_wrist_was_never_calibrated_are_its_own(tmp_path: Path) -> None:
    """Two zeros of the wrist are off by 4 degrees: nobody's slip, and no reason to stop."""
    rng = np.random.default_rng(7)
    off = np.radians([0.0, 0.0, 0.0, 4.0, -4.0, 0.0])
    x, axes = Arm(compliance=errors(1).compliance).stands(A + off)
    read = TURN * Rotation.from_matrix(axes) * SITS
    read = Rotation.from_rotvec(ANGLE * rng.normal(size=x.shape)) * read
    cells = [",".join(f"{v:.12g}" for v in vector) for vector in read.as_rotvec()]
    x = tracked(x) + SIGMA * rng.normal(size=x.shape)
    path = write(tmp_path, A, x, ROUGH + NOISE, more=",rx[rad],ry[rad],rz[rad]", cells=cells)
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    answer = explain_positions(sk.Model(robot), sk.read(path))
    assert answer.chance is not None and answer.chance > 1e-3
    assert {item.effect.name for item in answer.findings} <= {
        "joint_frame", "joint_offset", "joint_springs",
    }  # fmt: skip
    assert answer.steps[0].fit_rms > 100.0 * answer.steps[-1].fit_rms
