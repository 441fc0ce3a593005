"""Readings that no arm can have given are refused, whatever σ would make of them."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.data_checks import look, refuse_unbelievable
from sk120stiff.errors import Refusal
from sk120stiff.explain import explain
from sk120stiff.measurements import Measurements, NoiseStatement
from tests.data_checks.readings import ARMS, Arm, spoilt


def refused(arm: Arm, data: Measurements) -> Refusal:
    with pytest.raises(Refusal) as found:
        refuse_unbelievable(look(arm.model, data), arm.model, data)
    return found.value


@pytest.mark.parametrize(("arm", "stated"), list(zip(ARMS, [True, False], strict=True)))
@pytest.mark.parametrize("garbage", ["shuffled", "random"])
def test_garbage_is_refused(arm: str, garbage: str, stated: bool) -> None:
    known = ARMS[arm]()
    data = spoilt(known, garbage)
    if not stated:
        data = replace(data, noise=NoiseStatement())
    said = refused(known, data)
    assert "this arm explains only" in said.what
    assert "belong together" in str(said.remedy)


def test_garbage_is_refused_by_explain_before_anything_is_named() -> None:
    known = ARMS["ur5"]()
    with pytest.raises(Refusal, match="this arm explains only"):
        explain(known.model, spoilt(known, "shuffled"))


def test_the_refusal_names_the_slip_that_it_comes_from() -> None:
    known = ARMS["sk120"]()
    said = refused(known, spoilt(known, "readings reversed"))
    assert "reverse order" in str(said.remedy) and "upside down" in str(said.remedy)


def test_joints_turns_beyond_their_limits_are_refused() -> None:
    """Degrees labelled rad: no pose of these was ever driven."""
    known = ARMS["ur5"]()
    data = replace(known.readings, joints=np.degrees(known.readings.joints))
    said = refused(known, data)
    assert "more than a turn beyond their limits" in said.what
    assert "deg labelled rad" in str(said.remedy) or "[deg] or [rad]" in str(said.remedy)


@pytest.mark.parametrize("sigma", [10.0, 2e-3])
def test_a_sigma_above_the_readings_is_refused(sigma: float) -> None:
    known = ARMS["sk120"]()
    said = refused(known, replace(known.readings, noise=NoiseStatement(sigma=sigma)))
    assert "larger than the readings themselves" in said.what
    assert "noise: {sigma: ..., unit: ...}" in str(said.remedy)


def test_weak_readings_with_honest_noise_are_not_refused() -> None:
    """The signal drowns in noise of the size that is stated: nothing contradicts itself."""
    known = ARMS["sk120"]()
    rng = np.random.default_rng(4)
    clean = known.readings.displacement
    assert clean is not None
    sigma = float(np.sqrt(np.mean(clean**2)))
    noisy = clean + rng.normal(0.0, np.sqrt(2.0) * sigma, clean.shape)
    data = replace(
        known.readings, displacement=noisy, noise=NoiseStatement(sigma=sigma), zero="separate"
    )
    refuse_unbelievable(look(known.model, data), known.model, data)
    assert look(known.model, data).slip is None


@pytest.mark.parametrize("rows", [2, 4, 7])
def test_few_readings_are_not_refused(rows: int) -> None:
    for arm in ARMS.values():
        known = arm()
        data = known.readings.select(np.arange(0, 3 * rows, 3))
        assert look(known.model, data).slip is None
        refuse_unbelievable(look(known.model, data), known.model, data)


def test_a_soft_arm_is_not_refused() -> None:
    """Centimetres of deflection, far beyond what is linear in the load."""
    known = ARMS["ur5"]()
    soft = known.model.with_values(known.model.values * 0.0 + 2e-3)
    data = known.readings
    moved = soft.deflect(data.joints, data.wrench, point=data.point)
    assert np.linalg.norm(moved, axis=1).max() > 0.05
    data = replace(data, displacement=moved)
    assert look(soft, data).slip is None
    refuse_unbelievable(look(soft, data), soft, data)
