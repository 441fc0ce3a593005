"""
Where is it softest?
====================

The least stiffness over all directions, for joints 2 and 3 through their range. `sk120stiff map`
does this for whole workspaces; a slice is quickly drawn by hand.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
model = sk.base_model(robot)
second, third = np.linspace(-60, 60, 25), np.linspace(-100, 30, 27)  # deg
least = np.zeros((len(third), len(second)))
for i, u in enumerate(third):
    for k, lower in enumerate(second):
        pose = np.radians([0, lower, u, 0, -60, 0])
        J = robot.jacobian(pose)[:3]  # m/rad
        compliance = J / model.joint_stiffness() @ J.T  # m/N
        least[i, k] = 1e-3 / np.linalg.eigvalsh(compliance)[-1]

plt.contourf(second, third, least, levels=12, cmap="viridis")
plt.colorbar(label="least stiffness [N/mm]")
plt.plot(*(float(v) for v in (second[least.min(0).argmin()], third[least.min(1).argmin()])), "r*")
plt.gca().set(xlabel="joint 2 [deg]", ylabel="joint 3 [deg]")
plt.show()
