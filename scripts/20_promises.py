"""Does a plan keep its promise? Standard errors as promised, and as they come out.

Run from the repository:  python scripts/20_promises.py [--campaigns 200]
"""

import argparse

import numpy as np

from sk120stiff.identify import fit
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import Model, base_model, typical_model
from sk120stiff.plan import Schedule, plan, promised, simulate
from sk120stiff.robot import load_robot

SIGMA = 10e-6  # m
ARMS = {"motoman_sk120": ([-0.06, 0.04, 0.15], 400.0), "ur5e": ([0.05, 0.03, 0.1], 80.0)}


def realised(model: Model, poses: int, loads: int, point, force: float, campaigns: int):
    """Names, promised standard errors, and scatter of the estimates over the campaigns."""
    to_take = plan(model, poses, loads=loads, point=point, force=force, sigma=SIGMA)
    found = []
    for seed in range(campaigns):
        read = simulate(
            model, to_take, noise=NoiseModel(SIGMA), schedule=Schedule(zero="shared"), seed=seed
        ).measurements
        result = fit(model, read, noise=NoiseModel(SIGMA, zero="shared"))
        found.append(result.x * result.problem.scale)
    names = [model.names[k] for k in model.free]
    return names, promised(model, to_take, SIGMA), np.std(found, axis=0, ddof=1)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--campaigns", type=int, default=200)
    campaigns = options.parse_args().campaigns
    print("arm, poses x loads, parameter: scatter of the estimates over what was promised")
    for arm, (point, force) in ARMS.items():
        robot = load_robot(arm)
        model = base_model(robot) or typical_model(robot)
        for poses, loads in ((12, 1), (6, 3)):
            names, before, after = realised(model, poses, loads, point, force, campaigns)
            for name, ratio in zip(names, after / before, strict=True):
                print(f"{arm:14s} {poses:2d} x {loads}  {name:45s} {ratio:.3f}", flush=True)


if __name__ == "__main__":
    main()
