"""Attacks on maps: damage to every file, two runs at once, kills."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import patch

from sk120stiff.workspace import mapping, verify_map
from tests.attacks.judge import Verdict, here
from tests.attacks.outputs import content

SMALL = 60  # points of a chunk, so that a small map has several
GRID = "joint_2_l=-40:30:10; joint_3_u=-90:20:10 deg"  # 96 points
LOAD = ("--wrench", "0,0,-490 N", "--wrench", "100,0,0 N", "--directions")


def flip(path: Path) -> None:
    """One bit."""
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def cut(path: Path) -> None:
    """The last byte is gone."""
    path.write_bytes(path.read_bytes()[:-1])


def empty(path: Path) -> None:
    """Nothing is left of it but its name."""
    path.write_bytes(b"")


def grow(path: Path) -> None:
    """Something follows it."""
    path.write_bytes(path.read_bytes() + b" ")


def remove(path: Path) -> None:
    """It is gone."""
    path.unlink()


HARMS: tuple[Callable[[Path], None], ...] = (flip, cut, empty, grow, remove)


def map_words(store: Path, grid: str = GRID) -> list[str]:
    """The command that makes a small map."""
    return ["map", "motoman_sk120", "--grid", grid, *LOAD, "--out", str(store)]


def damage(folder: Path, every: int = 1) -> Iterator[Verdict]:
    """Harm each file in each way: it is noticed, and mended by the command that is advised."""
    store = folder / "m.zarr"
    with patch.object(mapping, "FAST_POINTS", SMALL), patch.object(mapping, "SLOW_POINTS", SMALL):
        made = here("the map itself", *map_words(store))
        whole = content(store)
        if made.loss or not whole:
            yield Verdict("the map itself", made.loss or "no map", made.seconds)
            return
        attacks = [(name, harm) for name in sorted(whole) for harm in HARMS]
        for name, harm in attacks[::every]:
            harm(store / name)
            noticed = _noticed(store, name)
            found = here("", *map_words(store), codes=(0,))
            loss = found.loss or noticed or _other(content(store), whole)
            yield Verdict(f"{harm.__name__} {name}", loss, found.seconds)
            if loss:
                shutil.rmtree(store)
                here("", *map_words(store))


def _noticed(store: Path, name: str) -> str:
    from sk120stiff.errors import InputError

    try:
        check = verify_map(store)
    except InputError as error:  # without its manifest a map is not finished
        return "" if name == "manifest.json" else f"taken for unfinished: {error}"
    return "" if {*check.damaged, *check.missing} == {name} else "the damage is not noticed"


def _other(found: dict[str, bytes], whole: dict[str, bytes]) -> str:
    differing = [name for name in {*found, *whole} if found.get(name) != whole.get(name)]
    return f"not as it was: {sorted(differing)[:3]}" if differing else ""


# A map of many small chunks, so that it takes a while: program, store, seconds per chunk.
SLOW_MAP = f"""
import sys, time
from sk120stiff.workspace import mapping, store
mapping.FAST_POINTS = {SMALL}
write = store.MapStore.write_chunk
def slowly(self, chunk, **options):
    time.sleep({{pause}})
    return write(self, chunk, **options)
store.MapStore.write_chunk = slowly
from sk120stiff.cli.main import main
sys.exit(main(sys.argv[1:]))
"""
LONG = "joint_2_l=-40:30:5; joint_3_u=-90:20:5; joint_5_b=-30:30:30 deg"  # 1035 points


def start(store: Path, pause: float) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", SLOW_MAP.format(pause=pause), *map_words(store, LONG)],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def whole_map(folder: Path) -> dict[str, bytes]:
    reference = folder / "whole.zarr"
    with start(reference, 0.0) as run:
        run.communicate()
    return content(reference)


def kills(folder: Path, count: int = 33, seed: int = 0) -> Iterator[Verdict]:
    """Kill a run at a random moment, or twice; what is made then is the same byte for byte."""
    folder.mkdir(parents=True)
    whole, draw = whole_map(folder), random.Random(seed)
    for k in range(count):
        store = folder / f"{k}.zarr"
        for _ in range(draw.choice((1, 1, 2))):
            run = start(store, 0.02)
            wanted, deadline = draw.randrange(0, 16), time.monotonic() + 60.0
            while len(list(store.glob(".progress/*.json"))) < wanted and run.poll() is None:
                if time.monotonic() > deadline:
                    break
                time.sleep(0.003)
            time.sleep(draw.uniform(0.0, 0.05))
            run.send_signal(draw.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM)))
            run.communicate()
        with start(store, 0.0) as last:
            said = last.communicate()[1]
        loss = said[-200:] if last.returncode else _other(content(store), whole)
        left = [path.name for path in folder.iterdir() if path.name.startswith(f".{k}.zarr")]
        yield Verdict(f"kill {k}", loss or (f"left behind: {left}" if left else ""))
        shutil.rmtree(store, ignore_errors=True)


def two_runs(folder: Path, count: int = 8, seed: int = 0) -> Iterator[Verdict]:
    """Two runs on one store, some milliseconds apart: one makes it, the other says who does."""
    folder.mkdir(parents=True)
    whole, draw = whole_map(folder), random.Random(seed)
    for k in range(count):
        store, runs = folder / f"{k}.zarr", []
        for _ in range(2):
            runs.append(start(store, 0.03))
            time.sleep(draw.choice((0.0, 0.02, 0.2, 1.0)))
        said = [run.communicate()[1] for run in runs]
        codes = sorted(run.returncode for run in runs)
        loss = "" if codes in ([0, 0], [0, 2]) else f"exit codes {codes}: {said}"
        if codes == [0, 2] and not any(
            f"process {run.pid}" in text for run in runs for text in said
        ):
            loss = f"does not say who writes: {said}"
        yield Verdict(f"two runs {k}", loss or _other(content(store), whole))
        shutil.rmtree(store, ignore_errors=True)
