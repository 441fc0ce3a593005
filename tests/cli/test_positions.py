"""`identify` and `explain` on positions in a tracker's own axes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tests.absolute.arm import Arm, poses, tracked, write

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
    told = run("identify", str(path), "--json", "--out", str(tmp_path / "m.yaml")).document
    assert told["mean_distance_um"] < 60 and told["frozen"]
    assert told["robot"] == "six"
    again = run("predict", str(out / "model.yaml"), str(path), "--json").document
    assert again["rms_um"] < 30 and len(again["rows"]) == 40
