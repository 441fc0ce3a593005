"""What is found stands on the disk first; a picture or a page that fails loses only itself."""

import json
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from sk120stiff import base_model, load_robot, read_measurements
from sk120stiff.cli.explain_output import Task, findings, parts, write_answer
from sk120stiff.errors import ToolkitWarning
from sk120stiff.explain import Explanation, explain
from sk120stiff.robot.bundled import bundled_robots

DATA = bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
ANSWERS = {"verdict.json", "model.yaml", "gaps.csv"}


@pytest.fixture(scope="module")
def answer() -> Explanation:
    robot = load_robot("motoman_sk120")
    return explain(base_model(robot), read_measurements(DATA, robot.actuated))


@pytest.fixture
def task() -> Task:
    return Task(read_measurements(DATA), DATA, [DATA])


def broken(*_: object, **__: object) -> None:
    raise ValueError("Axis limits cannot be NaN or Inf")


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {"next_poses.csv", "next_poses.yaml"}


def test_a_picture_that_fails_is_said_in_its_place(answer, task, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("sk120stiff.show.stories.gap_pictures.gap_vectors", broken)
    with pytest.warns(ToolkitWarning, match="picture.*Axis limits cannot be NaN"):
        document = write_answer(answer, task, tmp_path, report=True)
    assert names(tmp_path) == ANSWERS | {"report.html", "scene.html"}
    page = Path(document["report"]).read_text(encoding="utf-8")
    assert "could not be made (ValueError: Axis limits cannot be NaN or Inf)" in page
    assert page.count("<svg") >= 1  # another picture
    assert "What these readings cannot show" in page


def test_a_section_that_fails_leaves_the_others(answer, task, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("sk120stiff.show.stories.sizes_sections.springs_table", broken)
    with pytest.warns(ToolkitWarning, match="The section 'Parameters' could not be made"):
        document = write_answer(answer, task, tmp_path, report=True)
    page = Path(document["report"]).read_text(encoding="utf-8")
    assert "Where it lives" in page or "Is there a gap at all?" in page
    assert ">Parameters</h2>" in page


def test_a_page_that_fails_leaves_the_answer(answer, task, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("sk120stiff.show.stories.explain_scene", broken)
    with pytest.warns(ToolkitWarning, match=r"The page scene\.html could not be made"):
        document = write_answer(answer, task, tmp_path, report=True)
    assert names(tmp_path) == ANSWERS | {"report.html"}
    assert "scene" not in document
    verdict = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert (verdict["schema"], verdict["verdict"]) == (2, answer.verdict)


def test_the_answer_is_written_before_the_pages(answer, task, tmp_path, monkeypatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("sk120stiff.show.stories.explain_scene", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_answer(answer, task, tmp_path, report=True)
    assert names(tmp_path) == ANSWERS


def test_a_failed_page_is_in_the_json_document_and_exit_is_0(run, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("sk120stiff.show.stories.explain_report", broken)
    done = run("explain", str(DATA), "--only", "joint_tilt:joint_1_s", "--out", str(tmp_path),
               "--json")  # fmt: skip
    assert done.code == 0
    assert any("report.html could not be made" in said for said in done.document["warnings"])
    assert "Warning: The page report.html could not be made" in done.stderr
    assert names(tmp_path) == ANSWERS | {"scene.html"}


def test_nothing_is_said_where_nothing_fails(answer, task, tmp_path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", ToolkitWarning)
        write_answer(answer, task, tmp_path, report=True)
    assert names(tmp_path) == ANSWERS | {"report.html", "scene.html"}


def test_an_answer_saves_itself_as_the_command_writes_it(answer, task, tmp_path) -> None:
    by_command = write_answer(answer, task, tmp_path / "command", report=False)
    by_itself = answer.save(tmp_path / "itself")
    assert by_itself == {key: by_command[key] for key in by_itself}
    assert names(tmp_path / "itself") == ANSWERS == names(tmp_path / "command")
    for name in ("verdict.json", "gaps.csv"):
        one, other = (tmp_path / folder / name for folder in ("itself", "command"))
        assert one.read_bytes() == other.read_bytes()
    assert repr(answer).startswith("<Explanation: none; gap ")


def test_no_sentence_is_said_twice_on_the_terminal(answer, tmp_path) -> None:
    """Where nothing is named, what is left lives where the gap of the base model does."""
    left = replace(answer.remainder, shows=answer.where[1:2])
    assert left.where
    told = parts(replace(answer, verdict="outside", remainder=left), tmp_path)
    sentences = [part for part in told if isinstance(part, str)]
    assert sentences.count(left.where[0]) == 1


def test_what_no_reading_shows_is_not_called_rigid(answer, monkeypatch) -> None:
    first = answer.final.model.parameters[0]
    one = SimpleNamespace(
        effect=first.effect, probability=1.0, alternatives=(), exact=(), others=(),
        evidence=SimpleNamespace(runner_up=None, odds={}),
    )  # fmt: skip
    told = SimpleNamespace(findings=(one,), final=answer.final)
    assert "cannot be seen" not in findings(told)[1]
    where = "sk120stiff.cli.explain_output.unseen_reasons"
    monkeypatch.setattr(where, lambda fit: {first.name: "no load turns it"})
    assert f"{first.spec.name} cannot be seen" in findings(told)[1]
