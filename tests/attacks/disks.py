"""A disk that fills up while something is written to it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.attacks.judge import Verdict
from tests.attacks.maps import LONG, SLOW_MAP, map_words

# A file system of its own that is small: fill it, look, make room, go on.
DISK = """
import json, os, subprocess, sys
place, size, words = sys.argv[1], sys.argv[2], sys.argv[3:]
mount = ["mount", "-t", "tmpfs", "-o"]
subprocess.run([*mount, f"size={size}k", "tmpfs", place], check=True)
os.chdir(place)
def run():
    from pathlib import Path
    done = subprocess.run(words, capture_output=True, text=True)
    files = {str(p): p.stat().st_size for p in Path(".").rglob("*") if p.is_file()}
    return {"code": done.returncode, "said": done.stderr, "files": files}
first = run()
subprocess.run([*mount, "remount,size=64m", "tmpfs", place], check=True)
print(json.dumps([first, run()]))
"""


def can_mount() -> bool:
    """May this process have a file system of its own?"""
    if os.geteuid() != 0 or shutil.which("unshare") is None:
        return False
    return (
        subprocess.run(["unshare", "-m", "true"], capture_output=True, check=False).returncode == 0
    )


def full_disk(
    folder: Path, sizes: tuple[int, ...] = (8, 40, 80, 120, 200, 280)
) -> Iterator[Verdict]:
    """A disk that fills up while a map, a model or a page is written; only where one can be had.

    What was begun is finished by the same command when there is room; single files are whole or
    not there.
    """
    folder.mkdir(parents=True)
    if not can_mount():
        return
    data = Path(__file__).resolve().parents[2] / "robots/motoman_sk120/data/table2_measured.csv"
    program = [sys.executable, "-m", "sk120stiff"]
    mapped = [sys.executable, "-c", SLOW_MAP.format(pause=0.0), *map_words(Path("m.zarr"), LONG)]
    single = {
        "identify": [*program, "identify", str(data), "--out", "found.yaml"],
        "view": [*program, "view", "motoman_sk120", "--static", "scene.html"],
        "explain": [*program, "explain", str(data), "--out", "answer"],
    }
    tries = [("map", size, mapped) for size in sizes]
    tries += [(name, size, words) for name, words in single.items() for size in (4, 300)]
    for name, size, words in tries:
        done = subprocess.run(
            ["unshare", "-m", sys.executable, "-c", DISK, str(folder), str(size), *words],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        yield Verdict(f"{name} on a disk of {size} kB", _after_full(name, done))


def _after_full(name: str, done: subprocess.CompletedProcess[str]) -> str:
    if done.returncode:
        return done.stderr[-300:]
    first, then = json.loads(done.stdout)
    for word in ("Internal error", "Traceback"):
        if word in first["said"] + then["said"]:
            return f"{word}: {first['said'][-200:]}"
    if then["code"] != 0:
        return f"with room: exit code {then['code']}: {then['said'][-200:]}"
    if first["code"] == 0:
        return ""
    said = first["said"].lower()
    if not any(word in said for word in ("disk is full", "no space left", "are free")):
        return f"does not say that the disk is full: {first['said'][-200:]}"
    whole = then["files"]  # what is there is there as a whole, and nothing beside it
    half = [file for file, size in first["files"].items() if whole.get(file) != size]
    return f"half written: {half}" if half and name != "map" else ""
