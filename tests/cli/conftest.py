"""Running the program as a user does: arguments in; exit code, stdout and stderr out."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from sk120stiff.cli.main import main


@dataclass(frozen=True)
class Outcome:
    code: int
    stdout: str
    stderr: str

    @property
    def document(self) -> dict[str, Any]:
        """The JSON document on stdout, with nothing around it."""

        assert self.stdout, self.stderr

        def refuse(constant: str) -> None:
            raise ValueError(f"{constant} is not JSON")

        return json.loads(self.stdout, parse_constant=refuse)

    @property
    def error(self) -> dict[str, Any]:
        """What the JSON document of a failure says."""
        assert set(self.document) == {"schema", "error"}
        assert self.document["schema"] == 2
        assert set(self.document["error"]) == {"kind", "message", "where", "remedy"}
        return self.document["error"]

    @property
    def answered(self) -> bool:
        """Does stdout hold an answer, rather than nothing or the document of a failure?"""
        return bool(self.stdout) and "error" not in self.document


Run = Callable[..., Outcome]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Run:
    """Run a command in this process."""

    def call(*arguments: str) -> Outcome:
        capfd.readouterr()
        code = main(arguments)
        out, err = capfd.readouterr()
        return Outcome(code, out, err)

    return call


@pytest.fixture
def run_process() -> Run:
    """Run a command in a process of its own."""

    def call(*arguments: str) -> Outcome:
        done = subprocess.run(
            [sys.executable, "-m", "sk120stiff", *arguments],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        return Outcome(done.returncode, done.stdout, done.stderr)

    return call
