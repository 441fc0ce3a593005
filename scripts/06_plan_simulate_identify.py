"""Plan fifteen poses, simulate the measurement, identify the springs, and hold them to the truth.

Run from the repository:  python scripts/06_plan_simulate_identify.py
"""

import numpy as np

from sk120stiff.effects import effect
from sk120stiff.identify import fit, fit_report
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import base_model
from sk120stiff.plan import Cell, Schedule, d_optimal, random_pool, simulate
from sk120stiff.robot import load_robot

robot = load_robot("motoman_sk120")
springs = base_model(robot)
assert springs is not None
model = springs + effect(robot, "base_rocking")  # what is to be known: springs and foundation

point = np.array([-0.06, 0.04, 0.15])  # m, in the tool frame
pool = random_pool(robot, poses=300, directions=12, force=400.0, point=point, cell=Cell(floor=-1.0))
design = d_optimal(model, pool, count=15, sigma=10e-6)
chosen = pool.situation.rows(np.array(design.rows))
plan = Measurements(
    pose=tuple(f"p{k + 1}" for k in range(15)),
    joint_names=robot.actuated,
    joints=chosen.a,
    wrench=chosen.wrench,
    displacement=None,
    robot=robot.source,
    point=point,
)

truth = model.with_public(
    **{
        "base_rocking:base_link.stiffness_x": 1.2e7,
        "base_rocking:base_link.stiffness_y": 0.8e7,
    }
)
schedule = Schedule("ascending", levels=5)
made = simulate(truth, plan, noise=NoiseModel(10e-6), schedule=schedule, seed=1)
found = fit(model, made.measurements)

print(fit_report(found))
print()
for parameter, (low, high) in zip(found.parameters, found.intervals(), strict=True):
    true = truth.parameter(parameter.name).value
    inside = "inside" if low <= true <= high else "OUTSIDE"
    print(f"{parameter.name:40} truth {true:.4e}, 95 % {low:.4e} .. {high:.4e}: {inside}")
