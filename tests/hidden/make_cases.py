"""Makes sealed cases: `python -m tests.hidden.make_cases --count 20 --seed 1 --out FOLDER`.

FOLDER/cases/NAME/ is all that the program under test may see. FOLDER/truth/ and FOLDER/sealed/
belong to the scorer. Names say nothing about the level.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from .generator.build import BUILDERS, build
from .generator.position_case import PositionCase
from .generator.writing import write_case


def counts(text: str, count: int) -> dict[str, int]:
    """Cases of each level: ``L0=100,L1`` has 100 of L0 and `count` of L1."""
    parts = (item.partition("=") for item in text.split(","))
    return {level: int(own) if own else count for level, _, own in parts}


def names(wished: Mapping[str, int], seed: int) -> list[tuple[str, str, int]]:
    """(folder name, level, number), shuffled so that the name tells nothing."""
    wanted = [(level, number) for level, count in wished.items() for number in range(count)]
    shuffled = np.random.default_rng((seed, 4711)).permutation(len(wanted))
    return sorted((f"case_{place:04d}", *wanted[index]) for place, index in enumerate(shuffled))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--levels", default=",".join(BUILDERS), help="e.g. L0,L1 or L0=100,L1")
    parser.add_argument("--count", type=int, default=10, help="cases per level")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args(arguments)
    wished = counts(given.levels, given.count)
    started = time.perf_counter()
    listed = names(wished, given.seed)
    for name, level, number in listed:
        if (given.out / "truth" / f"{name}.json").exists():
            continue
        case = build(level, given.seed, number)
        folders = name, given.out / "cases", given.out / "truth"
        case.write(*folders) if isinstance(case, PositionCase) else write_case(case, *folders)
    about = {"seed": given.seed, "cases": wished}
    (given.out / "made.json").write_text(json.dumps(about), encoding="utf-8")
    print(f"{len(listed)} cases in {time.perf_counter() - started:.0f} s -> {given.out}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
