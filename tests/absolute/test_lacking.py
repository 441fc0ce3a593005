"""An arm whose base yields while the model's does not: what a calibration may say and must not."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

import sk120stiff as sk
from sk120stiff.identify.absolute.asked_for import Blocks
from sk120stiff.identify.absolute.calibrate import calibrate
from sk120stiff.identify.absolute.hanging import refuse_another_gravity
from sk120stiff.identify.absolute.lacking import (
    _as_one,
    _fitted,
    beside_lacking,
    beside_parts,
)
from sk120stiff.identify.absolute.waves import waves_that_show
from sk120stiff.identify.absolute.words import missing_sentences
from tests.absolute.arm import NAMES, errors, poses, tracked, write
from tests.absolute.missing_cause import FIT, SLIPPED, SOFTENS, YIELDS, campaign


def test_what_is_missing_is_no_wave_and_no_slope_of_the_base(tmp_path: Path) -> None:
    arm = errors(1)
    arm.rocks = YIELDS
    model, data = campaign(tmp_path, arm, 1)
    found = calibrate(model, data)
    assert found.waves == ()
    assert refuse_another_gravity(found, data) == ()
    wide = beside_lacking(found)
    assert wide.lacks == ("base_rocking:base",)
    (said,) = missing_sentences(wide)
    assert "'sk120stiff explain' looks for" in said
    second = wide.model.parameter("joint_springs:j2.stiffness")
    off = abs(second.internal - arm.compliance[1])
    assert off > 5.0 * found.model.parameter(second.name).internal_std
    assert off < 3.0 * second.internal_std


@pytest.mark.parametrize(("seed", "alone"), [(1, 5.0), (3, 4.0)])
def test_springs_know_of_a_base_that_yields_by_less_than_asks_for_a_name(
    tmp_path: Path, seed: int, alone: float
) -> None:
    """A quarter of what the test above has: nothing is beyond doubt, and springs are off."""
    arm, a = errors(seed), poses(30, seed)
    arm.rocks = 0.25 * YIELDS
    x = tracked(arm.stands(a)[0])
    x += 2e-5 * np.random.default_rng(seed).normal(size=x.shape)
    data = sk.read(write(tmp_path, a, x, f"{FIT}noise: {{sigma: 20, unit: um}}\n"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    found = calibrate(sk.base_model(robot), data.with_joints(NAMES), waves=False)
    narrow = beside_lacking(found)
    wide = beside_parts(narrow)
    assert narrow.lacks == ()
    second = wide.model.parameter("joint_springs:j2.stiffness")
    off = abs(second.internal - arm.compliance[1])
    assert off > alone * narrow.model.parameter(second.name).internal_std
    assert off < 2.0 * second.internal_std < 0.5 * second.internal
    (said,) = [note for note in wide.notes if "links and bearings" in note]
    assert "joint_springs:j2 (by link_bending:" in said
    rigid = beside_parts(narrow, among=())
    assert rigid.model.parameter(second.name).internal_std == pytest.approx(
        narrow.model.parameter(second.name).internal_std, rel=1e-12
    )


def test_evidence_is_that_of_normal_factors() -> None:
    rng = np.random.default_rng(5)
    columns, left = rng.normal(size=(12, 2)), rng.normal(size=12)
    wide = np.eye(12) + columns @ columns.T
    exact = (
        multivariate_normal(cov=wide).logpdf(left)
        - multivariate_normal(cov=1.0).logpdf(left[:, None]).sum()
    )
    shown, evidence = _fitted(columns, np.zeros(2, bool), left)
    assert evidence == pytest.approx(float(exact), rel=1e-9)
    np.testing.assert_allclose(shown, (wide - np.eye(12)) @ np.linalg.solve(wide, left), rtol=1e-9)
    shown, evidence = _fitted(-np.abs(columns), np.ones(2, bool), np.ones(12))
    assert not shown.any() and evidence == 0.0  # no compliance is negative


def test_parts_that_show_alike_share_the_probability_that_any_is_there() -> None:
    shown = np.array([[1.0, 0.0], [-3.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    likely = np.array([0.5, 0.5, 0.3, 0.2])
    np.testing.assert_allclose(_as_one(likely, shown), [0.375, 0.375, 0.3, 0.0], rtol=1e-6)


def test_rows_in_which_a_missing_cause_shows_most_are_no_slips(tmp_path: Path) -> None:
    arm = errors(3)
    arm.hardens = SOFTENS
    for slip in (0.0, 0.03):
        found = calibrate(*campaign(tmp_path, arm, 3, slip), waves=False)
        assert np.flatnonzero(found.wild).tolist() == [SLIPPED] * (slip > 0.0)


@pytest.mark.parametrize(("of_the_other", "shown"), [(20.0, True), (80.0, False)])
def test_a_wave_may_be_what_the_law_of_a_stronger_cause_leaves(
    monkeypatch: pytest.MonkeyPatch, of_the_other: float, shown: bool
) -> None:
    robot = sk.load_robot("motoman_sk120")
    wave = sk.effect(robot, "transmission_error", "joint_2_l")
    other = sk.effect(robot, "base_rocking")
    blocks = SimpleNamespace(
        causes=(wave, other), asked_for=lambda: [0, 1], sure_of=lambda _k, _chosen: True,
        losses=lambda _chosen: {0: 40.0, 1: of_the_other},
    )  # fmt: skip
    monkeypatch.setattr(Blocks, "of", classmethod(lambda *_: blocks))
    assert waves_that_show(None, sk.CATALOGUE) == ((wave,) if shown else ())  # type: ignore[arg-type]
