"""Runs the public command many times in one process, to save its start-up.

`python -m tests.hidden.batch < LINES`: every line is a JSON list: files for stdout and stderr,
then the command's arguments. Exit codes are printed, one per line. Only the command's entry point
is used, and all traffic is files, as on the command line.
"""

from __future__ import annotations

import contextlib
import json
import sys
import time
from pathlib import Path


def once(out: str, err: str, arguments: list[str]) -> int:
    """One call of the command; its exit code."""
    from sk120stiff.cli.main import main

    with (
        Path(out).open("w", encoding="utf-8") as stdout,
        Path(err).open("w", encoding="utf-8") as stderr,
        contextlib.redirect_stdout(stdout),
        contextlib.redirect_stderr(stderr),
    ):
        try:
            sys.argv = ["sk120stiff", *arguments]
            return int(main() or 0)
        except SystemExit as end:
            return end.code if isinstance(end.code, int) else 1
        except Exception as error:  # noqa: BLE001  a crash is an answer too
            print(repr(error), file=stderr)
            return 70


if __name__ == "__main__":
    for line in sys.stdin:
        out, err, *arguments = json.loads(line)
        started = time.perf_counter()
        code = once(out, err, arguments)
        print(json.dumps([code, round(time.perf_counter() - started, 3)]), flush=True)
