"""Attack the command line and print, line by line, how many attacks were tried and how many held.

    python scripts/attacks.py                    # 2000 mutated files and 150 environments: an hour
    python scripts/attacks.py --only overwriting # one line
    python scripts/attacks.py --count 50         # fewer mutations of each kind of file

Held means: an answer or one message with exit code 0, 1 or 2, no internal error, no more than 60 s
of processor time, and every input as it was. The exit code is 1 if anything was lost.
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

from scripts import attacks_environments, attacks_outputs
from scripts.attacks_inputs import COMMANDS, mutated_inputs
from scripts.attacks_judge import Verdict

Line = Callable[[Path], Iterator[Verdict]]


def lines(count: int, first: int) -> dict[str, Line]:
    """Every line of the table by its name."""
    table: dict[str, Line] = {}
    for kind in COMMANDS:
        seeds = range(first, first + count)
        table[f"mutated {kind}"] = lambda folder, kind=kind, seeds=seeds: mutated_inputs(
            folder, kind, seeds, explain_every=20
        )
    for module, names in (
        (attacks_outputs, ("overwriting", "interrupts")),
        (attacks_environments, ("variables", "streams", "limits", "strangers")),
    ):
        table.update({name: getattr(module, name) for name in names})
    return table


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", help="a line of the table; may be repeated")
    parser.add_argument("--count", type=int, default=340, help="mutations of each kind of file")
    parser.add_argument("--seed", type=int, default=0, help="of the first mutation")
    asked = parser.parse_args()
    lost = 0
    print(f"{'attack':26}{'tried':>7}{'held':>7}{'slowest':>10}{'took':>9}")
    for name, line in lines(asked.count, asked.seed).items():
        if asked.only and name not in asked.only:
            continue
        begin = time.perf_counter()
        found: list[Verdict] = []
        with tempfile.TemporaryDirectory(prefix="attack-") as folder:
            for each in line(Path(folder) / "desk"):
                found.append(each)
                if each.loss:  # told at once: a line may take minutes
                    print(f"    LOST  {each.attack}\n          {each.loss}", flush=True)
        if not found:
            print(f"{name:26}{0:7}   could not be tried here", flush=True)
            continue
        held = sum(not each.loss for each in found)
        slowest = max((each.seconds for each in found), default=0.0)
        took = time.perf_counter() - begin
        print(f"{name:26}{len(found):7}{held:7}{slowest:8.1f} s{took:7.0f} s", flush=True)
        lost += len(found) - held
    return int(lost > 0)


if __name__ == "__main__":
    sys.exit(main())
