"""An arm whose zeros were set by eye, read over a small part of its workspace, in all turns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.explain.positions import run
from sk120stiff.explain.positions.answer.next_step import headline
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.placing.placing import place
from tests.positions.arm import NAMES, errors, poses, tracked, write
from tests.positions.shared import FIT

REACH = np.array([0.05, 0.05, 0.05, 1.0, 1.0, 1.0])  # of the joints' ranges
OFF = np.array([0.0, -0.05, 0.08, 0.06, -0.07, 0.0])  # rad


def readings(folder: Path, zero: np.ndarray, scale: float = 1.0) -> Measurements:
    a = np.array([0.2, 0.3, -0.2, 0.4, 0.5, 0.1]) + poses(60, 4) * REACH
    x = scale * tracked(errors(4).stands(a + zero)[0])
    x += 3e-5 * np.random.default_rng(4).normal(size=x.shape)
    return sk.read(write(folder, a, x, FIT)).with_joints(NAMES)


def smoothly_off(data: Measurements) -> Measurements:
    """By a millimetre, as no catalogue says."""
    q, said = data.joints, data.absolute
    assert said is not None and said.channels.position is not None
    smooth = (
        np.sin(1.3 * q[:, 3] + q[:, 4]),
        np.cos(1.7 * q[:, 4] - q[:, 5]),
        np.sin(q[:, 5] * q[:, 3]),
    )
    x = said.channels.position + 1e-3 * np.stack(smooth, axis=1)
    return replace(data, absolute=replace(said, channels=replace(said.channels, position=x)))


def test_zeros_that_bring_the_arm_there_are_told(tmp_path: Path) -> None:
    data = readings(tmp_path, OFF)
    found = place(sk.load_robot(data.robot, base="base", tool="tool"), data)
    assert found is not None
    (said,) = [note for note in found.notes if "Zeros of joints" in note]
    assert "'explain' looks for them among the causes" in said


def test_they_are_named_beside_an_error_of_the_model(tmp_path: Path) -> None:
    """About the rigid arm, which is millimetres off, no name was likely: nothing was named."""
    data = smoothly_off(readings(tmp_path, OFF))
    model = sk.Model(sk.load_robot(data.robot, base="base", tool="tool"))
    answer = explain_positions(model, data)
    names = {item.effect.id: item.probability for item in answer.findings}
    assert {f"joint_offset:j{k}" for k in (2, 3, 4, 5)} <= set(names)
    assert answer.verdict == "named" and len(names) == 4
    assert answer.steps[-1].heldout_rms < 0.09 * answer.steps[0].heldout_rms


@pytest.mark.parametrize(("together", "verdict"), [(0.9, "ambiguous"), (0.5, "outside")])
def test_names_that_stand_for_one_another_are_told_where_all_of_them_are_likely(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, together: float, verdict: str
) -> None:
    monkeypatch.setattr(Posterior, "_of", lambda *_: ((), 0.3))
    monkeypatch.setattr(run, "of_all", lambda *_: together)
    data = smoothly_off(readings(tmp_path, 0.3 * OFF))
    answer = explain_positions(sk.Model(sk.load_robot(data.robot, base="base", tool="tool")), data)
    assert answer.verdict == verdict
    told = any("None of these names is likely by itself" in n for n in answer.final.notes)
    assert told == (verdict == "ambiguous")
    assert told == ("none of them likely by itself" in headline(answer))
    if verdict == "outside":
        assert answer.guess_heldout < 0.9 * answer.steps[-1].heldout_rms
        assert "best_guess.yaml is off by" in answer.document().next_step


def test_another_arm_is_refused_as_before(tmp_path: Path) -> None:
    data = readings(tmp_path, OFF, scale=1.3)
    with pytest.raises(InputError, match="with other zeros of the joints"):
        place(sk.load_robot(data.robot, base="base", tool="tool"), data)
