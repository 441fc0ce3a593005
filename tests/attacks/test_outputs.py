"""No output ever replaces an input, whichever command and whichever way it is named."""

import os
from pathlib import Path

import pytest

from tests.attacks.outputs import ATTACKS, content, desk_of_outputs, words_of


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder as users have it, and the working folder."""
    desk_of_outputs(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("attack", ATTACKS)
def test_an_input_is_never_replaced(run, desk: Path, attack: str) -> None:
    before = content(desk)
    outcome = run(*words_of(attack))
    assert (outcome.code, outcome.stdout) == (2, "")
    assert "Choose another" in outcome.stderr or "a name of its own" in outcome.stderr
    assert content(desk) == before


@pytest.mark.parametrize("target", ["/dev/null", "/dev/stdout", "pipe", "loop", "nowhere"])
def test_what_is_no_file_is_not_replaced(run, desk: Path, target: str) -> None:
    os.mkfifo(desk / "pipe")
    (desk / "loop").symlink_to("loop")
    (desk / "nowhere").symlink_to("gone")
    before = os.lstat(target).st_ino
    outcome = run("predict", "mod.yaml", "m.csv", "--out", target)
    assert outcome.code == 2
    assert target in outcome.stderr
    assert os.lstat(target).st_ino == before


def test_a_link_is_followed_and_that_is_said(run, desk: Path) -> None:
    (desk / "elsewhere").mkdir()
    (desk / "elsewhere" / "old.csv").write_text("old")
    (desk / "link.csv").symlink_to("elsewhere/old.csv")
    outcome = run("predict", "mod.yaml", "m.csv", "--out", "link.csv")
    assert outcome.code == 0
    assert outcome.stderr.count("link.csv is a link; ") == 1
    assert (desk / "link.csv").is_symlink()
    assert "predicted_dx" in (desk / "elsewhere" / "old.csv").read_text()


def test_a_file_keeps_its_permissions(run, desk: Path) -> None:
    (desk / "p.csv").write_text("old")
    (desk / "p.csv").chmod(0o640)
    assert run("predict", "mod.yaml", "m.csv", "--out", "p.csv").code == 0
    assert (desk / "p.csv").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("part", ["part.xacro", "part.html"])
def test_an_include_of_a_xacro_is_an_input(run, desk: Path, part: str) -> None:
    xacro = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
    inside = '<link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/>'
    inside += '<child link="b"/><axis xyz="0 0 1"/></joint>'
    (desk / part).write_text(xacro.format(inside))
    (desk / "arm.xacro").write_text(xacro.format(f'<xacro:include filename="{part}"/>'))
    before = content(desk)
    outcome = run("view", "arm.xacro", "--static", part)
    assert outcome.code == 2
    assert f"would overwrite {part}" in outcome.stderr
    assert content(desk) == before
    assert run("view", "arm.xacro", "--static", "scene.html").code == 0


def test_a_second_run_may_read_what_the_first_has_written(run, desk: Path) -> None:
    assert run("identify", "m.csv", "--out", "found.yaml").code == 0
    assert run("predict", "found.yaml", "m.csv", "--out", "p.csv").code == 0
    assert run("identify", "m.csv", "--out", "found.yaml").code == 0
