"""Springs from positions under weight alone: do intervals hold, and are errors near the bound?

An arm of 159 kg with all joint frames a little off, 50 poses, a tracker of 30 µm, everything free.
The positions are those of code that shares nothing with the product.

Run from the repository:  python scripts/14_positions_coverage.py --campaigns 200
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import sk120stiff as sk
from sk120stiff.identify.absolute.calibrate import calibrate
from tests.absolute.arm import errors, poses, tracked, write

SETTINGS = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 30, unit: um}\n"
)
SPRINGS = ("j2", "j3", "j4", "j5")


def main() -> None:
    """Campaign after campaign, then one line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=200)
    given = parser.parse_args()
    arm, a = errors(0), poses(50, 77)
    truth = dict(zip(("j1", *SPRINGS, "j6"), arm.compliance, strict=True))
    exact = tracked(arm.stands(a)[0])
    folder = Path(tempfile.mkdtemp())
    off, bound, held, waves = [], [], [], 0
    for seed in range(given.campaigns):
        noise = 3e-5 * np.random.default_rng(seed).normal(size=exact.shape)
        data = sk.read(write(folder, a, exact + noise, SETTINGS))
        robot = sk.load_robot(data.robot, base="base", tool="tool")
        found = calibrate(sk.base_model(robot), data.with_joints(robot.actuated))
        waves += bool(found.waves)
        names = [p.name for p in found.fit.parameters]
        intervals = found.fit.intervals()
        own = [names.index(f"joint_springs:{joint}.stiffness") for joint in SPRINGS]
        fitted = [found.fit.parameters[k] for k in own]
        off.append([p.internal - truth[j] for p, j in zip(fitted, SPRINGS, strict=True)])
        bound.append([p.internal_std or np.nan for p in fitted])
        held.append(
            [
                intervals[k][0] <= 1.0 / truth[j] <= intervals[k][1]
                for k, j in zip(own, SPRINGS, strict=True)
            ]
        )
    ratio = np.sqrt(np.mean(np.square(off), axis=0)) / np.nanmedian(bound, axis=0)
    print(f"{given.campaigns} campaigns: 95 % intervals hold {100 * np.mean(held):.1f} %")
    for joint, share in zip(SPRINGS, ratio, strict=True):
        print(f"{joint}: rms error {share:.2f} of the Cramér–Rao bound")
    print(f"waves named where there are none: {waves}")


if __name__ == "__main__":
    main()
