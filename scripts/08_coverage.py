"""Do 95 % intervals hold the truth? Synthetic experiments from a generator of its own.

Run from the repository:  python scripts/08_coverage.py --count 1000
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.identify.coverage import experiments, table_of


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="number of experiments")
    parser.add_argument("--seed", type=int, default=2024)
    arguments = parser.parse_args()
    outcomes = []
    with tempfile.TemporaryDirectory() as folder:
        for done, found in enumerate(experiments(arguments.count, arguments.seed, Path(folder)), 1):
            outcomes += found
            if done % 25 == 0:
                print(f"{done} of {arguments.count} experiments", end="\r", file=sys.stderr)
    print(f"{arguments.count} experiments, seed {arguments.seed}: how often the truth is inside\n")
    print(
        f"{'parameters of':18} {'number':>7} {'95 % interval':>14} {'± 1.96 std':>11} {'miss':>6}"
    )
    for group, number, interval, linear, miss in table_of(outcomes):
        shares = f"{100 * interval:12.1f} % {100 * linear:9.1f} %"
        print(f"{group.replace('_', ' '):18} {number:7} {shares} {miss:6.2f}")
    print("\nmiss: root mean square of estimate minus truth, over the standard error; ideally 1.")


if __name__ == "__main__":
    main()
