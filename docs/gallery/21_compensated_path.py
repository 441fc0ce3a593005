"""
A path that is cut straight
===========================

Joint commands along a loaded line, as planned and corrected for the deflection, and what is left of
the correction when the springs are 10 % softer than believed.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
model = sk.base_model(robot)
share = np.linspace(0, 1, 60)
start, end = np.radians([-10, 15, -35, 0, -55, 0]), np.radians([25, 40, -15, 0, -75, 0])
path = start + share[:, None] * (end - start)
load = np.zeros((60, 6))
load[:, 1], load[:, 2] = 150, -400 - 150 * np.sin(4 * np.pi * share)  # N

mended = sk.compensate(model, path, load)
softer = sk.joint_spring_model(robot, 0.9 * model.joint_stiffness())
left = robot.placement(mended.a)[:, :3, 3] + softer.deflect(mended.a, load)
left = np.linalg.norm(left - robot.placement(path)[:, :3, 3], axis=1)
plt.plot(share, 1e6 * mended.before.distance, label="as planned")
plt.plot(share, 1e6 * left, label="corrected, springs 10 % softer than believed")
plt.plot(share, 1e6 * mended.after.distance, label="corrected, springs as believed")
plt.gca().set(xlabel="share of the path", ylabel="tool away from the path [µm]")
plt.legend()
plt.show()
