"""From tracker positions to a URDF that, all by itself, says where the real arm stands."""

from pathlib import Path

import numpy as np

from sk120stiff.robot import load_robot
from tests.cli.conftest import Run
from tests.positions.arm import Arm, poses, tracked, write

SAID = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 30, unit: um}\n"
)


def off(found: np.ndarray, read: np.ndarray) -> float:
    """Rms distance [m] after the best turn and shift (Kabsch 1976)."""
    x, y = found - found.mean(axis=0), read - read.mean(axis=0)
    u, _, v = np.linalg.svd(x.T @ y)
    turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
    return float(np.sqrt(np.mean(np.sum((x @ turn - y) ** 2, axis=1))))


def test_a_geometry_fitted_without_waves_stands_alone(run: Run, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    waves = np.zeros((6, 2))
    waves[1] = 2e-4, -1.5e-4
    arm = Arm(
        waves=waves, shift=3e-4 * rng.standard_normal((6, 3)),
        turn=5e-4 * rng.standard_normal((6, 3)),
    )  # fmt: skip
    a, others = poses(80, 8), poses(40, 9)
    path = write(tmp_path, a, tracked(arm.stands(a)[0]), SAID)
    model, file = tmp_path / "model.yaml", tmp_path / "calibrated.urdf"
    found = run("identify", str(path), "--no-waves", "--out", str(model))
    assert found.code == 0, found.stderr
    made = run("export", str(model), "--out", str(file), "--json")
    assert made.code == 0, made.stderr
    assert made.document["departure_max_m"] < 1e-12
    robot = load_robot(file, base="base", tool="tool")
    truth = arm.stands(others)[0]
    calibrated = off(robot.placement(others, "tool_measured")[:, :3, 3], truth)
    stated = load_robot(tmp_path / "six.urdf", base="base", tool="tool")
    nominal = off(stated.placement(others, point=arm.marker)[:, :3, 3], truth)
    assert nominal > 5e-4 and calibrated < nominal / 4


def test_displacements_know_no_waves(run: Run) -> None:
    data = Path(__file__).resolve().parents[3] / "robots/motoman_sk120/data/table2_measured.csv"
    found = run("identify", str(data), "--no-waves")
    assert found.code == 2 and "displacements" in found.stderr
