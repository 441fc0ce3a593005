"""A balancer that nobody modelled, and waves of a gear that are no balancer's."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.absolute.explained import Explained
from tests.absolute.arm import poses, tracked, write
from tests.absolute.test_forms import _with
from tests.absolute.test_payload_place import CENTRE, COMPLIANCE, FIT, NOISE, robot_of


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


@pytest.mark.parametrize(("torque", "is_told"), [(1500.0, True), (200.0, False)])
def test_waves_that_no_gear_has_are_told_as_those_of_a_balancer_too(
    tmp_path: Path, torque: float, is_told: bool
) -> None:
    path = balanced(tmp_path, torque)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    wave = next(item for item in found.findings if item.effect.id == "transmission_error:j2")
    assert wave.settled
    assert (wave.exact == ("gravity_compensator:j2",)) == is_told
    said = [line for line in found.final.notes if line.startswith("Once per turn j2")]
    assert bool(said) == is_told
    if is_told:
        (number,) = re.findall(r"with (\d+) N·m", said[0])
        assert float(number) == pytest.approx(torque, rel=0.03)


def test_nothing_balances_an_upright_axis(tmp_path: Path) -> None:
    """Weight does not turn it, and no spring has to lift it: such waves are those of its gear."""
    path = balanced(tmp_path, 1500.0, joint=0)
    found = sk.explain(sk.Model(robot_of(path)), sk.read(path))
    assert isinstance(found, Explained)
    wave = next(item for item in found.findings if item.effect.id == "transmission_error:j1")
    assert wave.exact == ()
    assert not [line for line in found.final.notes if line.startswith("Once per turn")]
