"""What a project needs beside its program: how to join, cite, package it, and what is promised."""

import json
import re
import tarfile
import tomllib
from pathlib import Path

import pytest
import yaml

import sk120stiff
from sk120stiff.files.json_text import SCHEMA
from tests.hidden import make_cases, run, score

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAPER = (ROOT / "docs" / "joss" / "paper.md").read_text(encoding="utf-8")
PAGES = ("CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "docs/STABILITY.md")


@pytest.mark.parametrize("page", PAGES)
def test_pages_name_what_exists(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^)]+)\)", text):
        assert "://" in link or (ROOT / page).parent.joinpath(link).is_file(), link
    for name in re.findall(r"`((?:sk120stiff|tests|robots|scripts|docs)/[\w./]*)`", text):
        assert (ROOT / name).exists() or name == "docs/_build/html", name  # made by .ci/docs


def test_contributing_has_the_commands_that_work() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    set_up, blind = re.findall(r"```bash\n(.*?)```", text, re.DOTALL)
    assert set_up in readme
    for line, module in zip(blind.splitlines(), (make_cases, run, score), strict=True):
        assert line.startswith(f"python -m {module.__name__} ")
        help_text = Path(module.__file__).read_text(encoding="utf-8")
        assert all(option in help_text for option in re.findall(r"--\w+", line))


def test_the_citation_is_of_this_version() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["cff-version"] == "1.2.0"
    assert cited["version"] == PROJECT["version"]
    assert cited["license"] == PROJECT["license"]
    assert cited["title"].startswith(PROJECT["name"])
    assert cited["repository-code"] == PROJECT["urls"]["Repository"]


def test_stability_speaks_of_what_there_is() -> None:
    text = (ROOT / "docs" / "STABILITY.md").read_text(encoding="utf-8")
    assert f"Today it is {SCHEMA}." in text
    assert sk120stiff.__all__ and sk120stiff.show.__all__
    (promised,) = re.findall(r"Python (3\.\d+) to (3\.\d+)", text)
    supported = [c.split()[-1] for c in PROJECT["classifiers"] if "Python :: 3." in c]
    assert promised == (supported[0], supported[-1])


def test_the_paper_is_short_and_whole() -> None:
    head, body = PAPER.split("---\n")[1:3]
    assert len(body.split()) <= 1000
    assert {"Summary", "Statement of need", "State of the field"} <= set(
        re.findall(r"^# (.+)$", body, re.MULTILINE)
    )
    held = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "docs/joss/paper.bib").read_text(), re.M))
    assert set(re.findall(r"@(\w+)", body)) == held
    for picture, command in zip(
        re.findall(r"\]\((\.\./\S+\.png)\)", body),
        re.findall(r"`python (scripts/\S+)`", body),
        strict=True,
    ):
        assert (ROOT / "docs" / "joss" / picture).is_file()
        made = (ROOT / command).read_text(encoding="utf-8")
        assert Path(picture).stem in made
    assert yaml.safe_load(head)["bibliography"] == "paper.bib"


def test_the_conda_recipe_asks_for_what_pip_asks_for() -> None:
    text = (ROOT / "recipe" / "meta.yaml").read_text(encoding="utf-8")
    run_part = text.partition("\n  run:\n")[2].partition("\ntest:")[0]
    other = {"pinocchio": "pin", "matplotlib-base": "matplotlib", "meshcat-python": "meshcat"}
    asked = {other.get(n, n): v for n, v in re.findall(r"- (\S+) >=(\S+)", run_part)}
    assert asked.pop("python") == PROJECT["requires-python"].removeprefix(">=")
    plain = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["view"]]
    assert asked == dict(each.split(">=") for each in plain)


def test_the_source_archive_can_be_worked_on(tmp_path: Path) -> None:
    from hatchling.builders.sdist import SdistBuilder

    archive = next(SdistBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"]))
    with tarfile.open(archive) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    for needed in (*PAGES, "pyproject.toml", "LICENSE", "CITATION.cff", ".ci/run", ".ci/smoke",
                   "tests/conftest.py", "robots/ur5e/ur5e.urdf", "recipe/meta.yaml"):  # fmt: skip
        assert needed in names, needed
    assert not [name for name in names if name.startswith((".ci/work", ".venv"))]
    assert json.dumps(sorted(names)).count(".pyc") == 0
