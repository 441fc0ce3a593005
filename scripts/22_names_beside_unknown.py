"""Are probabilities of names honest where the arm has an error that no catalogue has?

Arms with up to six causes and an error smooth in the joints, of three kinds and four sizes; 40 to
90 poses, a tracker of 20 µm of which nothing is stated. Positions come of code that shares nothing
with the product. Prints how many names were given at what probability, and how many of them hold.

Run from the repository:  python scripts/22_names_beside_unknown.py --campaigns 60
"""

import argparse
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from sk120stiff.explain.positions.run import explain_positions
from tests.positions.unknown_error import drawn

BINS = (0.0, 0.2, 0.5, 0.8, 0.95, 0.99, 1.01)


def main() -> None:
    """One line for every range of probabilities."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    given = parser.parse_args()
    stated, holds, there, found = list[float](), list[bool](), 0, 0
    for seed in range(given.seed, given.seed + given.campaigns):
        truth = drawn(seed)
        with tempfile.TemporaryDirectory() as folder:
            answer = explain_positions(*truth.read(Path(folder)))
        said = set[str]()
        for item in answer.findings:
            names = (item.effect.id, *item.alternatives)
            stated.append(item.probability)
            holds.append(truth.holds(*names))
            said |= set(names)
            if item.probability > 0.9 and not holds[-1]:
                print(f"seed {seed}: {item.effect.id} at P = {item.probability:.3f}")
        there, found = there + len(truth.true), found + len(truth.true & said)
    p, true = np.array(stated), np.array(holds)
    print(f"{'stated':>12} {'names':>6} {'mean':>6} {'hold':>6}")
    for low, high in pairwise(BINS):
        own = (p >= low) & (p < high)
        if own.any():
            line = f"{own.sum():6d} {p[own].mean():6.2f} {true[own].mean():6.2f}"
            print(f"{low:4.2f} to {min(high, 1.0):4.2f} {line}")
    print(f"Brier score {((p - true) ** 2).mean():.3f}; {found} of {there} causes are among names")


if __name__ == "__main__":
    main()
