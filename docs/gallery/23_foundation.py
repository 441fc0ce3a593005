"""
A soft floor looks like this
============================

What a rocking base adds to the deflection, over the turn of joint 1: the softer the floor, the more
the sag depends on which way the arm looks.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
springs = sk.base_model(robot)
turn = np.linspace(-180, 180, 73)
poses = np.radians([[angle, 20, -30, 0, -60, 0] for angle in turn])
load = [0, 0, -490, 0, 0, 0]  # N
names = [f"base_rocking:base_link.stiffness_{axis}" for axis in "xy"]

for stiff_x, stiff_y in ((1e8, 1e8), (1e7, 1e7), (1e7, 5e6)):
    model = springs + sk.effect(robot, "base_rocking")
    model = model.with_public(dict(zip(names, (stiff_x, stiff_y))))
    sag = -1e3 * model.deflect(poses, np.tile(load, (73, 1)))[:, 2]
    plt.plot(turn, sag, label=f"{stiff_x:.0e} and {stiff_y:.0e} N·m/rad about x and y")
plt.gca().set(xlabel="joint 1 [deg]", ylabel="sag by 490 N [mm]")
plt.legend()
plt.show()
