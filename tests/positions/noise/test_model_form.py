"""An error of the model against noise, where nobody states the noise: sizes, names and errors."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.document import save_positions
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.explain.positions.answer.next_step import headline
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import Calibration, calibrate, with_model_form
from sk120stiff.identify.positions.noise.model_form import ModelForm
from sk120stiff.identify.positions.residuals.remainder import (
    common_part,
    left_beyond_noise,
    remainder_entry,
    remainder_sentences,
)
from sk120stiff.identify.positions.words import gap_sentence, noise_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from tests.positions.arm import Arm, Array, errors, poses, tracked, write

SIGMA = 2e-5
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"


def readings(folder: Path, a: Array, x: Array, settings: str, **more: object) -> Measurements:
    data = sk.read(write(folder, a, x, settings, **more))
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return data.with_joints(robot.actuated)


def explained(m: Measurements) -> Explained:
    return explain_positions(Model(sk.load_robot(m.robot, base="base", tool="tool")), m)


def noisy(x: Array, seed: int) -> Array:
    return tracked(x) + SIGMA * np.random.default_rng(seed).normal(size=x.shape)


def odd(a: Array) -> Array:
    """Joint values (N, 6) off by what no effect of the catalogue is."""
    q = a.copy()
    q[:, 1] += 5e-4 * np.sin(a[:, 1] - 2.0 * a[:, 2]) * np.cos(a[:, 4])
    q[:, 2] += 5e-4 * np.cos(a[:, 3] + a[:, 0])
    return q


def test_waves_that_stand_for_sag_are_not_sure_beside_what_they_leave(tmp_path: Path) -> None:
    """The URDF states no masses, so springs under weight cannot be a candidate."""
    arm, a = errors(1), poses(40, 1)
    arm.compliance = 4.0 * arm.compliance
    found = explained(readings(tmp_path, a, noisy(arm.stands(a)[0], 2), FIT + "massless"))
    assert found.findings and found.steps[-1].heldout_rms < 0.5 * found.steps[0].heldout_rms
    assert found.verdict == "ambiguous"
    for item in found.findings:  # all frames are off in this arm, and joints 2 to 6 yield
        if item.probability >= 0.95:
            names = {item.effect.id, *item.alternatives}
            assert any(name.startswith(("joint_frame", "joint_springs")) for name in names), names
    assert max(p for name, p in found.probabilities.items() if "frame" not in name) < 0.95
    entry = remainder_entry(found.final)
    low, high = entry["interval_95"]
    assert entry["significant"] and 150.0 < low < entry["rms_um"] < high < 900.0
    assert "smooth over the joints" in found.left_over()[0]
    noise = found.final.rms * (1.0 - found.final.form.share) ** 0.5
    assert noise < 3.0 * SIGMA  # of a gap of 250 µm


@pytest.mark.parametrize("settings", [FIT, FIT + NOISE])
def test_an_unknown_cause_gets_no_name(settings: str, tmp_path: Path) -> None:
    a = poses(30, 2)
    m = readings(tmp_path, a, noisy(Arm().stands(odd(a))[0], 3), settings)
    found = explained(m)
    assert found.verdict == "outside" and not found.findings and found.guess is not None
    assert found.suspects and all(item.heldout_gain > 0.0 for item in found.suspects)
    assert headline(found).startswith("Something is missing that no effect")
    out = tmp_path / "out"
    out.mkdir()
    save_positions(found, out, {})
    written = json.loads((out / "verdict.json").read_text())
    assert written["remainder"]["significant"] and written["best_guess"] == "best_guess.yaml"
    names = {effect.id for effect in sk.read_model(out / "best_guess.yaml").effects}
    assert {item["name"] for item in written["suspects"]} <= names
    assert not names & {"x"} and written["suspects"][0]["heldout_gain_um"] > 5.0
    assert {e.id for e in sk.read_model(out / "model.yaml").effects} < names


def test_noise_alone_is_no_error_of_the_model(tmp_path: Path) -> None:
    told = []
    for seed in range(3):
        a, arm = poses(40, 10 + seed), errors(seed)
        arm.compliance = np.zeros(6)
        m = readings(tmp_path, a, noisy(arm.stands(a)[0], seed), FIT)
        model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
        found = with_model_form(calibrate(model, m))
        told.append(found.form)
        assert remainder_entry(found)["rms_um"] is None or found.form
    assert told == [None] * 3


def placed(folder: Path, a: Array, x: Array, *, shared: bool = True) -> Calibration:
    m = readings(folder, a, x, FIT)
    model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
    return calibrate(model, m, geometry=False, waves=False, shared=shared)


def test_repeats_tell_noise_from_what_poses_have_of_their_own(tmp_path: Path) -> None:
    """Every pose is off by 0.1 mm, the same each time it is read, and by nothing smooth."""
    a = np.repeat(poses(24, 5), 4, axis=0)
    own = 1e-4 * np.random.default_rng(1).normal(size=(24, 3))
    x = noisy(Arm().stands(a)[0], 4) + np.repeat(own, 4, axis=0)
    found = with_model_form(placed(tmp_path, a, x))
    assert found.form is None
    size, low, high = common_part(found)
    assert low < size < high < 1.5 * size
    assert size == pytest.approx(float(np.sqrt(np.mean(own**2))), rel=0.15)
    assert noise_of(found) == pytest.approx(SIGMA, rel=0.1)
    assert remainder_entry(found)["significant"]
    said = " ".join((gap_sentence(found), *remainder_sentences(found)))
    assert "what differs between the readings of a pose tells it" in said
    assert "in common that no law explains" in said
    once = placed(tmp_path, a[::4], x.reshape(24, 4, 3).mean(axis=1))
    plain = placed(tmp_path, a, x, shared=False)
    std = [
        np.array([f.model.parameter(f"tool_offset:tool.offset_{k}").std for k in "xyz"])
        for f in (once, plain, found)
    ]
    assert (std[1] < 0.6 * std[0]).all()  # as if poses were read anew each time
    assert (std[2] > 0.85 * std[0]).all() and (std[2] < 1.8 * std[0]).all(), std


def test_what_is_smooth_is_a_part_of_what_poses_have_and_no_more_beside_it(
    tmp_path: Path,
) -> None:
    """Three quarters of each pose's error are smooth: what is left is counted once."""
    a = np.repeat(poses(24, 5), 4, axis=0)
    own = 1e-4 * np.random.default_rng(1).normal(size=(24, 3))
    x = noisy(Arm().stands(a)[0], 4) + np.repeat(own, 4, axis=0)
    found = with_model_form(placed(tmp_path, a, x))
    alone = common_part(found)
    smooth = ModelForm(0.75, 12.0, 8.0, 1e-9, np.zeros(7), np.ones(6) / 6, 0.25)
    both = replace(found, form=smooth)
    left = left_beyond_noise(both)
    gap = float(np.sqrt(np.mean(found.distances**2) / 3.0))
    assert left is not None and left[0] == pytest.approx(min(alone[0], gap))
    assert left[1] < alone[1] and left[2] > alone[2]  # of what is smooth few numbers tell
    said = " ".join(remainder_sentences(both))
    assert said.count("µm rms per axis (95 %") == 1 and "part of it is smooth" in said
    assert f"{1e6 * left[0]:.3g} µm" in said


def test_what_is_excluded_is_no_zero(tmp_path: Path) -> None:
    """Noise that came out smaller than stated by chance excludes no more than noise can hide."""
    a = poses(60, 7)
    x = tracked(Arm().stands(a)[0])
    x += 0.8 * SIGMA * np.random.default_rng(5).normal(size=x.shape)
    m = readings(tmp_path, a, x, FIT + NOISE)
    model = Model(sk.load_robot(m.robot, base="base", tool="tool"))
    found = calibrate(model, m, geometry=False, waves=False)
    (said,) = remainder_sentences(found)
    size, (low, high) = remainder_entry(found)["rms_um"], remainder_entry(found)["interval_95"]
    assert size == low == 0.0 and 4.0 < high < 12.0
    assert said.startswith("Nothing is left") and f"more than {high:.3g} µm" in said


def test_few_numbers_of_one_axis_do_not_stop_the_search(tmp_path: Path) -> None:
    """79 angles of an inclinometer: no frame alone explains enough, all at once do."""
    a, arm = poses(80, 2), errors(1)
    up = (arm.stands(a)[1] @ [0.0, 1.0, 0.0])[:, 2]
    read = np.degrees(np.arcsin(up) + SIGMA * np.random.default_rng(1).normal(size=80))
    flat = np.abs(read) < 80.0
    cells = [f"{angle:.10g},0,1,0" for angle in read[flat]]
    nothing = np.full((int(flat.sum()), 3), np.nan)
    settings = "noise: {rotation: 20, rotation_unit: urad}\n"
    m = readings(tmp_path, a[flat], nothing, settings, more=",inc[deg],vx,vy,vz", cells=cells)
    found = explained(m)
    names = {item.effect.id for item in found.findings}
    assert {"joint_springs:j2", "joint_springs:j5", "joint_frame:j3", "joint_frame:j6"} <= names
    assert found.chance > 1e-3 and found.steps[-1].heldout_rms < 5e-5


def test_few_poses_make_no_wrong_name_sure(tmp_path: Path) -> None:
    """Frames and springs of all joints: at 14 and 20 poses a wave of joint 2 fits as well."""
    wrong, sure = [], []
    for count, seed in ((14, 8), (20, 9)):
        arm, a = errors(seed), poses(count, 500 + seed)
        found = explained(readings(tmp_path, a, noisy(arm.stands(a)[0], 900 + seed), FIT))
        for item in found.findings:
            names = (item.effect.id, *item.alternatives)
            right = any(name.startswith(("joint_frame", "joint_springs")) for name in names)
            (sure if right else wrong).append(item.probability)
    assert sure and max(wrong, default=0.0) < 0.95, (sure, wrong)


def test_without_a_stated_noise_no_name_is_no_agreement(tmp_path: Path) -> None:
    a = poses(12, 3)
    found = explained(readings(tmp_path, a, noisy(Arm().stands(a)[0], 1), FIT))
    assert found.verdict == "none" and "stays open" in headline(found)
