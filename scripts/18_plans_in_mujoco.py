"""Plans for public arms, held against MuJoCo's contacts and inverse dynamics on the same URDF.

Nothing of the toolkit's own physics judges here: MuJoCo reads the file, its shapes and masses, says
what touches, and what every motor must give.

Run from the repository:  python scripts/18_plans_in_mujoco.py [--poses 100]
"""

import argparse
import sys

sys.path.insert(0, ".")
from tests.plan.planned_rows import ARMS, rows_of

options = argparse.ArgumentParser()
options.add_argument("--poses", type=int, default=100, help="poses planned for each arm")
poses = options.parse_args().poses
print("arm                    rows  wrong  random poses that touch something")
bad = 0
for name in ARMS:
    count, wrong, random = rows_of(name, poses)
    bad += len(wrong)
    print(f"{name:22s} {count:4d}  {len(wrong):5d}  {100 * random:4.0f} %", flush=True)
    for fault in wrong:
        print(f"    {fault}")
sys.exit(int(bad > 0))
