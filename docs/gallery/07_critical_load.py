"""
The load at which an arm gives way
==================================

`critical_factor` says by how much a load must grow until K_θ − K_C is no longer positive definite:
the arm would buckle. For the SK120 that is far away; for springs a hundred times softer it is not.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
springs = sk.base_model(robot).joint_stiffness()
lean = np.linspace(-10, 60, 29)  # deg
for softer in (1, 10, 100):
    model = sk.joint_spring_model(robot, springs / softer)
    poses = np.radians([[0, angle, -30, 0, -60, 0] for angle in lean])
    unit = [0, 0, -1.0, 0, 0, 0]  # N
    load = [sk.stiffness(model, pose, unit).critical_factor for pose in poses]
    plt.semilogy(lean, np.array(load) / 1e3, label=f"springs {softer} times softer")
plt.axhline(1.0, color="gray", ls="--", label="1 kN, a heavy milling force")
plt.gca().set(xlabel="joint 2 [deg]", ylabel="force down that it cannot hold [kN]")
plt.legend(loc="upper left", ncols=2)
plt.ylim(top=3e3)
plt.show()
