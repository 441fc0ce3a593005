"""
Stiff one way, soft the other
=============================

A force of the same size in every direction of the vertical plane moves the tool along an ellipse.
Its long axis is the softest direction.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
pose = np.radians([0, 20, -30, 0, -60, 0])
found = sk.stiffness(sk.base_model(robot), pose, wrench=np.zeros(6))
print("principal stiffness [N/mm]:", np.round(found.principal.values / 1e3).tolist())

angle = np.linspace(0, 2 * np.pi, 181)
force = 500 * np.stack([np.cos(angle), 0 * angle, np.sin(angle)])  # N, in the plane x-z
moved = 1e3 * found.compliance_enhanced[:3, :3] @ force  # mm
plt.plot(moved[0], moved[2], label="displacement by 500 N")
plt.quiver(
    0,
    0,
    *(0.4 * found.principal.directions[[0, 2], 0]),
    scale=1,
    scale_units="xy",
    angles="xy",
    color="tab:red",
    label="softest direction",
)
plt.gca().set(xlabel="forward [mm]", ylabel="up [mm]", aspect="equal")
plt.legend(loc="upper left")
plt.show()
