"""
Two causes at once
==================

A base that rocks and a gear with play, in one campaign. The gap falls step by step, and each step
has a name.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
base = sk.base_model(robot)
truth = base + sk.effect(robot, "base_rocking") + sk.effect(robot, "lost_motion", "joint_3_u")
truth = truth.with_public({
    "base_rocking:base_link.stiffness_x": 1e7,  # N·m/rad
    "base_rocking:base_link.stiffness_y": 8e6,
    "lost_motion:joint_3_u.half_width": 1.5e-4,  # rad
})  # fmt: skip
steps = sk.Schedule("ascending", levels=3)
made = sk.simulate(truth, sk.plan(truth, 20), noise=sk.NoiseModel(10e-6), schedule=steps, seed=1)
answer = sk.explain(base, made.measurements)
print(answer)

gap = [1e6 * step.heldout_rms for step in answer.steps]
plt.figure(figsize=(7.2, 2.4))
plt.barh([step.label for step in answer.steps], gap)
plt.axvline(1e6 * answer.noise_floor, color="gray", ls="--")
plt.gca().invert_yaxis()
plt.xlabel("gap on poses that no fit saw [µm rms per axis]; dashed: noise alone")
plt.show()
