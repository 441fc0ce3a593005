"""Forces beside positions with the other sign or in other axes: told, with what mends them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.checks import force_axes
from sk120stiff.identify.positions.checks.beside_frames import (
    BesideFrames,
    beside_frames,
    square_within,
)
from sk120stiff.identify.positions.checks.force_axes import refuse_other_forces
from tests.positions.arm import Arm, poses, tracked, write
from tests.positions.loaded_arm import MARKERS, SPRINGS, rests

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
FORCE = "force: {{frame: {}, point: {{xyz: [0, 0, 100], unit: mm}}}}\n"


def pulled(folder: Path, frame: str, sign: float, turn: float, stated: str) -> Path:
    """Positions under forces that a sensor reads so; the file states them in another frame."""
    a = np.repeat(poses(40, 3), 2, axis=0)
    force = 400.0 * np.random.default_rng(2).normal(size=(80, 3))
    force[::2] = 0.0
    origin, axes = rests(Arm(compliance=SPRINGS), a, force)
    x = origin + np.einsum("nij,j->ni", axes, MARKERS["A"])
    x = tracked(x + 2e-5 * np.random.default_rng(1).normal(size=x.shape))
    own = force if frame == "base" else np.einsum("nji,nj->ni", axes, force)
    read = sign * Rotation.from_euler("z", -turn, degrees=True).apply(own)
    cells = [",".join(f"{v:g}" for v in f) for f in read]
    settings = FIT + FORCE.format(stated)
    return write(folder, a, x, settings, more=",fx[N],fy[N],fz[N]", cells=cells)


@pytest.mark.parametrize(
    ("frame", "sign", "turn", "stated", "told"),
    [
        ("base", -1.0, 0.0, "base", "the other sign, springs.*Negate them"),
        ("tool", 1.0, 0.0, "base", "in axes of the tool, springs.*force: {frame: tool}"),
        ("base", 1.0, 0.0, "tool", "in axes of the base, springs.*force: {frame: base}"),
        (
            "tool",
            1.0,
            -45.0,
            "tool",
            "turned by -45 deg about z of the tool.*rpy: .0, 0, -45.",
        ),
        ("tool", -1.0, 90.0, "base", "other sign and in axes of the tool and turned by 90 deg"),
    ],
)
def test_forces_that_are_meant_otherwise_are_told(
    tmp_path: Path, frame: str, sign: float, turn: float, stated: str, told: str
) -> None:
    data = sk.read(pulled(tmp_path, frame, sign, turn, stated))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    with pytest.raises(sk.InputError, match=told):
        sk.explain(sk.Model(robot), data)
    with pytest.raises(sk.InputError, match=told):
        sk.fit(sk.base_model(robot), data)


def test_a_sensor_whose_turn_is_stated_is_read_in_its_own_axes(tmp_path: Path) -> None:
    """What the refusal says to write mends the file."""
    path = pulled(tmp_path, "tool", 1.0, -45.0, "tool, rpy: [0, 0, -45], rpy_unit: deg")
    data = sk.read(path)
    found = sk.explain(sk.Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert isinstance(found, Explained)
    names = {item.effect.id for item in found.findings}
    assert {f"joint_springs:j{k}" for k in (2, 3)} <= names
    assert "force_rotation:sensor" not in names


@pytest.mark.parametrize("turn", [0.0, 4.0])
def test_forces_that_are_right_or_nearly_so_are_not(tmp_path: Path, turn: float) -> None:
    data = sk.read(pulled(tmp_path, "tool", 1.0, turn, "tool"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = sk.explain(sk.Model(robot), data)
    assert isinstance(found, Explained)
    names = {item.effect.id for item in found.findings}
    assert {f"joint_springs:j{k}" for k in (2, 3)} <= names
    assert ("force_rotation:sensor" in names) == (turn != 0.0)


def test_forces_are_not_taken_otherwise_for_springs_that_no_drive_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Told otherwise they fit by the arm's springs; of stiffer gears they would not."""
    data = sk.read(pulled(tmp_path, "base", -1.0, 0.0, "base"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = calibrate(sk.Model(robot), data, geometry=False, waves=False)
    with pytest.raises(sk.InputError, match="the other sign"):
        refuse_other_forces(found, data)

    def of_stiff_gears(*given: Any) -> BesideFrames:
        sag = beside_frames(*given)
        return replace(sag, softest=1e-6 * sag.softest)

    monkeypatch.setattr(force_axes, "beside_frames", of_stiff_gears)
    refuse_other_forces(found, data)


def test_springs_softer_than_any_drive_explain_nothing() -> None:
    """What only they would explain is left; where none has to be, it is the usual least square."""
    rng = np.random.default_rng(5)
    along, c = rng.normal(size=(12, 3)), np.array([2e-6, 0.0, 5e-6])
    gap = along @ c + 1e-7 * rng.normal(size=12)
    free = nnls(along, gap)[1] ** 2
    wide, narrow = np.array([1e-5, 1e-5, 1e-5]), np.array([1e-5, 1e-5, 2e-6])
    assert square_within(along, gap, wide) == pytest.approx(free, rel=1e-9)
    best = min(  # a grid sees no better one
        float(np.sum((along @ np.array([a, b, 2e-6]) - gap) ** 2))
        for a in np.linspace(0.0, 1e-5, 101)
        for b in np.linspace(0.0, 1e-5, 101)
    )
    assert free < 0.1 * best
    assert best * (1 - 1e-2) < square_within(along, gap, narrow) <= best
