"""A balancer that nobody modelled, and waves of a gear that are no balancer's."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.findings import likely
from sk120stiff.explain.positions.answer.balancer import chance_of_gear
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import headline
from tests.positions.arm import poses, tracked, urdf, write
from tests.positions.test_forms import _with
from tests.positions.test_payload_place import CENTRE, COMPLIANCE, FIT, NOISE, robot_of


def balanced(folder: Path, torque: float, joint: int = 1) -> Path:
    """Positions under two masses; a spring turns a joint by torque · sin(q + 0.4)."""
    a, mass = poses(60, 4), np.resize([0.0, 60.0], 60)
    arm = _with(payload=(mass, CENTRE))  # type: ignore[arg-type]
    arm.compliance, arm.shift, arm.turn = COMPLIANCE, np.zeros((6, 3)), np.zeros((6, 3))
    arm.waves = np.zeros((6, 2))
    arm.waves[joint] = COMPLIANCE[1] * torque * np.array([np.cos(0.4), np.sin(0.4)])
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(3).normal(size=(60, 3))
    stated = f"payload: {{point: {{xyz: {(1e3 * CENTRE).tolist()}, unit: mm}}}}\n"
    cells = [f"{m:g}" for m in mass]
    return write(folder, a, x, FIT + NOISE + stated, more=",payload[kg]", cells=cells)


@pytest.mark.parametrize("torque", [1500.0, 450.0, 120.0])
def test_waves_larger_than_gears_make_are_open_as_those_of_a_balancer_too(
    tmp_path: Path, torque: float
) -> None:
    """1.9, 0.56 and 0.15 mrad: the last is what gears are off."""
    path = balanced(tmp_path, torque)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    wave = next(item for item in found.findings if item.effect.id == "transmission_error:j2")
    is_told = torque > 300.0
    assert wave.settled != is_told
    assert (wave.exact == wave.untold == ("gravity_compensator:j2",)) == is_told
    said = [line for line in found.final.notes if line.startswith("Once per turn j2")]
    assert bool(said) == is_told
    written = found.document().as_keys()
    entry = next(each for each in written["effects"] if each["name"] == "transmission_error")
    assert (entry["alternatives"] == ["gravity_compensator:j2"]) == is_told
    assert ("pressure or spring released" in written["next_step"]) == is_told
    if not is_told:
        return
    (number,) = re.findall(r"with (\d+) N·m", said[0])
    assert float(number) == pytest.approx(torque, abs=max(0.03 * torque, 27.0))
    assert written["verdict"] == "ambiguous"
    assert "transmission_error:j2 or gravity_compensator:j2" in headline(found)
    gear, other = (found.probabilities[name] for name in (wave.effect.id, *wave.untold))
    assert gear + other == pytest.approx(wave.probability, rel=1e-6)
    assert gear == pytest.approx(chance_of_gear(torque * COMPLIANCE[1], 1e-5), abs=0.1)
    assert likely(gear) in found.chance_of(wave).split(";")[0]


def test_the_size_of_a_wave_tells_by_its_error() -> None:
    """A large one that is hardly known may be as small as gears make it."""
    sure = [chance_of_gear(wave, 1e-6) for wave in (1e-4, 3e-4, 6e-4, 1e-3, 2e-3)]
    assert sure[0] > 0.98 and abs(sure[1] - 0.95) < 0.01 and sure[-1] < 0.01
    assert sure == sorted(sure, reverse=True)
    assert chance_of_gear(6e-4, 3e-4) > sure[2] + 0.2


def test_a_large_wave_of_an_arm_without_masses_may_be_its_weight(tmp_path: Path) -> None:
    """Nobody knows then what hangs at the joint, nor how far its spring gives way."""
    a = poses(60, 4)
    arm = _with()
    arm.compliance, arm.shift, arm.turn = np.zeros(6), np.zeros((6, 3)), np.zeros((6, 3))
    arm.waves = np.zeros((6, 2))
    arm.waves[:3] = 1.2e-3, 4e-4
    x = tracked(arm.stands(a)[0]) + 2e-5 * np.random.default_rng(3).normal(size=(60, 3))
    path = write(tmp_path, a, x, FIT + NOISE)
    (tmp_path / "bare.urdf").write_text(urdf(weighs=False), encoding="utf-8")
    found = sk.explain(sk.Model(sk.load_robot(tmp_path / "bare.urdf", tool="tool")), sk.read(path))
    assert isinstance(found, Explained)
    waves = {item.effect.where: item for item in found.findings if "transmission" in item.effect.id}
    assert waves["j2"].untold == ("joint_springs:j2",) and not waves["j2"].settled
    assert waves["j1"].untold == ()  # it stands upright
    assert waves["j3"].untold == ()  # weight there goes with the angle of j2 as well
    said = " ".join(found.final.notes)
    assert "the arm's own weight, which the URDF does not state" in said
    assert "masses and centres of mass into the URDF" in found.document().next_step


def test_nothing_balances_an_upright_axis(tmp_path: Path) -> None:
    """Weight does not turn it, and no spring has to lift it: such waves are those of its gear."""
    path = balanced(tmp_path, 1500.0, joint=0)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    wave = next(item for item in found.findings if item.effect.id == "transmission_error:j1")
    assert wave.exact == ()
    assert not [line for line in found.final.notes if line.startswith("Once per turn")]
