"""`identify` and `explain` on positions in a tracker's own axes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

import sk120stiff as sk
from sk120stiff.cli.positions import yielding
from sk120stiff.model import Model
from sk120stiff.show.scene.building import scene_of_model
from tests.positions.arm import Arm, errors, poses, tracked, write
from tests.positions.missing_cause import YIELDS, campaign
from tests.positions.test_held_out import HELD, WILD, read

FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
NOISE = "noise: {sigma: 20, unit: um}\n"


def test_the_command_writes_its_folder(run, tmp_path: Path) -> None:
    waves = np.zeros((6, 2))
    waves[2] = 3e-4, 0.0
    a = poses(40, 70)
    x = tracked(Arm(waves=waves).stands(a)[0])
    x = x + 2e-5 * np.random.default_rng(7).normal(size=x.shape)
    path = write(tmp_path, a, x, FIT + NOISE)
    out = tmp_path / "out"
    outcome = run("explain", str(path), "--out", str(out))
    assert outcome.code == 0, outcome.stderr
    verdict = json.loads((out / "verdict.json").read_text())
    assert [effect["name"] for effect in verdict["effects"]] == ["transmission_error"]
    assert verdict["gap"]["steps"][-1]["heldout_rms"] < 30
    for name in ("report.html", "scene.html", "model.yaml", "gaps.csv"):
        assert (out / name).stat().st_size > 1000
    drawn = re.search(
        r'<script type="application/json" id="scene">(.*?)</script>',
        (out / "scene.html").read_text(encoding="utf-8"), re.DOTALL,
    )  # fmt: skip
    assert drawn is not None
    of_data = json.loads(drawn.group(1))["poses"]
    assert len(of_data) == 40
    gaps = [reading["measured"] for pose in of_data for reading in pose["readings"]]
    assert 1e-6 < np.linalg.norm(gaps, axis=1).mean() < 1e-4
    assert verdict["remainder"]["interval_95"][0] < 10.0  # beside a noise of 20 µm, which is stated
    assert "beyond the stated noise" in outcome.stdout
    assert "looks for" not in outcome.stdout
    assert "What to do now: Use model.yaml" in outcome.stdout
    assert "What to do now" in (out / "report.html").read_text()
    marker = [p for p in verdict["parameters"] if p["name"].startswith("tool_offset")]
    assert len(marker) == 3 and max(abs(p["value"]) for p in marker) > 0.1  # m
    assert all(p["plausible"] for p in marker)
    assert "more than is plausible" not in (out / "report.html").read_text()
    assert verdict["smallest_detectable"] and verdict["next_poses"] is None
    assert {p["name"] for p in verdict["probabilities"]} >= {"transmission_error:j3"}
    told = run("identify", str(path), "--json", "--out", str(tmp_path / "m.yaml")).document
    assert told["mean_distance_um"] < 60 and told["frozen"]
    assert told["robot"] == "six"
    again = run("predict", str(out / "model.yaml"), str(path), "--json").document
    assert again["rms_um"] < 30 and len(again["rows"]) == 40


@pytest.mark.parametrize(
    "asked",
    [
        ("identify", "--robust"),
        ("identify", "--held-out"),
        ("identify", "--compare", "base_rocking"),
        ("explain", "--max-effects", "2", "--out", "out"),
        ("explain", "--assume", "base_rocking", "--out", "out"),
    ],
)
def test_options_that_do_nothing_for_positions_are_refused(
    asked: tuple[str, ...], run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    a = poses(12, 70)
    path = write(tmp_path, a, tracked(Arm().stands(a)[0]), FIT + NOISE)
    command, option, *rest = asked
    outcome = run(command, str(path), option, *rest)
    assert outcome.code == 2
    assert option in outcome.stderr and "positions" in outcome.stderr


def test_an_arm_of_which_play_alone_is_named_has_its_scene(tmp_path: Path) -> None:
    write(tmp_path, poses(1, 1), np.zeros((1, 3)), FIT)
    robot = sk.load_robot(str(tmp_path / "six.urdf"), base="base", tool="tool")
    play = Model(robot) + sk.CATALOGUE.effect(robot, "lost_motion", "j3")
    rigid = sk.base_model(robot).with_values(np.zeros(6))
    for model in (Model(robot), play.with_values(np.array([1e-4])), rigid):
        assert scene_of_model(yielding(model), title="six").elastic is not None
    springs = sk.base_model(robot)
    assert yielding(springs) is springs


def test_angles_alone_are_told_in_their_own_unit_everywhere(run, tmp_path: Path) -> None:
    a, rng = poses(50, 3), np.random.default_rng(1)
    arm = errors(1)
    arm.weighs = False
    up = arm.stands(a)[1][:, 2, 1]
    read = np.degrees(np.arcsin(up) + 2e-5 * rng.normal(size=len(a)))
    cells = [f"{v:.9f},0,1,0" for v in read[np.abs(read) < 80]]
    a = a[np.abs(read) < 80]
    nothing = np.full((len(a), 3), np.nan)
    path = write(tmp_path, a, nothing, "massless", more=",inc[deg],vx,vy,vz", cells=cells)
    told = run("identify", str(path), "--json").document
    assert told["rms_um"] is None and 1.0 < told["rms_urad"] < 60.0
    assert told["sigma_um"] is None and told["mean_distance_um"] is None
    outcome = run("explain", str(path), "--holdout", str(path), "--out", str(tmp_path / "out"))
    assert outcome.code == 0, outcome.stderr
    text = outcome.stdout + (tmp_path / "out" / "report.html").read_text().split("<footer")[0]
    assert "µrad" in text and "µm" not in text and " nan" not in text
    assert "mean distance" not in text
    known = yaml.safe_load((tmp_path / "out" / "model.yaml").read_text())["uncertainty"]
    assert known["noise_um"] is None
    again = run(
        "explain", str(path), "--holdout", str(path), "--out", str(tmp_path / "o"), "--no-report",
        "--json",
    ).document  # fmt: skip
    held = again["holdout"]
    assert again["gap"]["unit"] == "urad"
    assert all(held[f"{size}_urad"] > 0.0 for size in ("rms", "rms_of_all", "registered_rms"))
    lengths = ("rms_um", "rms_of_all_um", "registered_rms_um", "mean_distance_um")
    assert all(held[size] is None for size in lengths)


def test_rows_set_aside_are_told_beside_held_out_numbers(run, tmp_path: Path) -> None:
    data, others = read(tmp_path / "own", 80, 41, WILD), read(tmp_path / "others", 40, 77, HELD)
    given = ("explain", str(data), "--holdout", str(others), "--no-report")
    outcome = run(*given, "--out", str(tmp_path / "out"), "--json")
    assert outcome.code == 0, outcome.stderr
    document = outcome.document
    assert document["gap"]["set_aside"] == 3
    held = document["holdout"]
    assert [item["line"] for item in held["set_aside"]] == [5, 11]
    assert held["rms_um"] < 30.0 < 200.0 < held["rms_of_all_um"] and held["placed_anew"] is None
    assert held["registered_rms_um"] > 3.0 * held["rms_um"]
    said = " ".join(run(*given, "--out", str(tmp_path / "out")).stdout.split())
    assert "leave out the 3 rows that were set aside" in said
    assert f"the registered arm alone: {held['registered_rms_um']:.4g} µm" in said
    assert "Not counted: 2 rows that lie far off all others, line 5 (pose P4)" in said


def test_identify_says_what_it_cannot_know(run, tmp_path: Path) -> None:
    """A base yields, and a joint less than not at all: errors, bounds, and what is missing."""
    arm = errors(1)
    arm.rocks, arm.compliance[4] = YIELDS, -2e-6
    campaign(tmp_path, arm, 1)
    text = run("identify", str(tmp_path / "readings.csv")).stdout
    (row,) = [line.split() for line in text.splitlines() if "tracker_frame:tracker.x " in line]
    places = {len(number.partition(".")[2]) for number in row[1:5]}
    assert len(places) == 1 and min(places) >= 4
    assert "joint_springs:j5.stiffness comes out rigid (inf) and has no ±" in text
    assert "Causes that the model does not have" in text and "off level" not in text
