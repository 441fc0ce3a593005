"""Put faults into physics and inference, one at a time, and print which ones the tests see.

    python scripts/mutations.py                  # all of them: a quarter of an hour
    python scripts/mutations.py --only "K_C"     # those whose name holds these words
    python scripts/mutations.py --check          # does every fault still find its line?

Each fault is one piece of text that another replaces, in a copy of the repository; the tests that
own the file run there until the first fails. A fault that no test sees has survived.
The exit code is 1 if any survived, or could not be tried.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from scripts.mutations_table import FAULTS, Fault

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 900  # s for the tests of one fault; a fault that hangs them is seen too


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", help="words in the name of a fault")
    parser.add_argument("--check", action="store_true", help="apply every fault, run no test")
    asked = parser.parse_args()
    chosen = [fault for fault in FAULTS if not asked.only or asked.only in fault.name]
    if asked.check:
        lost = [fault for fault in chosen if spoilt(ROOT, fault) is None]
        for fault in lost:
            print(f"not found exactly once: {fault.name} in {fault.file}")
        print(f"{len(chosen) - len(lost)} of {len(chosen)} faults find their line")
        return int(bool(lost))
    counts = {"killed": 0, "SURVIVED": 0, "not tried": 0}
    with tempfile.TemporaryDirectory(prefix="mutations-") as place:
        copy = Path(place) / "copy"
        ignored = shutil.ignore_patterns(".git", ".venv", "__pycache__", ".*_cache")
        shutil.copytree(ROOT, copy, ignore=ignored)
        sound: dict[tuple[str, ...], bool] = {}
        for fault in chosen:
            if fault.tests not in sound:  # tests that fail by themselves see nothing
                sound[fault.tests] = passes(copy, fault.tests)
            begin = time.perf_counter()
            became = seen(copy, fault) if sound[fault.tests] else "not tried"
            counts[became] += 1
            took = time.perf_counter() - begin
            print(f"{became:10}{took:6.0f} s  {fault.name} ({fault.file})", flush=True)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return int(counts["killed"] < len(chosen))


def seen(copy: Path, fault: Fault) -> str:
    """Put the fault in, run the tests that own the file, take it out."""
    file = copy / fault.file
    sound, broken = file.read_text(encoding="utf-8"), spoilt(copy, fault)
    if broken is None:
        return "not tried"
    file.write_text(broken, encoding="utf-8")
    try:
        return "SURVIVED" if passes(copy, fault.tests) else "killed"
    finally:
        file.write_text(sound, encoding="utf-8")


def spoilt(root: Path, fault: Fault) -> str | None:
    """The file's text with the fault in it; None where its line is not there exactly once."""
    text = (root / fault.file).read_text(encoding="utf-8")
    return text.replace(fault.old, fault.new) if text.count(fault.old) == 1 else None


def passes(copy: Path, tests: tuple[str, ...]) -> bool:
    """Do these tests pass in the copy?"""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    environment = {**os.environ, "PYTHONPATH": str(copy), "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, timeout=LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


if __name__ == "__main__":
    sys.exit(main())
