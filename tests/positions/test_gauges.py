"""Dial gauges beside forces: what is stated otherwise is told, and nothing may yield."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from tests.positions.arm import Arm, Array, poses
from tests.positions.loaded_arm import MARKERS, SPRINGS, moved, write_moved

POINT = "point: {xyz: [150, 0, 100], unit: mm}\ndisplacement: {frame: base, zero: separate}\n"
SIGMA = 5e-6  # m
ROCKING = 4e-7  # rad/(N·m)


def gauged(
    folder: Path, stated: Array, *, springs: Array = SPRINGS, seed: int = 3, rocking: float = 0.0
) -> Path:
    """Three gauges at each of 24 poses, under forces of which a file states `stated` (3, 3) times
    what acts.
    """
    rng = np.random.default_rng(seed)
    a = np.repeat(poses(24, seed), 3, axis=0)
    force = np.repeat(400.0 * rng.normal(size=(24, 3)), 3, axis=0)
    along = np.tile(np.eye(3), (24, 1))
    d = np.zeros((72, 3))
    if springs.any():
        d, _ = moved(Arm(compliance=springs, weighs=False), a, force, MARKERS["A"], rocking)
    read = (along * d).sum(axis=1) + SIGMA * rng.normal(size=72)
    columns = {"d[mm]": 1e3 * read} | {f"u{axis}": along[:, k] for k, axis in enumerate("xyz")}
    return write_moved(folder, a, force @ stated.T, columns, POINT)


def asked(path: Path) -> Explained:
    data = sk.read(path)
    found = sk.explain(sk.Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Explained)
    return found


@pytest.mark.parametrize(
    ("stated", "told"),
    [
        (-np.eye(3), "taken with the other sign, springs.*Negate them"),
        (np.eye(3)[[1, 0, 2]], "with the columns fx, fy, fz for fy, fx, fz.*Rename the headers"),
        (np.eye(3)[[1, 2, 0]], "with the columns fx, fy, fz for fy, fz, fx.*Rename the headers"),
        (np.diag([1.0, 1.0, -1.0]), "with fz of the other sign.*Negate fz"),
    ],
)
@pytest.mark.parametrize("rocking", [0.0, ROCKING])
def test_forces_that_are_stated_otherwise_are_told(
    tmp_path: Path, stated: Array, told: str, rocking: float
) -> None:
    data = sk.read(gauged(tmp_path, stated, rocking=rocking))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    with pytest.raises(sk.InputError, match=told):
        sk.explain(sk.Model(robot), data)
    with pytest.raises(sk.InputError, match=told):
        sk.fit(sk.base_model(robot), data)


@pytest.mark.parametrize(("seed", "rocking"), [(0, 0.0), (1, ROCKING), (2, ROCKING)])
def test_forces_that_are_right_are_kept(tmp_path: Path, seed: int, rocking: float) -> None:
    found = asked(gauged(tmp_path, np.eye(3), seed=seed, rocking=rocking))
    assert "joint_springs:j3" in {item.effect.id for item in found.findings}


@pytest.mark.filterwarnings("error")
def test_an_arm_in_which_nothing_yields_is_answered(tmp_path: Path) -> None:
    """No value is estimated: what is left is that of the arm as it is, and is written as such."""
    found = asked(gauged(tmp_path, np.eye(3), springs=np.zeros(6)))
    assert not found.findings and found.final.estimated == 0
    written = found.save(tmp_path / "out")
    assert written["verdict"] == "none"
    left = sk.read_model(tmp_path / "out" / "model.yaml").uncertainty
    assert left is not None and left.remainder is not None
    assert left.remainder.upper[0] == pytest.approx(SIGMA, rel=0.3)
    assert "under these loads" in found.weight()[0]
