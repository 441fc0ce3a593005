"""Plans for public arms, held against MuJoCo's contacts and inverse dynamics on the same URDF.

Nothing of the toolkit's own physics judges here: MuJoCo reads the file, its shapes and masses, says
what touches, and what every motor must give. The way through the first poses of each plan is asked
every half degree.

Run from the repository:  python scripts/16_plans_in_mujoco.py [--poses 100] [--driven 12]
"""

import argparse
import sys

sys.path.insert(0, ".")
from tests.plan.planned_rows import ARMS, rows_of

options = argparse.ArgumentParser()
options.add_argument("--poses", type=int, default=100, help="poses planned for each arm")
options.add_argument("--driven", type=int, default=12, help="poses that are driven through")
options = options.parse_args()
print("arm                    rows  wrong  on the way  wrong  no way  random poses that touch")
bad = 0
for name in ARMS:
    found = rows_of(name, options.poses, driven=options.driven)
    wrong = [*found.wrong, *found.run_into]
    bad += len(wrong)
    print(
        f"{name:22s} {found.rows:4d}  {len(found.wrong):5d}  {found.on_the_way:10d}  "
        f"{len(found.run_into):5d}  {found.no_way:6d}  {100 * found.touching:4.0f} %",
        flush=True,
    )
    for fault in dict.fromkeys(wrong):
        print(f"    {fault}")
sys.exit(int(bad > 0))
