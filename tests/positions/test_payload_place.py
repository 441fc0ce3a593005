"""Masses on the tool whose centre nobody stated, or that hang elsewhere than was stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.words import findings
from tests.positions.arm import poses, tracked, write
from tests.positions.test_forms import _with

CENTRE = np.array([0.06, -0.04, 0.25])  # m, tool frame
COMPLIANCE = np.array([0.0, 1 / 6e5, 1 / 5e5, 0.0, 1 / 8e4, 0.0])
FIT = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"
SAID = "Where the payload hangs is not stated"


def hung(folder: Path, masses: list[float], stated: str = "") -> Path:
    """A file of 60 poses; the masses hang at `CENTRE`."""
    a, mass = poses(60, 4), np.resize(masses, 60)
    arm = _with(payload=(mass, CENTRE))  # type: ignore[arg-type]
    arm.compliance, arm.shift, arm.turn = COMPLIANCE, np.zeros((6, 3)), np.zeros((6, 3))
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(3).normal(size=(60, 3))
    cells = [f"{m:g}" for m in mass]
    return write(folder, a, x, FIT + NOISE + stated, more=",payload[kg]", cells=cells)


def robot_of(path: Path) -> sk.Robot:
    return sk.load_robot(path.parent / "six.urdf", base="base", tool="tool")


@pytest.mark.parametrize("stated", ["", "payload: {point: {xyz: [0, 0, 50], unit: mm}}\n"])
def test_where_masses_hang_is_named_beside_the_springs(tmp_path: Path, stated: str) -> None:
    path = hung(tmp_path, [0.0, 30.0, 60.0], stated)
    data = sk.read(path)
    found = sk.explain(sk.Model(robot_of(path)), data)
    assert isinstance(found, Explained)
    names = {item.effect.id for item in found.findings}
    springs = {f"joint_springs:j{k}" for k in (2, 3, 5)}
    assert found.verdict == "named" and names == {"force_point:sensor", *springs}
    own = [p for p in found.final.parameters if p.effect.name == "force_point"]
    off = CENTRE - ([0.0, 0.0, 0.05] if stated else np.zeros(3))
    std = np.array([p.internal_std for p in own])
    assert np.all(np.abs([p.internal for p in own] - off) < 4.0 * std) and np.all(std < 0.01)
    assert max(abs(p.internal) for p in own) < own[0].spec.plausible
    for p in found.final.parameters:
        if p.effect.joint_spring:
            assert abs(p.internal - COMPLIANCE[int(p.effect.where[1]) - 1]) < 4.0 * p.internal_std
    told = findings(found.final, data)
    assert not any(SAID in line for line in told), "it is found"


def test_one_mass_in_every_row_is_what_payload_says(tmp_path: Path) -> None:
    path = hung(tmp_path, [60.0])
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    names = {item.effect.id for item in found.findings}
    assert "payload:tool" in names
    assert "force_point:sensor" not in {*names, *(e.id for e in found.linear.candidates)}


def test_identify_finds_where_masses_hang_or_says_that_it_was_not_told(tmp_path: Path) -> None:
    path = hung(tmp_path, [0.0, 60.0])
    data, model = sk.read(path), sk.base_model(robot_of(path))
    assert data.absolute is not None and not data.absolute.payload_placed
    plain = sk.fit(model, data)
    assert isinstance(plain, Calibration)
    assert any("that its mass differs tells it" in line for line in findings(plain, data))
    for k, p in enumerate(p for p in plain.parameters if p.effect.name == "force_point"):
        assert abs(p.internal - CENTRE[k]) < 4.0 * p.internal_std < 0.1
    for p in plain.parameters:
        if p.effect.joint_spring and p.effect.where in ("j2", "j3", "j5"):
            true = COMPLIANCE[int(p.effect.where[1]) - 1]
            assert abs(p.internal - true) < 4.0 * p.internal_std
    one = sk.read(hung(tmp_path, [60.0]))
    assert sum(SAID in line for line in findings(sk.fit(model, one), one)) == 1
    sk.write_measurements(data, tmp_path / "again.csv")
    again = sk.read(tmp_path / "again.csv")
    assert again.absolute is not None and not again.absolute.payload_placed
    free = sk.read(hung(tmp_path, [0.0, 60.0], "payload: {fit: true}\n"))
    found = sk.fit(model, free)
    assert isinstance(found, Calibration)
    assert not any(SAID in line for line in findings(found, free))
    place = {p.name: p for p in found.parameters}
    for axis, true in zip("xyz", CENTRE, strict=True):
        p = place[f"force_point:sensor.offset_{axis}"]
        assert abs(p.internal - true) < 4.0 * p.internal_std < 0.1
    assert min(found.misfit[2], plain.misfit[2]) > 1e-3


def test_nothing_is_said_where_nothing_hangs(tmp_path: Path) -> None:
    path = hung(tmp_path, [0.0])
    data = sk.read(path)
    found = sk.fit(sk.base_model(robot_of(path)), data)
    assert isinstance(found, Calibration)
    assert not any(SAID in line for line in findings(found, data))


def test_springs_that_rest_on_the_arms_own_weight_alone_say_so(tmp_path: Path) -> None:
    """A gas strut of 300 N·m that nobody stated made a spring 25 % too stiff, and nothing said it
    might.
    """
    words = "own weight bends it here"
    for folder, masses, told in (("own", [0.0], True), ("hung", [0.0, 60.0], False)):
        (tmp_path / folder).mkdir()
        path = hung(tmp_path / folder, masses)
        data, model = sk.read(path), sk.base_model(robot_of(path))
        assert model is not None
        found = sk.fit(model, data)
        assert isinstance(found, Calibration)
        assert any(words in line for line in findings(found, data)) == told
