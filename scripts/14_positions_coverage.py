"""Springs from positions under weight alone: do intervals hold, and are errors near the bound?

Arms of 159 kg with all joint frames a little off, 50 poses, a tracker of 30 µm, everything free.
The positions and the Cramér-Rao bound are those of code that shares nothing with the product.

Run from the repository:  python scripts/14_positions_coverage.py --campaigns 200
"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.positions.coverage import campaigns, told


def main() -> None:
    """Campaign after campaign, then one line a joint."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=200)
    parser.add_argument("--arms", type=int, default=20, help="that share them, each with own poses")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print(told(campaigns(given.campaigns, given.arms, given.seed)))


if __name__ == "__main__":
    main()
