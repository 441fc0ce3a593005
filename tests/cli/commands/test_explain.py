"""`sk120stiff explain`: what it writes, in which order, and what its JSON promises."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sk120stiff.measurements import read_measurements, write_measurements
from tests.explain.readings import hidden
from tests.hidden.generator.causes_elastic import JointTilt

TILT = JointTilt("joint_2_l", {"first": 5e-7, "second": 5e-7})
FILES = {"model.yaml", "gaps.csv", "verdict.json", "report.html", "scene.html"}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("readings")
    write_measurements(hidden(TILT, schedule="ascending", poses=14), folder / "readings.csv")
    return folder / "readings.csv"


@pytest.fixture(scope="module")
def explained(data: Path) -> tuple[Path, dict[str, Any], str]:
    out = data.parent / "explained"
    done = subprocess.run(
        [sys.executable, "-m", "sk120stiff", "explain", str(data), "--out", str(out), "--json"],
        capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return out, json.loads(done.stdout), done.stderr


def test_verdict_has_the_keys_of_the_contract(explained) -> None:
    out, document, _ = explained
    written = json.loads((out / "verdict.json").read_text(encoding="utf-8"))
    assert {key: document[key] for key in written} == written
    assert written["verdict"] in ("named", "ambiguous")
    assert {"verdict", "effects", "gap", "where", "not_observable", "smallest_detectable",
            "next_poses"} <= set(written)  # fmt: skip
    found = written["effects"][0]
    assert (found["name"], found["where"]) == ("joint_tilt", "joint_2_l")
    assert {"alternatives", "parameters", "sentence", "evidence"} <= set(found)
    for parameter in found["parameters"]:
        assert {"name", "value", "std", "unit"} <= set(parameter)
        assert abs(parameter["value"] - 2e6) < 3.0 * parameter["std"]
        assert parameter["unit"] == "N*m/rad"
        low, high = parameter["interval_95"]
        assert low < parameter["value"] < high
        assert 1.0 / low - 1.0 / parameter["value"] == pytest.approx(  # even in compliances
            1.0 / parameter["value"] - 1.0 / high, rel=0.05
        )
    gap = written["gap"]
    assert gap["unit"] == "um"
    assert gap["steps"][-1]["heldout_rms"] < 0.5 * gap["steps"][0]["heldout_rms"]
    assert gap["steps"][-1]["fit_rms"] == pytest.approx(gap["noise_floor"], rel=0.2)


def test_where_is_told_in_sentences(explained) -> None:
    _, document, _ = explained
    where = document["where"]
    assert len(where) >= 5
    assert "the moment that joint_2_l carries across its axis" in " ".join(where)
    assert any(sentence.startswith("It grows with the load: ") for sentence in where)
    assert any("It does not go with the order of the readings" in sentence for sentence in where)


def test_files_are_all_there_and_no_others(explained) -> None:
    out, document, _ = explained
    names = {path.name for path in out.iterdir()}
    following = {"next_poses.csv", "next_poses.yaml"} if document["next_poses"] else set()
    assert names == FILES | following
    assert [Path(document[key]) for key in ("report", "scene", "model")] == [
        out / "report.html", out / "scene.html", out / "model.yaml"
    ]  # fmt: skip
    when = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}
    assert when["verdict.json"] <= min(when["scene.html"], when["report.html"])


def test_the_model_can_be_used_and_says_where_it_came_from(explained, data, run) -> None:
    out, document, _ = explained
    outcome = run("predict", str(out / "model.yaml"), str(data), "--json")
    assert outcome.code == 0
    steps = document["gap"]["steps"]
    assert outcome.document["rms_um"] == pytest.approx(steps[-1]["fit_rms"], rel=1e-6)
    text = (out / "model.yaml").read_text(encoding="utf-8")
    assert "joint_tilt" in text and "sha256:" in text and "sk120stiff explain" in text


def test_report_and_scene_are_pages(explained, data) -> None:
    out, document, _ = explained
    report = (out / "report.html").read_text(encoding="utf-8")
    assert report.startswith("<!doctype html>") and report.rstrip().endswith("</html>")
    assert document["effects"][0]["sentence"] in report
    assert data.name in report and "SHA-256 of readings.csv" in report
    assert "<!doctype html>" in (out / "scene.html").read_text(encoding="utf-8")[:200]


def test_people_get_the_size_and_the_place(data, tmp_path, run) -> None:
    outcome = run("explain", str(data), "--out", str(tmp_path / "o"), "--no-report")
    assert outcome.code == 0
    assert "The bearing of joint_2_l tilts" in outcome.stdout
    assert "±" in outcome.stdout and "N·m/rad" in outcome.stdout
    assert "The base model misses the readings by" in outcome.stdout
    assert {p.name for p in (tmp_path / "o").iterdir()} >= {"verdict.json", "model.yaml"}
    assert not (tmp_path / "o" / "report.html").exists()


def test_stale_results_never_stand_beside_new_ones(data, tmp_path, run) -> None:
    for name in ("report.html", "scene.html", "next_poses.csv", "next_poses.yaml", "verdict.json"):
        (tmp_path / name).write_text("of another run", encoding="utf-8")
    (tmp_path / "mine.txt").write_text("kept", encoding="utf-8")
    outcome = run("explain", str(data), "--out", str(tmp_path), "--no-report", "--json")
    assert outcome.code == 0
    for path in tmp_path.iterdir():
        assert "of another run" not in path.read_text(encoding="utf-8")
    assert not (tmp_path / "report.html").exists()
    assert (tmp_path / "mine.txt").exists()


def test_interrupted_writing_leaves_the_old_results(data, tmp_path, run, monkeypatch) -> None:
    old = {"verdict.json": "{}", "model.yaml": "old", "gaps.csv": "old", "report.html": "old"}
    for name, text in old.items():
        (tmp_path / name).write_text(text, encoding="utf-8")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("sk120stiff.files.writing.FileSet.swap", interrupted)
    outcome = run("explain", str(data), "--out", str(tmp_path), "--no-report")
    assert outcome.code == 130
    assert {p.name: p.read_text(encoding="utf-8") for p in tmp_path.iterdir()} == old


def test_interrupted_computing_leaves_the_old_results(data, tmp_path, run, monkeypatch) -> None:
    (tmp_path / "verdict.json").write_text("{}", encoding="utf-8")

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("sk120stiff.cli.commands.explain.entry.explain", interrupted)
    assert run("explain", str(data), "--out", str(tmp_path)).code == 130
    assert (tmp_path / "verdict.json").read_text(encoding="utf-8") == "{}"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--exclude", "no_such_effect"], "no_such_effect"),
        (["--only", "base_rocking:joint_1_s"], "cannot act at"),
        (["--out", "FILE"], "this is a file, not a folder"),
    ],
)
def test_bad_wishes_are_refused_and_nothing_is_written(
    data, tmp_path, run, arguments, words
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    options = [str(tmp_path / "file") if word == "FILE" else word for word in arguments]
    out = [] if "--out" in options else ["--out", str(tmp_path / "new")]
    outcome = run("explain", str(data), *options, *out)
    assert outcome.code == 2
    assert words in outcome.stderr
    assert not outcome.answered
    assert os.listdir(tmp_path) == ["file"]


def test_what_to_measure_next_is_a_plan(data, tmp_path) -> None:
    """Two names that cannot be told apart come with poses that the next campaign can use."""
    from dataclasses import replace

    import numpy as np

    from sk120stiff import base_model, load_robot
    from sk120stiff.cli.explain_output import Task, write_answer
    from sk120stiff.explain import explain

    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    readings = read_measurements(data)
    found = explain(model, readings)
    a = found.base.problem.load_cases.a[:2]
    wrench = np.array([[100.0, 0, -200.0, 0, 0, 0], [0, 50.0, 0, 0, 0, 0]])
    said = "Of 400 N the motors hold 120 N."
    details = {**found.details, "next_remarks": (said,)}
    open_ = replace(found, next_poses=(a, wrench), details=details)
    document = write_answer(open_, Task(readings, data, [data]), tmp_path, report=False)
    assert document["next_poses"] == "next_poses.csv"
    plan = read_measurements(tmp_path / "next_poses.csv")
    assert plan.displacement is None
    assert np.allclose(plan.joints, a)
    assert np.allclose(plan.wrench, wrench)
    assert np.allclose(plan.point, readings.point)
    assert said in plan.source


def test_a_limited_search_says_so(data, tmp_path, run) -> None:
    done = run("explain", str(data), "--only", "reading_drift", "--no-report",
               "--out", str(tmp_path / "o"))  # fmt: skip
    assert done.code == 0
    assert "no effect that was looked for explains" in done.stdout
    assert "Only these were looked for: reading_drift." in done.stdout
    verdict = json.loads((tmp_path / "o" / "verdict.json").read_text(encoding="utf-8"))
    assert (verdict["verdict"], len(verdict["limits"])) == ("outside", 1)


def test_a_search_for_nothing_is_refused(data, tmp_path, run) -> None:
    done = run("explain", str(data), "--only", "joint_tilt", "--exclude", "joint_tilt",
               "--out", str(tmp_path / "o"))  # fmt: skip
    assert done.code == 2
    assert "no effect is left to look for" in done.stderr
    assert not (tmp_path / "o").exists()


def test_held_out_readings_of_fitted_poses_are_told(data, tmp_path, run) -> None:
    done = run("explain", str(data), "--holdout", str(data), "--no-report",
               "--out", str(tmp_path / "o"))  # fmt: skip
    assert done.code == 0
    assert "Held-out readings of poses that are fitted too: 1, 2" in done.stderr


def test_a_reading_set_aside_is_told_on_the_terminal(data, tmp_path, run) -> None:
    readings = read_measurements(data)
    moved = readings.displacement.copy()
    moved[30, 1] += 1e-3
    write_measurements(replace(readings, displacement=moved), tmp_path / "bumped.csv")
    done = run("explain", str(tmp_path / "bumped.csv"), "--no-report", "--out", str(tmp_path / "o"))
    assert done.code == 0
    assert f"pose {readings.pose[30]}, line 32." in done.stdout
    verdict = json.loads((tmp_path / "o" / "verdict.json").read_text(encoding="utf-8"))
    told = {"pose": readings.pose[30], "line": 32, "slip": None}  # a bump is no slip of the pen
    assert verdict["noise"]["set_aside"] == [told]


def test_few_poses_confirm_nothing_and_that_is_said(tmp_path, run) -> None:
    """Two poses: what explains the gap is in the catalogue, but no other pose can speak for it."""
    readings = hidden(TILT, schedule="ascending", poses=2, seed=4)
    write_measurements(readings, tmp_path / "two.csv")
    done = run("explain", str(tmp_path / "two.csv"), "--no-report", "--out", str(tmp_path / "o"))
    assert done.code == 0
    assert "no effect of the catalogue explains" not in done.stdout
