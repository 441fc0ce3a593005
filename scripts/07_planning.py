"""What planned readings are worth, against random poses and the paper's kind of spread.

The paper measured at twenty well-spaced poses with the tool upright, loaded along orthogonal axes.

Run from the repository:  python scripts/07_planning.py
"""

import numpy as np

from sk120stiff.effects import effect, load_case
from sk120stiff.model import Model, base_model
from sk120stiff.plan import (
    Cell,
    Pool,
    d_optimal,
    feasible,
    random_choice,
    random_pool,
    random_poses,
    rivalry,
    well_spread,
)
from sk120stiff.robot import load_robot

SIGMA = 10e-6  # m
POINT = np.array([-0.06, 0.04, 0.15])  # m, in the tool frame
FORCE = 400.0  # N
DRAWS = 50

robot = load_robot("motoman_sk120")
springs = base_model(robot)
assert springs is not None
cell = Cell(floor=-1.0)
pool = random_pool(robot, poses=400, directions=12, force=FORCE, point=POINT, cell=cell, seed=0)


def upright_pool() -> Pool:
    """Poses with the tool axis vertical, loads along x, y, z: what the paper chose from."""
    rng = np.random.default_rng(1)
    a = random_poses(robot, 4000, rng)
    a[:, 3] = 0.0
    a[:, 4] = -0.5 * np.pi - a[:, 2]  # theta_3 + theta_5 = -90 deg: straight down
    good = feasible(robot, cell, a, point=POINT).ok
    good &= (a[:, 4] >= robot.lower[4]) & (a[:, 4] <= robot.upper[4])
    loads = np.zeros((3, 6))
    loads[:, :3] = FORCE * np.eye(3)
    a = a[good][:400]
    return Pool(load_case(robot, np.repeat(a, 3, axis=0), np.tile(loads, (len(a), 1)), point=POINT))


def precision(name: str, model: Model, count: int) -> None:
    design = d_optimal(model, pool, count=count, sigma=SIGMA)
    paper = d_optimal(model, upright, count=count, sigma=SIGMA)  # its `worth_of` judges that pool
    rng = np.random.default_rng(2)
    random = [design.gain_over(random_choice(pool, count, rng)) for _ in range(DRAWS)]
    spread = [
        np.exp(design.worth - paper.worth_of(well_spread(upright, count, rng)))
        for _ in range(DRAWS)
    ]
    row = f"{np.median(random):9.2f} {np.min(random):6.2f} {np.median(spread):9.2f}"
    print(f"{name:44} {count:5} {row} {np.min(spread):6.2f}")


def evidence(first: str, second: str, count: int) -> None:
    one, two = (effect(robot, *text.split(":")) for text in (first, second))
    rivals = rivalry(springs, one, two, pool, sigma=SIGMA)
    upright_rivals = rivalry(springs, one, two, upright, sigma=SIGMA)
    after = rivals.best(count).after
    rng = np.random.default_rng(3)
    random = [after / rivals.evidence_of(random_choice(pool, count, rng)) for _ in range(DRAWS)]
    spread = [
        after / upright_rivals.evidence_of(well_spread(upright, count, rng)) for _ in range(DRAWS)
    ]
    row = f"{np.median(random):9.2f} {np.min(random):6.2f} {np.median(spread):9.2f}"
    print(f"{f'{first} | {second}':44} {count:5} {row} {np.min(spread):6.2f}  {after:8.1f}")


upright = upright_pool()
print("D-optimal: standard errors, how many times smaller than those of ...")
print(f"{'':44} {'count':>5} {'random':>9} {'best':>6} {'spread':>9} {'best':>6}")
precision("three joint springs", springs, 5)
precision("three joint springs", springs, 20)
precision("springs, foundation", springs + effect(robot, "base_rocking"), 20)
precision("springs, upper arm", springs + effect(robot, "link_torsion", "link_2_l"), 20)
precision("springs, wrist", springs + effect(robot, "joint_springs", "joint_5_b"), 20)

print("\nT-optimal: evidence between two effects, how many times that of ...")
print(f"{'':44} {'count':>5} {'random':>9} {'best':>6} {'spread':>9} {'best':>6}  evidence")
evidence("link_bending:link_3_u", "joint_tilt:joint_2_l", 5)
evidence("base_rocking:base_link", "joint_tilt:joint_2_l", 5)
evidence("link_torsion:link_2_l", "joint_tilt:joint_1_s", 5)
evidence("joint_springs:joint_5_b", "closure_rod:rod", 5)
