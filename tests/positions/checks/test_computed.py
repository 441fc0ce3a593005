"""A controller's own positions are no measurement; they are told, and nothing else is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.identify import fit
from tests.positions.arm import errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"


def notes(folder: Path, noise: float, digits: float) -> str:
    """Findings on positions of a rigid arm, with noise [m], rounded to so much [m]."""
    arm, a = replace(errors(5), compliance=np.zeros(6)), poses(40, 1)
    x = tracked(arm.stands(a)[0]) + noise * np.random.default_rng(2).normal(size=(40, 3))
    data = sk.read(write(folder, a, digits * np.round(x / digits), FIT + "massless"))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return " ".join(fit(sk.Model(robot), data.with_joints(robot.actuated)).notes)


@pytest.mark.parametrize(
    ("noise", "digits", "told"), [(0.0, 1e-5, True), (0.0, 1e-6, True), (1e-5, 1e-6, False)]
)
def test_what_follows_the_model_too_well_is_told(
    tmp_path: Path, noise: float, digits: float, told: bool
) -> None:
    """Controllers show 0.01 mm, which errs by 3 µm rms; a tracker reads to 10 µm at best."""
    assert ("look computed" in notes(tmp_path, noise, digits)) == told
