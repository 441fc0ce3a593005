"""Compliance that scatters from pose to pose, one pull at each, and no noise is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import base_model, load_robot, predict
from sk120stiff.explain import Options
from sk120stiff.explain.judge.posterior import doubted_findings
from sk120stiff.identify import fit, known_model
from sk120stiff.measurements import Measurements, NoiseStatement
from tests.explain.readings import answered, hidden
from tests.hidden.generator.causes_elastic import JointTilt
from tests.hidden.generator.world import Cause

KINDS = Options(only=("joint_tilt", "link_bending", "base_rocking", "gear_hardening"))


@pytest.fixture(scope="module")
def springs():
    return base_model(load_robot("motoman_sk120"))


def pulled(seed: int, *causes: Cause, share: float = 0.05) -> Measurements:
    """One pull at each of 36 poses, off by a share of what the arm yields there along its way."""
    clean = hidden(*causes, poses=36, loads=1, sigma=2e-6, stated=False, seed=seed)
    rng = np.random.default_rng(seed)
    d = clean.displacement
    size = np.linalg.norm(d, axis=1, keepdims=True)
    return replace(clean, displacement=d + share * size * rng.normal(size=d.shape))


@pytest.mark.parametrize("seed", [0, 16, 17, 18, 34])
def test_scatter_that_grows_with_the_load_makes_no_name(springs, seed: int):
    """Noise of one size would name rocking of the base in one of them."""
    assert not answered(springs, pulled(seed), options=KINDS).findings


def test_a_cause_that_other_poses_show_is_named_in_it(springs):
    tilt = JointTilt("joint_2_l", {"first": 1e-6, "second": 1e-6})
    answer = answered(springs, pulled(7, tilt), options=KINDS)
    told = [finding for finding in answer.findings if finding.probability > 0.9]
    names = {name for each in told for name in (each.effect.id, *each.alternatives)}
    assert "joint_tilt:joint_2_l" in names
    (first, *_) = answer.findings
    assert first.evidence.confirmation.chance < 0.01
    # By as much as noise brings in three of ten cases it would be no surer than that.
    seen = replace(first.evidence.confirmation, gain=1.036, gain_error=1.0)
    weak = replace(first, evidence=replace(first.evidence, confirmation=seen))
    known, unknown = (
        doubted_findings([weak], 0.0, (), noise_known=known)[0].probability
        for known in (True, False)
    )
    assert unknown == pytest.approx(0.7 * known, abs=0.01) and known > 0.9
    beside = [doubted_findings([each, each], 1.0, (), noise_known=True) for each in (first, weak)]
    strong, doubtful = ([each.probability / known for each in pair] for pair in beside)
    assert strong == pytest.approx([0.96, 0.96], abs=0.03)
    assert doubtful == pytest.approx([0.96, 0.75], abs=0.01)


def test_what_nobody_called_noise_may_be_off_at_other_poses_too(springs):
    """Foretold are displacements: what is left is held by their intervals, whatever it is."""
    readings = pulled(3)
    found = fit(springs, readings)
    told = known_model(found).uncertainty.remainder
    assert told.probability > 0.05 or told.significant
    assert told.upper == pytest.approx(np.full(3, found.rms), rel=0.35)
    stated = replace(readings, noise=NoiseStatement(sigma=found.rms / np.sqrt(2.0)))
    sure = known_model(fit(springs, stated)).uncertainty.remainder
    assert (sure.upper < 0.8 * told.upper).all()
    others = replace(pulled(4), noise=readings.noise)
    said = predict(known_model(found), others)
    off = np.abs(said.displacement - others.displacement) / said.std
    assert np.mean(off < 1.96) > 0.85
