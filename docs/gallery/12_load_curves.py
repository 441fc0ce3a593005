"""
Load against deflection
=======================

The three poses of the 2005 paper: what the tracker read, and what identified springs say.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "table2_measured.csv")
found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
said = sk.predict(found.model, readings).displacement

fig, axes = plt.subplots(1, 3, figsize=(7.2, 2.8), sharey=True)
for panel, pose in zip(axes, readings.poses):
    rows = readings.rows_of(pose)
    force = np.linalg.norm(readings.wrench[rows, :3], axis=1)
    for axis, name in enumerate("xyz"):
        (line,) = panel.plot(force, 1e3 * said[rows, axis], label=name)
        panel.plot(force, 1e3 * readings.displacement[rows, axis], "o", color=line.get_color())
    panel.set(title=f"pose {pose}", xlabel="load [N]")
axes[0].set_ylabel("displacement [mm]")
axes[0].legend()
plt.show()
