"""An arm whose base yields while the model's does not: what a calibration may say and must not."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.checks.gravity_direction import refuse_another_gravity
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.positions.omitted.waves import waves_that_show
from sk120stiff.identify.positions.uncertainty.omitted_bias import beside_lacking
from sk120stiff.identify.positions.words import missing_sentences
from tests.positions.arm import errors
from tests.positions.missing_cause import SLIPPED, SOFTENS, YIELDS, campaign


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
