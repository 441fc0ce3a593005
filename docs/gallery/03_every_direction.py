"""
Stiffness in every direction
============================

Force per displacement along the push, over all directions in the horizontal and the vertical plane.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
found = sk.stiffness(sk.base_model(robot), np.radians([0, 20, -30, 0, -60, 0]), np.zeros(6))
compliance = found.compliance_enhanced[:3, :3]  # m/N

angle = np.linspace(0, 2 * np.pi, 361)
fig, axes = plt.subplots(1, 2, subplot_kw={"projection": "polar"}, figsize=(7.2, 3.4))
for panel, (i, k), name in zip(axes, ((0, 1), (0, 2)), ("seen from above", "seen from the side")):
    u = np.zeros((361, 3))
    u[:, i], u[:, k] = np.cos(angle), np.sin(angle)
    along = np.einsum("ni,ij,nj->n", u, compliance, u)  # m/N, in the direction of the push
    panel.plot(angle, 1e-3 / along)
    panel.set_title(f"{name} [N/mm]")
plt.show()
