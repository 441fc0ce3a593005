"""Slips of the pen: how many are found, and how often sound readings are doubted.

Run from the repository:  python scripts/11_data_checks.py --seeds 5 --blind 20
"""

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.data_checks.table import ARMS, Outcome, blind_readings, sound_readings, spoilt_readings


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="files of each slip and arm")
    parser.add_argument("--sound", type=int, default=30, help="sound files of each arm")
    parser.add_argument("--blind", type=int, default=20, help="sound files of each blind level")
    parser.add_argument("--seed", type=int, default=90210)
    given = parser.parse_args()
    arms = list(ARMS)
    print(f"{'slip':26} {'tried':>6} {'found':>6}   not found on")
    seeds = range(given.seed, given.seed + given.seeds)
    for what, outcomes in grouped(spoilt_readings(seeds, ["sk120", *arms]), "what"):
        missed = sorted(each.arm for each in outcomes if not each.right)
        found = len(outcomes) - len(missed)
        print(f"{what:26} {len(outcomes):6} {found:6}   {' '.join(missed)}")
    print(f"\n{'sound readings of':26} {'tried':>6} {'doubted':>7}")
    seeds = range(given.seed, given.seed + given.sound)
    levels = ["L0", "L1", "L5", "L6", "L7", "L8", "L9"]
    for sound in (
        sound_readings(seeds, arms),
        blind_readings(levels, given.blind, given.seed),
    ):
        for name, outcomes in grouped(sound, "arm"):
            wrong = [each for each in outcomes if not each.right]
            print(f"{name:26} {len(outcomes):6} {len(wrong):7}")
            for each in wrong[:3]:
                print(f"    {each.said}")


def grouped(outcomes: Iterable[Outcome], key: str) -> list[tuple[str, list[Outcome]]]:
    groups: dict[str, list[Outcome]] = defaultdict(list)
    for each in outcomes:
        groups[getattr(each, key)].append(each)
    return list(groups.items())


if __name__ == "__main__":
    main()
