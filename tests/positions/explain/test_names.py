"""Causes that come with their own columns are named by `explain`, each from data of `Arm`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.model import Model
from tests.positions.arm import ORIGINS, Arm, Array, poses, tracked, write

SIGMA = 2e-5
FIT = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 20, unit: um}\n"
)
A = poses(45, 2)
ORDER = [str(k) for k in range(45)]
WARM = 24.0 * (1.0 - np.exp(-np.arange(45) / 15.0))
TIME, SIDES = np.arange(45), np.sign(np.diff(A[:, 1], prepend=A[0, 1]))
SECOND, FIFTH = np.arange(6) == 1, np.arange(6) == 4


def grown() -> Array:
    """Positions where link 2 grows by 11e-6 of 0.9 m per kelvin."""
    shifts = 1.1e-5 * WARM[:, None] * ORIGINS[2]
    return np.array([
        Arm(shift=np.outer(np.arange(6) == 2, s)).stands(q[None])[0][0]
        for q, s in zip(A, shifts, strict=True)
    ])  # fmt: skip


def explained(folder: Path, x: Array, settings: str = FIT, **columns: object) -> Explained:
    x = tracked(x) + SIGMA * np.random.default_rng(7).normal(size=x.shape)
    data = sk.read(write(folder, A, x, settings, **columns))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return explain_positions(Model(robot), data.with_joints(robot.actuated))


CASES = {  # cause → positions, a column and its cells, a parameter and its true value
    "joint_coupling:j4,j5": (
        lambda: Arm().stands(A + 1e-3 * np.outer(A[:, 3], FIFTH))[0],
        ",order", ORDER, "ratio", 1e-3,
    ),
    "approach_side:j2": (
        lambda: Arm().stands(A + 1e-4 * np.outer(SIDES, SECOND))[0],
        ",order", ORDER, "half_width", 1e-4,
    ),
    "thermal_growth:l2": (
        grown, ",temperature[degC]", [f"{20 + t:.6f}" for t in WARM], None, 1.1e-5 * 0.9,
    ),
}  # fmt: skip


@pytest.mark.parametrize("cause", CASES)
def test_a_cause_is_named_with_its_size(cause: str, tmp_path: Path) -> None:
    seen, column, cells, name, true = CASES[cause]
    found = explained(tmp_path, seen(), more=column, cells=cells)
    named = [item for item in found.findings if item.effect.name != "joint_frame"]
    # a link that is warm on the whole is longer on the whole: that is its frame
    assert len(named) == 1 and (len(found.findings) == 1 or "growth" in cause)
    assert cause in (named[0].effect.id, *named[0].alternatives) and found.chance > 1e-3
    own = [p for p in found.final.parameters if p.effect.id == cause]
    if named[0].effect.id == cause:
        p = own[0] if name is None else next(p for p in own if p.spec.name == name)
        assert abs(abs(p.internal) - true) < 4.0 * p.internal_std < 0.8 * true


def test_a_marker_mounted_anew_is_in_the_registered_arm(tmp_path: Path) -> None:
    """A column `series` says that it may have been; how far comes out, nothing else is named."""
    late = np.arange(45) >= 22
    moved = Arm(marker=Arm().marker + [8e-4, -5e-4, 3e-4])
    x = np.where(late[:, None], moved.stands(A)[0], Arm().stands(A)[0])
    found = explained(tmp_path, x, more=",series", cells=["two" if k else "one" for k in late])
    assert found.verdict == "none"
    shift = [found.final.model.parameter(f"marker_shift:tool.two.{k}").value for k in "xyz"]
    assert shift == pytest.approx([8e-4, -5e-4, 3e-4], abs=5e-5)


def test_motor_turns_with_their_ratios_are_joints(tmp_path: Path) -> None:
    """Joint 4 in motor degrees over 101, joint 3 against the floor: as from joints themselves."""
    shown = A.copy()
    shown[:, 3] *= 101.0
    shown[:, 2] = -(A[:, 2] + A[:, 1])
    x = tracked(Arm().stands(A)[0]) + SIGMA * np.random.default_rng(7).normal(size=(45, 3))
    settings = FIT + "joints: {j3: -(K3 + j2), j4: M4/101}\n"
    path = write(tmp_path, shown, x, settings)
    path.write_text(path.read_text().replace("j3[deg]", "K3[deg]").replace("j4[deg]", "M4[deg]"))
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    np.testing.assert_allclose(data.with_joints(robot.actuated).joints, A, atol=1e-8)
    found = explain_positions(Model(robot), data.with_joints(robot.actuated))
    assert found.verdict == "none" and found.final.rms < 1.2 * SIGMA
