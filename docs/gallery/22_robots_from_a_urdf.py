"""
Any arm with a URDF
===================

A UR10 and a Panda from the package `example-robot-data`, with springs that are guesses of the right
size. Put in the path of your own URDF.
"""

from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

home = next(p for p in files("cmeel").parent.rglob("example-robot-data/robots") if p.is_dir())
arms = {
    "UR10": (home / "ur_description/urdf/ur10_robot.urdf", [5e4, 5e4, 3e4, 1e4, 1e4, 1e4],
             [20, -70, 90, -110, -90, 10]),
    "Panda": (home / "panda_description/urdf/panda.urdf", [1.4e4] * 4 + [9e3] * 3,
              [0, -45, 0, -135, 0, 90, 45]),
}  # fmt: skip
forces = np.linspace(0, 50, 11)  # N, down
for name, (urdf, springs, pose) in arms.items():
    robot = sk.load_robot(urdf)
    model = sk.joint_spring_model(robot, springs)  # N·m/rad
    loads = np.zeros((11, 6))
    loads[:, 2] = -forces
    sag = -model.deflect(np.tile(np.radians(pose), (11, 1)), loads)[:, 2]
    plt.plot(forces, 1e3 * sag, "o-", label=f"{name}, {robot.n} joints")
plt.gca().set(xlabel="force down at the tool [N]", ylabel="sag [mm]")
plt.legend()
plt.show()
