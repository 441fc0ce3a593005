"""Lets the public command answer all cases, then freezes the answers.

`python -m tests.hidden.run FOLDER [--jobs 2] [--timeout 300] [--batch [--again 25]] [--fresh]`

For every case: `sk120stiff explain train.csv --holdout holdout.csv --out ... --json`, then
`sk120stiff predict` with the model that was written, on readings it has not seen. Interrupted runs
go on where they were. `--batch` uses one process for many cases; `--again` answers so many of them
once more, each in processes of its own, and writes down which come out otherwise: a table for
publication needs the one or the other. `truth/` is never opened here. One case in ten, by its name,
draws its report and scene too, and a page that fails is a failed case.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import time
import zlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path
from threading import local

ROOT = Path(__file__).resolve().parents[2]
COMMAND = [sys.executable, "-m", "sk120stiff"]
SAID = ("verdict.json", "next_poses.csv", "predicted.csv")
ANSWER_FILES = ("verdict.json", "model.yaml", "next_poses.csv", "predicted.csv", "run.json")


DRAWN_ONE_IN = 10
PAGES = ("report.html", "scene.html")


def drawn(name: str) -> bool:
    """Does this case draw its pages? By its name alone, so that nobody chooses."""
    return zlib.crc32(name.encode()) % DRAWN_ONE_IN == 0


def pages_are_whole(target: Path) -> bool:
    """Are both pages there, with nothing in them that could not be drawn?"""
    told = (target / "stderr.txt").read_text(encoding="utf-8", errors="replace")
    there = all((target / page).exists() for page in PAGES)
    return there and "could not be made" not in told


class Separate:
    """One process per command."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout

    def call(self, out: Path, err: Path, arguments: list[str]) -> tuple[int | None, float]:
        """Exit code (None: timed out) and seconds."""
        started = time.perf_counter()
        with out.open("w") as stdout, err.open("w") as stderr:
            try:
                done = subprocess.run(
                    [*COMMAND, *arguments], stdout=stdout, stderr=stderr, cwd=ROOT,
                    timeout=self.timeout, stdin=subprocess.DEVNULL, check=False,
                )  # fmt: skip
                code: int | None = done.returncode
            except subprocess.TimeoutExpired:
                code = None
        return code, time.perf_counter() - started


class Batched(Separate):
    """One process for many commands of one thread."""

    def __init__(self, timeout: float) -> None:
        super().__init__(timeout)
        self.own = local()

    def call(self, out: Path, err: Path, arguments: list[str]) -> tuple[int | None, float]:
        process = getattr(self.own, "process", None)
        if process is None or process.poll() is not None:
            process = self.own.process = subprocess.Popen(
                [sys.executable, "-m", "tests.hidden.batch"], stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, text=True, cwd=ROOT,
            )  # fmt: skip
        process.stdin.write(json.dumps([str(out), str(err), *arguments]) + "\n")
        process.stdin.flush()
        line = process.stdout.readline()
        if not line:
            return process.wait(), 0.0
        code, seconds = json.loads(line)
        return code, seconds


def answer(folder: Path, name: str, runner: Separate, answers: str = "answers") -> None:
    """Everything that the program says about one case, in FOLDER/answers/NAME."""
    case, target = folder / "cases" / name, folder / answers / name
    if (target / "run.json").exists():
        return
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    extra = json.loads((case / "command.json").read_text(encoding="utf-8"))
    # paths are absolute: the batch process may stand elsewhere
    quiet = [] if drawn(name) else ["--no-report"]
    code, seconds = runner.call(
        target / "stdout.json", target / "stderr.txt",
        ["explain", str(case / "train.csv"), "--holdout", str(case / "holdout.csv"),
         *quiet, "--out", str(target), "--json", *extra],
    )  # fmt: skip
    whole = pages_are_whole(target) if drawn(name) and code == 0 else None
    predicted = None
    if (target / "model.yaml").exists():
        predicted, _ = runner.call(
            target / "predict.json", target / "predict_stderr.txt",
            ["predict", str(target / "model.yaml"), str(folder / "sealed" / name / "sealed.csv"),
             "--out", str(target / "predicted.csv"), "--json"],
        )  # fmt: skip
    run = {
        "exit": code, "seconds": round(seconds, 2), "predict_exit": predicted, "pages": whole,
    }  # fmt: skip
    (target / "run.json").write_text(json.dumps(run), encoding="utf-8")


def digest(folder: Path) -> dict[str, str]:
    """SHA-256 of every file that is scored."""
    found = {}
    for path in sorted((folder / "answers").glob("*/*")):
        if path.name in ANSWER_FILES:
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            found[str(path.relative_to(folder / "answers"))] = content
    return found


def otherwise(folder: Path, name: str) -> bool:
    """Does a case come out otherwise in processes of its own than in the batch?"""

    def said(answers: str) -> list[bytes | None]:
        files = [folder / answers / name / file for file in SAID]
        return [file.read_bytes() if file.exists() else None for file in files]

    return said("answers") != said("again")


def freeze(folder: Path, batched: bool, again: Sequence[str] = ()) -> None:
    """Writes down what was answered, by which state of the program, and when."""
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True,
        check=False,
    ).stdout.strip()  # fmt: skip
    frozen = {
        "when": datetime.now(UTC).isoformat(timespec="seconds"),
        "program": commit,
        "batched": batched,
        "again": len(again),
        "otherwise": [name for name in again if otherwise(folder, name)],
        "files": digest(folder),
    }
    (folder / "frozen.json").write_text(json.dumps(frozen, indent=1), encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=300.0)
    parser.add_argument("--batch", action="store_true")
    parser.add_argument("--again", type=int, default=0, help="cases that are answered twice")
    parser.add_argument("--fresh", action="store_true", help="throw old answers away")
    given = parser.parse_args(arguments)
    folder = given.folder.resolve()
    if given.fresh:
        for answers in ("answers", "again"):
            shutil.rmtree(folder / answers, ignore_errors=True)
        (folder / "frozen.json").unlink(missing_ok=True)
    cases = sorted(path.name for path in (folder / "cases").iterdir())
    runner = Batched(given.timeout) if given.batch else Separate(given.timeout)
    twice = cases[: given.again] if given.batch else []  # names tell nothing of their content
    alone = Separate(given.timeout)
    started = time.perf_counter()
    with ThreadPoolExecutor(given.jobs) as pool:
        tasks = [pool.submit(answer, folder, name, runner) for name in cases]
        tasks += [pool.submit(answer, folder, name, alone, "again") for name in twice]
        for number, task in enumerate(tasks, 1):
            task.result()
            if number % 10 == 0 or number == len(tasks):
                print(f"{number}/{len(tasks)} in {time.perf_counter() - started:.0f} s", flush=True)
    freeze(folder, given.batch, twice)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
