"""The list of commands, what it costs to show it, and completion."""

import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import pytest
import typer

import sk120stiff.cli.commands
from sk120stiff.cli.frame import declared
from sk120stiff.cli.main import COMMANDS

HEAVY = {
    "jinja2",
    "matplotlib",
    "meshcat",
    "numba",
    "numpy",
    "pandas",
    "pinocchio",
    "pint",
    "pydantic",
    "rich",
    "scipy",
    "xarray",
    "yaml",
}


def test_every_command_is_listed_and_every_listed_command_exists() -> None:
    folder = Path(sk120stiff.cli.commands.__file__).parent
    files = {path.stem for path in folder.glob("*.py")}
    folders = {path.parent.name for path in folder.glob("*/__init__.py")}
    assert (files | folders) - {"__init__"} == set(COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_says_what_the_command_says(name: str) -> None:
    body = importlib.import_module(f"sk120stiff.cli.commands.{name}").command
    first_line = (inspect.getdoc(body) or "").splitlines()[0]
    assert first_line == COMMANDS[name]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_parameter_is_explained_and_nothing_else_is(name: str) -> None:
    body = importlib.import_module(f"sk120stiff.cli.commands.{name}").command
    told, parameters = declared(body)
    assert "Args:" not in told
    assert [p.name for p in parameters if not p.annotation.__metadata__[0].help] == []
    entries = re.findall(r"^    (\w+)(?: \(.*?\))?: ", inspect.getdoc(body) or "", re.MULTILINE)
    assert set(entries) <= {p.name for p in parameters}


def test_a_command_without_docstrings_keeps_its_options() -> None:
    def body(
        path: Path, flag: bool = False, keys: Annotated[str, typer.Option("--set")] = ""
    ) -> None: ...

    told, parameters = declared(body)
    shown = {p.name: p.annotation.__metadata__[0] for p in parameters}
    assert told == ""
    assert isinstance(shown["path"], typer.models.ArgumentInfo)
    assert (shown["flag"].default, shown["keys"].default) == ("--flag", "--set")


def test_help_lists_every_command_with_its_line(run) -> None:
    outcome = run("--help")
    assert (outcome.code, outcome.stderr) == (0, "")
    listed = " ".join(outcome.stdout.partition("Commands:")[2].split())
    for name, answers in COMMANDS.items():
        assert f"{name} {answers}" in listed


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_json_and_debug(run, name: str) -> None:
    outcome = run(name, "--help")
    assert outcome.code == 0
    assert "--json" in outcome.stdout
    assert "--debug" in outcome.stdout
    assert f"Example: sk120stiff {name}" in outcome.stdout


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], []])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    code = (
        "import sys; from sk120stiff.cli.main import main; "
        f"main({arguments!r}); print('\\nMODULES', *sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout
    loaded = set(done.rpartition("MODULES ")[2].split())
    assert "sk120stiff.cli.main" in loaded
    assert not loaded & HEAVY
    assert not {f"sk120stiff.cli.commands.{name}" for name in COMMANDS} & loaded


def test_version(run) -> None:
    outcome = run("--version")
    assert (outcome.code, outcome.stdout) == (0, f"sk120stiff {sk120stiff.__version__}\n")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_script(shell: str) -> None:
    done = complete({"_SK120STIFF_COMPLETE": f"source_{shell}"})
    assert "_SK120STIFF_COMPLETE" in done
    assert f"complete_{shell}" in done


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("sk120stiff ch", "check"),
        ("sk120stiff check mot", "motoman_sk120"),
        ("sk120stiff check --js", "--json"),
    ],
)
def test_completion_answers(words: str, offered: str) -> None:
    count = len(words.split()) - 1
    done = complete(
        {"_SK120STIFF_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(count)}
    )
    assert done.split() == [offered]


def complete(environment: dict[str, str]) -> str:
    import os

    return subprocess.run(
        [sys.executable, "-m", "sk120stiff"],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_a_word_that_is_no_choice_is_told_without_the_parser(run) -> None:
    refused = run("posture", "ur5e", "p.csv", "--out", "b.csv", "--minimise", "stiffness", "--json")
    assert refused.code == 2
    assert "Value error" not in refused.stderr + refused.error["message"]
    assert "'compliance', 'deflection'" in refused.error["message"]
