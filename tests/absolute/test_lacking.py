"""An arm whose base yields while the model's does not: what a calibration may say and must not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sk120stiff.identify.absolute.calibrate import calibrate
from sk120stiff.identify.absolute.hanging import refuse_another_gravity
from sk120stiff.identify.absolute.lacking import beside_lacking
from sk120stiff.identify.absolute.words import missing_sentences
from tests.absolute.arm import errors
from tests.absolute.missing_cause import SLIPPED, SOFTENS, YIELDS, campaign


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
