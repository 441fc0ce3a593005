"""What is said of positions holds: their ± at other poses, the noise, and what was measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import calibrate, with_model_form
from sk120stiff.identify.positions.residuals.remainder import remainder_sentences
from sk120stiff.identify.positions.words import known_calibration
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, joint_spring_model
from tests.positions.arm import Arm, errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
SIGMA = 2e-5


def measured(folder: Path, arm: Arm, count: int, seed: int, settings: str) -> Measurements:
    """Noisy positions of the arm in the tracker's axes."""
    a = poses(count, seed)
    x = tracked(arm.stands(a)[0])
    x = x + SIGMA * np.random.default_rng(seed).normal(size=x.shape)
    return sk.read(write(folder, a, x, settings))


def soft() -> Arm:
    """With errors of geometry, and drives that yield under its weight."""
    arm = errors(3)
    arm.compliance = np.array([0.0, 1 / 6e5, 1 / 4e5, 0.0, 1 / 5e4, 0.0])
    return arm


def springs(data: Measurements) -> Model:
    """Springs in all joints, as `identify` begins."""
    return joint_spring_model(sk.load_robot(data.robot, base="base", tool="tool"), None)


def test_positions_are_foretold_with_their_error(tmp_path: Path) -> None:
    data = measured(tmp_path, soft(), 60, 1, f"{FIT}noise: {{sigma: 20, unit: um}}\n")
    model = known_calibration(with_model_form(calibrate(springs(data), data)))
    b = poses(200, 5)
    (tmp_path / "other").mkdir()
    truth = tracked(soft().stands(b)[0])
    other = sk.read(write(tmp_path / "other", b, truth, FIT))
    said = sk.predict(model, other)
    assert said.std is not None
    off = said.gap(other) / said.std
    assert 0.6 < np.sqrt(np.mean(off**2)) < 1.4
    assert (np.abs(off) < 1.96).mean() > 0.88
    assert np.abs(said.gap(other)).max() < 5.0 * SIGMA


def test_noise_that_was_understated_is_no_missing_cause(tmp_path: Path) -> None:
    data = measured(tmp_path, soft(), 60, 1, f"{FIT}noise: {{sigma: 5, unit: um}}\n")
    found = with_model_form(calibrate(springs(data), data))
    said = " ".join(remainder_sentences(found))
    assert "rather the stated σ is 3" in said or "rather the stated σ is 4" in said
    known = known_calibration(found).uncertainty
    assert known is not None and known.remainder is not None and known.remainder.significant
    (tmp_path / "stated").mkdir()
    text = f"{FIT}noise: {{sigma: 20, unit: um}}\n"
    data = measured(tmp_path / "stated", soft(), 60, 1, text)
    said = " ".join(remainder_sentences(with_model_form(calibrate(springs(data), data))))
    assert "too small" not in said


def test_what_a_controller_computed_is_not_taken_for_measured(tmp_path: Path) -> None:
    a = poses(30, 2)
    data = sk.read(write(tmp_path, a, Arm().stands(a)[0], FIT))
    found = calibrate(springs(data), data)
    assert any("they look computed" in note for note in found.notes)
    (tmp_path / "read").mkdir()
    read = measured(tmp_path / "read", Arm(), 30, 2, FIT)
    assert not any("computed" in note for note in calibrate(springs(read), read).notes)
