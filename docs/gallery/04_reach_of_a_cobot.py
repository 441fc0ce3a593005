"""
A cobot with its payload, near and far
======================================

How far a UR5e sags under 5 kg: the maker's geometry, and springs that are typical of such arms. The
springs of your own arm come from a measurement, see :doc:`/howto/six_poses`.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("ur5e")
model = sk.base_model(robot)
payload = [0, 0, -5 * 9.81, 0, 0, 0]  # N, at the flange

reach, sag = [], []
for elbow in np.linspace(140, 20, 13):
    pose = np.radians([0, -90 + (140 - elbow) / 2, elbow, -90, -90, 0])
    x, y, _ = robot.placement(pose)[:3, 3]
    reach.append(1e3 * np.hypot(x, y))
    sag.append(-1e3 * sk.stiffness(model, pose, payload).deflection_equilibrium[2])
    print(f"{reach[-1]:6.0f} mm out: {sag[-1]:.3f} mm down")

plt.plot(reach, sag, "o-")
plt.gca().set(xlabel="reach [mm]", ylabel="sag by 5 kg [mm]")
plt.show()
