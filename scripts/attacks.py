"""Attack the command line and print, line by line, how many attacks were tried and how many held.

    python scripts/attacks.py                    # everything: an hour of processor time
    python scripts/attacks.py --only overwriting # one line; --list names them
    python scripts/attacks.py --count 50         # fewer mutations of each kind of file

Held means: an answer or one message with exit code 0, 1 or 2, no internal error, no more than 60 s
of processor time, every input as it was, and for data: nothing believed that no arm can have given.
The exit code is 1 if anything was lost. The attacks themselves are in tests/attacks.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.attacks import (
    bending,
    disks,
    environments,
    loads,
    maps,
    options,
    outputs,
    pages,
    readings,
    robots,
)
from tests.attacks.inputs import COMMANDS, mutated_inputs
from tests.attacks.judge import Verdict

Line = Callable[[Path], Iterator[Verdict]]


def lines(count: int, first: int) -> dict[str, Line]:
    """Every line of the table by its name."""
    table: dict[str, Line] = {}
    for kind in COMMANDS:
        seeds = range(first, first + count)
        table[f"mutated {kind}"] = lambda folder, kind=kind, seeds=seeds: mutated_inputs(
            folder, kind, seeds, explain_every=20
        )
    return {
        **table,
        "mutated robots": lambda folder: robots.mutated_robots(folder, 3 * count, first),
        "hostile robots": robots.hostile_robots,
        "options": lambda folder: options.options(folder, 2 * count, first),
        "overwriting": outputs.overwriting,
        "interrupts": outputs.interrupts,
        "variables": environments.variables,
        "streams": environments.streams,
        "limits": environments.limits,
        "strangers": environments.strangers,
        "damaged maps": maps.damage,
        "killed maps": maps.kills,
        "two runs on a map": maps.two_runs,
        "full disk": disks.full_disk,
        "garbage": readings.garbage,
        "slips of the pen": readings.slips,
        "scale slips": readings.scale_slips,
        "beyond buckling": bending.bending,
        "hostile requests": pages.hostile_requests,
        "floods": pages.floods,
        "load": loads.load_sizes,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", help="a line of the table; may be repeated")
    parser.add_argument("--list", action="store_true", help="the lines' names, and nothing else")
    parser.add_argument("--count", type=int, default=340, help="mutations of each kind of file")
    parser.add_argument("--seed", type=int, default=0, help="of the first mutation")
    asked = parser.parse_args()
    table = lines(asked.count, asked.seed)
    unknown = [name for name in asked.only or () if name not in table]
    if asked.list or unknown:
        print("\n".join(table) if asked.list else f"no line {unknown[0]!r}; see --list")
        return 2 if unknown else 0
    lost = 0
    print(f"{'attack':26}{'tried':>7}{'held':>7}{'slowest':>10}{'took':>9}")
    for name in asked.only or table:
        lost += _printed(name, table[name])
    return int(lost > 0)


def _printed(name: str, line: Line) -> int:
    """Run a line of the table and print it; how many attacks were lost."""
    begin = time.perf_counter()
    found: list[Verdict] = []
    with tempfile.TemporaryDirectory(prefix="attack-") as folder:
        for each in line(Path(folder) / "desk"):
            found.append(each)
            if each.loss:  # told at once: a line may take minutes
                print(f"    LOST  {each.attack}\n          {each.loss}", flush=True)
            elif each.told:
                print(f"    {each.attack}: {each.told}", flush=True)
    if not found:
        print(f"{name:26}{0:7}   could not be tried here", flush=True)
        return 0
    held = sum(not each.loss for each in found)
    slowest = max(each.seconds for each in found)
    took = time.perf_counter() - begin
    print(f"{name:26}{len(found):7}{held:7}{slowest:8.1f} s{took:7.0f} s", flush=True)
    return len(found) - held


if __name__ == "__main__":
    sys.exit(main())
