"""
A gear that stiffens
====================

A gear's spring is stiffer the more it carries. The curve follows from two numbers of the model, and
`sk.explain` finds them where loads are large enough.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
springs = sk.base_model(robot)
gear = springs + sk.effect(robot, "gear_hardening", "joint_3_u")
pose = np.radians([0, 20, -30, 0, -60, 0])
forces = np.linspace(-1500, 1500, 61)
loads = np.zeros((61, 6))
loads[:, 2] = forces
poses = np.tile(pose, (61, 1))

linear = springs.deflect(poses, loads)[:, 2]
for cubic in (2e-13, 4e-13, 8e-13):  # rad/(N·m)³
    model = gear.with_public({"gear_hardening:joint_3_u.cubic": cubic})
    away = 1e6 * (model.deflect(poses, loads)[:, 2] - linear)
    plt.plot(forces, away, label=f"cubic {cubic:.0e} rad/(N·m)³")
plt.gca().set(xlabel="vertical force [N]", ylabel="away from the straight line [µm]")
plt.legend()
plt.show()
