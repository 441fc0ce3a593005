"""
A long tool makes a soft arm
============================

The force acts on a spindle at some distance from the flange. Where it acts is an argument; nothing
in the model changes.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("ur5e")
model = sk.base_model(robot)
pose = np.radians([0, -70, 90, -110, -90, 10])
length = np.linspace(0, 0.4, 9)  # m, along the tool's own axis

for axis, name in enumerate("xyz"):
    load = np.zeros(6)
    load[axis] = 50  # N
    moved = [np.linalg.norm(model.deflect(pose, load, point=[0, 0, reach])) for reach in length]
    plt.plot(1e3 * length, 1e3 * np.array(moved), "o-", label=f"50 N along {name}")
plt.gca().set(xlabel="distance of the tool tip from the flange [mm]", ylabel="tip moves [mm]")
plt.legend()
plt.show()
