"""Do 95 % intervals of predicted deflections hold the truth at new poses? Two arms, and each with
structure that the fitted model lacks, seen or too faint for that. The data come
from a generator of their own.

Run from the repository:  python scripts/10_prediction_coverage.py --count 200
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.identify.prediction_coverage import KINDS, campaigns, share_inside


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="number of campaigns of each kind")
    parser.add_argument("--seed", type=int, default=2026)
    arguments = parser.parse_args()
    print(f"{arguments.count} campaigns of each kind, seed {arguments.seed}; rms in µm\n")
    print(
        f"{'kind':28} {'95 % hold':>14} {'parameters alone':>17} {'± par.':>7} {'± rem.':>7} "
        f"{'miss':>6} {'remainder found':>16}"
    )
    for kind in KINDS:
        found = []
        with tempfile.TemporaryDirectory() as folder:
            for done in campaigns(kind, arguments.count, arguments.seed, Path(folder)):
                found.append(done)
                if len(found) % 25 == 0:
                    print(f"{len(found)} of {arguments.count}", end="\r", file=sys.stderr)
        share, error = share_inside(found)
        alone, _ = share_inside(found, remainder=False)
        sizes = [
            1e6 * np.sqrt(np.mean([np.mean(getattr(one, name) ** 2) for one in found]))
            for name in ("std_parameters", "std_remainder", "miss")
        ]
        shown = np.mean([one.significant for one in found])
        print(
            f"{kind.label:28} {100 * share:6.1f} ± {100 * error:3.1f} % {100 * alone:15.1f} % "
            f"{sizes[0]:7.2f} {sizes[1]:7.2f} {sizes[2]:6.2f} {100 * shown:14.0f} %"
        )
    print("\n95 % hold: parameters and remainder together, ± from campaign to campaign.")


if __name__ == "__main__":
    main()
