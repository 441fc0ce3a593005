"""Slips of the hand that every user makes once: one message, the right code, nothing written."""

import os
from pathlib import Path

import pytest

FOLDER = Path("robots/motoman_sk120")
DATA = FOLDER / "data" / "table2_measured.csv"
MODEL = str(FOLDER / "model.yaml")
GRID = ("--grid", "joint_2_l=::20 deg")


def readings_with(tmp_path: Path, before: str, after: str) -> str:
    """The paper's readings, one word of their YAML changed."""
    (tmp_path / "d.csv").write_text(DATA.read_text(encoding="utf-8"), encoding="utf-8")
    settings = DATA.with_suffix(".yaml").read_text(encoding="utf-8")
    assert before in settings
    (tmp_path / "d.yaml").write_text(settings.replace(before, after), encoding="utf-8")
    return str(tmp_path / "d.csv")


@pytest.mark.parametrize("arguments", [("predict", MODEL, str(DATA)), ("identify", str(DATA))])
def test_a_folder_where_a_file_belongs(run, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    outcome = run(*arguments, "--out", str(tmp_path))
    assert (outcome.code, outcome.answered) == (2, False)
    assert f"{tmp_path}: this is a folder" in outcome.stderr
    assert not any(tmp_path.iterdir())


def test_a_file_where_a_folder_belongs(run, tmp_path: Path) -> None:
    file = tmp_path / "notes.txt"
    file.write_text("mine", encoding="utf-8")
    outcome = run("map", "motoman_sk120", *GRID, "--out", str(file))
    assert outcome.code == 2
    assert "no map" in outcome.stderr
    assert file.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("command", ["explain", "demo"])
def test_a_closed_folder_is_told_before_the_work(
    run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    # As an administrator every folder can be written to, so the answer of the system is given here.
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != tmp_path)
    data = (str(DATA),) if command == "explain" else ()
    outcome = run(command, *data, "--out", str(tmp_path / "new" / "folder"))
    assert outcome.code == 2
    assert f"cannot write into {tmp_path}" in outcome.stderr


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("motoman_sk120", "motoman_sk12", "there is no such robot"),
        ("tool0", "tol0", "did you mean 'tool0'"),
    ],
)
def test_what_the_settings_name_wrongly_is_said_of_them(
    run, tmp_path: Path, before: str, after: str, said: str
) -> None:
    outcome = run("identify", readings_with(tmp_path, before, after))
    assert outcome.code == 2
    assert str(tmp_path / "d.yaml") in outcome.stderr
    assert said in outcome.stderr


@pytest.mark.parametrize(("angle", "beyond"), [("70", False), ("-70", False), ("70.1", True)])
def test_a_pose_beyond_the_limits_is_computed_and_told(run, angle: str, beyond: bool) -> None:
    outcome = run("stiffness", "motoman_sk120", "--pose", f"joint_2_l={angle} deg")
    assert outcome.code == 0
    told = "Warning: joint_2_l stands at 70.1 deg, beyond its limits -70 .. 70." in outcome.stderr
    assert told == beyond


@pytest.mark.parametrize("arguments", [
    ("simulate", "MODEL", "plan.csv", "--out", "truth.csv"),  # its YAML would be the model
    ("simulate", "MODEL", "plan.csv", "--out", "plan.csv"),
    ("plan", "--model", "MODEL", "--count", "3", "--out", "truth.csv"),
    ("identify", "plan.csv", "--out", "plan.yaml"),
])  # fmt: skip
def test_no_output_replaces_an_input(run, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "truth.yaml").write_text(Path(MODEL).read_text(encoding="utf-8"), encoding="utf-8")
    for suffix in (".csv", ".yaml"):
        text = DATA.with_suffix(suffix).read_text(encoding="utf-8")
        (tmp_path / "plan").with_suffix(suffix).write_text(text, encoding="utf-8")
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    words = [
        str(tmp_path / word.replace("MODEL", "truth.yaml"))
        if "." in word or word == "MODEL"
        else word
        for word in arguments
    ]
    outcome = run(*words)
    assert (outcome.code, outcome.answered) == (2, False)
    assert "would overwrite" in outcome.stderr
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before
