"""What counts as held: an answer, or one message about the input, in bounded time."""

from __future__ import annotations

import contextlib
import io
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

LIMIT = 60.0  # s of processor time
ANSWERS = (0, 1, 2)  # and 3 where the system refuses, such as a full disk
LOST = ("Internal error", "Traceback", "Exception ignored", "RuntimeWarning", "Segmentation")


@dataclass(frozen=True)
class Verdict:
    """One attack.

    Attributes
    ----------
    attack
        What was done.
    loss
        What came of it; empty where it held.
    seconds
        Processor time.
    told
        What is worth printing even where it held.
    """

    attack: str
    loss: str
    seconds: float = 0.0
    told: str = ""


def judged(
    attack: str,
    code: int,
    said: str,
    seconds: float,
    codes: Sequence[int] = ANSWERS,
    limit: float = LIMIT,
) -> Verdict:
    """Held, or the reason why not."""
    for word in LOST:
        if word in said:
            line = next(line for line in said.splitlines()[::-1] if word in line)
            return Verdict(attack, line[:300], seconds)
    if code not in codes:
        return Verdict(attack, f"exit code {code}: {said.strip()[-200:]}", seconds)
    if code and not said.strip() and 141 not in codes:
        return Verdict(attack, f"exit code {code} without a word", seconds)
    if seconds > limit:
        return Verdict(attack, f"{seconds:.0f} s of processor time", seconds)
    return Verdict(attack, "", seconds)


class _TooLong(BaseException):
    """Passes every handler of the program."""


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise _TooLong

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT + 5.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@dataclass(frozen=True)
class Heard(Verdict):
    """A verdict with what was said, on both streams."""

    code: int = -1
    said: str = ""


def heard(attack: str, *arguments: str, codes: Sequence[int] = ANSWERS) -> Heard:
    """Run a command in this process; thousands of runs are possible so."""
    from sk120stiff.cli.main import main

    stream = io.StringIO()
    begin, code = time.process_time(), -1
    try:
        quiet = contextlib.redirect_stdout(stream)
        with quiet, contextlib.redirect_stderr(stream), _time_limit():
            code = main(arguments)
    except _TooLong:
        code = 0  # the time says it
    except BaseException as error:  # noqa: BLE001 - nothing may come out of main
        stream.write(f"Traceback: {type(error).__name__}: {error}")
    seconds, said = time.process_time() - begin, stream.getvalue()
    found = judged(attack, code, said, seconds, codes)
    return Heard(attack, found.loss, seconds, code=code, said=said)


def here(attack: str, *arguments: str, codes: Sequence[int] = ANSWERS) -> Verdict:
    """What came of a command that was run in this process."""
    found = heard(attack, *arguments, codes=codes)
    return Verdict(attack, found.loss, found.seconds)


def apart(
    attack: str,
    arguments: Sequence[str],
    *,
    environment: Mapping[str, str | None] | None = None,
    codes: Sequence[int] = ANSWERS,
    before: str = "",
    under: Sequence[str] = (),
    limit: float = LIMIT,
    **options: object,
) -> Verdict:
    """Run a command in a process of its own, with environment variables set (None: removed).

    `before` is Python that runs first in that process: limits, closed descriptors. `under` are the
    words of a program that starts it.
    """
    variables = {**os.environ, "OMP_NUM_THREADS": "1"}
    for name, value in (environment or {}).items():
        variables.pop(name, None)
        if value is not None:
            variables[name] = value
    start = f"import sys; sys.argv[0]='sk120stiff'; {before}\n" if before else "import sys\n"
    code = f"{start}from sk120stiff.cli.main import main\nsys.exit(main())"
    python = variables.pop("ATTACK_PYTHON_FLAGS", "").split()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    settings: dict[str, object] = {
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
        "stdin": subprocess.DEVNULL,
        "timeout": 20 * LIMIT,
        **options,
    }
    done = subprocess.run(
        [*under, sys.executable, *python, "-c", code, *arguments],
        env=variables,
        check=False,
        **settings,  # type: ignore[call-overload]
    )
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
    said = (done.stderr or b"").decode("utf-8", "replace")
    return judged(attack, done.returncode, said, seconds, codes, limit)


def leftovers(folder: Path) -> list[str]:
    """Temporary files that a run has left behind."""
    return [path.name for path in folder.rglob(".*") if path.is_file()]
