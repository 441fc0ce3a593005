"""How many readings until the right name: the pilot against random and D-optimal readings.

Run from the repository:  python scripts/19_pilot.py --campaigns 300 [--ask]
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.pilot import simulated
from tests.pilot.simulated import ARMS, MOST, POLICIES, Bench, Run, campaigns


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=300)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--off", type=float, default=simulated.OFF, help="log of springs' errors")
    parser.add_argument("--ask", action="store_true", help="confirm every stop by explain")
    parser.add_argument("--log", type=Path, help="one line for each run; gone on with if it exists")
    options = parser.parse_args()
    simulated.OFF = options.off
    done: list[Run] = []
    if options.log and options.log.is_file():
        done = [Run(**json.loads(line)) for line in options.log.read_text().splitlines()]
    benches = [Bench.of(arm) for arm in ARMS]
    for k in range(len(done) // len(POLICIES), options.campaigns):
        runs = list(campaigns(benches[k % len(benches)], options.seed + k, ask=options.ask))
        done += runs
        if options.log:
            with options.log.open("a", encoding="utf-8") as log:
                log.writelines(json.dumps(asdict(run)) + "\n" for run in runs)
    table(done)


def table(runs: Sequence[Run]) -> None:
    """Medians over the campaigns in which something was hidden; who never got there has most."""
    total = len(runs) // len(POLICIES)
    print(f"{total} campaigns")
    print(
        "policy       readings to the right name     pilot's share (95 %)   named  class  wrong  "
        "clean: false alarms"
    )
    print("             median   mean  where right")
    pilot = np.zeros(0)
    for policy in POLICIES:
        own = [run for run in runs if run.policy == policy]
        hidden = [run for run in own if run.truth != "none"]
        clean = [run for run in own if run.truth == "none"]
        counts = np.array([run.count if run.right else MOST for run in hidden])
        pilot = counts if policy == "pilot" else pilot
        told = np.mean([run.count for run in hidden if run.right])
        right = np.mean([run.right and run.reason == "named" for run in hidden])
        several = np.mean([run.right and run.reason == "class" for run in hidden])
        wrong = np.mean([run.wrong for run in own])
        alarms = sum(run.wrong for run in clean)
        print(
            f"{policy:11s} {np.median(counts):7.1f} {counts.mean():6.1f} {told:8.1f}       "
            f"{share(pilot, counts):>22s} {right:7.0%} {several:6.0%} {wrong:6.1%}"
            f"   {alarms} of {len(clean)}"
        )
    print("\nPilot's runs that were not right:")
    for run in runs:
        if run.policy == "pilot" and not run.right:
            names = " or ".join(run.names) or "nothing"
            print(f"  {run.arm} {run.truth} ({run.visible:.0f}): {run.reason} {names}, {run.count}")


def share(some: np.ndarray, others: np.ndarray) -> str:
    """Ratio of two means over the same campaigns, with its interval by bootstrap over these."""
    drawn = np.random.default_rng(0).integers(len(some), size=(5000, len(some)))
    ratios = some[drawn].mean(axis=1) / others[drawn].mean(axis=1)
    low, high = np.quantile(ratios, [0.025, 0.975])
    return f"{some.mean() / others.mean():.0%} ({low:.0%} to {high:.0%})"


if __name__ == "__main__":
    main()
