"""What is a pose's own taken for one draw or for noise: do intervals of springs hold, how wide?

Arms of 159 kg with all joint frames a little off, whose joints do not stand where encoders read; 30
poses, a tracker of 15 µm. Several markers are read at each pose, or one with and without a payload,
or both. Positions come of code that shares nothing with the product.

Run from the repository:  python scripts/21_shared_errors.py --campaigns 30
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import sk120stiff as sk
from sk120stiff.arrays import on_one_thread
from sk120stiff.identify.positions.calibrate import calibrate
from tests.positions.arm import errors
from tests.positions.shared import campaign

KINDS = {
    "3 markers, with and without payload": ("ABC", (0.0, 40.0)),
    "1 marker, with and without payload": ("A", (0.0, 40.0)),
    "3 markers under the arm's weight": ("ABC", (0.0,)),
}
alone = on_one_thread(calibrate)
JOINTS = range(1, 6)  # weight puts no torque on the first


def main() -> None:
    """One line a kind, each way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=30)
    parser.add_argument("--off", type=float, default=60.0, help="[µrad] of each joint of a pose")
    parser.add_argument("--seed", type=int, default=500)
    given = parser.parse_args()
    print(f"{'':36} {'taken for':>9} {'95 % hold':>14} {'width over value':>17}")
    for label, (markers, loads) in KINDS.items():
        held: dict[bool, list[bool]] = {True: [], False: []}
        width: dict[bool, list[float]] = {True: [], False: []}
        for seed in range(given.seed, given.seed + given.campaigns):
            with tempfile.TemporaryDirectory() as folder:
                seen = campaign(
                    Path(folder), seed, 30, loads=loads, markers=markers, off=1e-6 * given.off
                )
                model = sk.base_model(sk.load_robot(seen.robot, base="base", tool="tool"))
            truth = errors(seed).compliance
            for shared in held:
                found = alone(model, seen, shared=shared)
                names = (p.name for p in found.parameters)
                ends = dict(zip(names, found.intervals(), strict=True))
                for k in JOINTS:
                    low, high = ends[f"joint_springs:j{k + 1}.stiffness"]
                    if np.isfinite([low, high]).all():
                        held[shared].append(low <= 1.0 / truth[k] <= high)
                        width[shared].append((high - low) * truth[k])
        for shared, word in ((False, "noise"), (True, "one draw")):
            share = float(np.mean(held[shared]))
            error = float(np.sqrt(share * (1.0 - share) / len(held[shared])))
            print(
                f"{label:36} {word:>9} {100 * share:6.1f} ± {100 * error:3.1f} % "
                f"{100 * float(np.median(width[shared])):15.1f} %"
            )


if __name__ == "__main__":
    main()
