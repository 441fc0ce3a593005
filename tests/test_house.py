"""The house rules that a machine can check, so that one command is the whole truth."""

import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from scripts.mutations_table import FAULTS

ROOT = Path(__file__).resolve().parent.parent
SCRIPTS = Path(sysconfig.get_path("scripts"))
LONGEST_FILE = 400
NAMES_THAT_SAY_NOTHING = {"common", "core", "helper", "helpers", "misc", "util", "utils"}


def python_files(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def run(*command: str | Path) -> None:
    done = subprocess.run(
        [str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"\n{done.stdout}{done.stderr}"


def test_ruff_finds_nothing() -> None:
    run(sys.executable, "-m", "ruff", "check", ".")


def test_code_is_formatted() -> None:
    run(sys.executable, "-m", "ruff", "format", "--check", ".")


def test_types_hold_strictly() -> None:
    run(sys.executable, "-m", "mypy")


def test_imports_go_downwards() -> None:
    run(SCRIPTS / "lint-imports", "--no-cache")  # its cache keeps files that have moved


@pytest.mark.parametrize("folder", ["sk120stiff", "scripts", "robots", "tests"])
def test_files_are_short(folder: str) -> None:
    long = {
        str(path.relative_to(ROOT)): count
        for path in python_files(folder)
        if (count := len(path.read_text(encoding="utf-8").splitlines())) > LONGEST_FILE
    }
    assert not long


def test_names_say_what_a_file_is() -> None:
    vague = [path for path in python_files("sk120stiff") if path.stem in NAMES_THAT_SAY_NOTHING]
    assert not vague


def test_types_of_arrays_live_on_the_ground_floor() -> None:
    spelled = re.compile(r"NDArray\[np\.(?:float64|intp|int64|bool_)\]")
    again = [
        path
        for path in python_files("sk120stiff")
        if path.stem != "arrays" and spelled.search(path.read_text(encoding="utf-8"))
    ]
    assert not again


def test_every_fault_of_the_mutation_script_has_its_place() -> None:
    """A fault whose text is gone would be no fault, and what the tests do not see stay unknown."""
    lost = [
        fault.name
        for fault in FAULTS
        if (ROOT / fault.file).read_text(encoding="utf-8").count(fault.old) != 1
    ]
    assert lost == []
