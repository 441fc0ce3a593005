"""
How far does it bend?
=====================

The SK120 with the published springs, pushed down at the tool. Where an arm stands decides as much
as how hard it is pushed.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
model = sk.base_model(robot)
forces = np.linspace(0, 1000, 11)  # N
loads = np.zeros((len(forces), 6))
loads[:, 2] = -forces

for lean in (0, 25, 50):
    pose = np.radians([0, lean, -20, 0, -70, 0])
    sag = -model.deflect(np.tile(pose, (len(forces), 1)), loads)[:, 2]  # m
    plt.plot(forces, 1e3 * sag, label=f"upper arm leans {lean}°")
plt.gca().set(xlabel="force down at the tool [N]", ylabel="sag of the tool [mm]")
plt.legend()
plt.show()
