"""Forces read by hand make no names, hide none, and are told."""

from __future__ import annotations

import pytest

from sk120stiff import Model, base_model, load_robot
from sk120stiff.explain import Options
from tests.explain.readings import answered, hidden
from tests.explain.test_noise import DRAG
from tests.hidden.generator.causes_elastic import BaseRocking

SHARE, SIGMA = 0.03, 3e-6


@pytest.fixture(scope="module")
def springs() -> Model:
    return base_model(load_robot("motoman_sk120"))


def test_a_sound_arm_has_no_name_and_no_slip(springs: Model) -> None:
    answer = answered(springs, hidden(sigma=SIGMA, force_error=SHARE, poses=12, loads=8))
    assert answer.verdict == "none"
    assert answer.set_aside == ()
    assert answer.noise.sigma == SIGMA
    assert answer.noise.force == pytest.approx(SHARE, rel=0.2)
    assert any("gauge held by hand" in reason for reason in answer.noise_reasons)


def test_a_cause_is_named_beside_it(springs: Model) -> None:
    cause = BaseRocking("base_link", {"x": 4e-7, "y": 4e-7})
    answer = answered(springs, hidden(cause, sigma=SIGMA, force_error=SHARE, poses=12, loads=8))
    assert [finding.effect.name for finding in answer.findings] == ["base_rocking"]
    assert answer.noise.force == pytest.approx(SHARE, rel=0.2)
    assert not answer.remainder.significant


def test_friction_is_friction(springs: Model) -> None:
    """It roughens single poses too, and has a name: no error of forces is left beside it."""
    answer = answered(springs, hidden(DRAG, schedule="up_down", loads=4, poses=8, sigma=5e-6))
    assert answer.findings
    assert answer.noise.force == 0.0


def test_a_soft_base_moves_what_forces_move(springs: Model) -> None:
    """The compliance is that of the arm as it was found, not as it was believed."""
    cause = BaseRocking("base_link", {"x": 3e-6, "y": 3e-6})
    readings = hidden(cause, sigma=SIGMA, force_error=0.02, poses=12, loads=8)
    answer = answered(springs, readings, Options(only=("base_rocking",)))
    assert [finding.effect.name for finding in answer.findings] == ["base_rocking"]
    assert answer.noise.force == pytest.approx(0.02, rel=0.2)
    assert answer.set_aside == ()
