"""
The gap, pose by pose
=====================

The paper's springs and identified ones, held against the same readings.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "table2_measured.csv")
paper = sk.base_model(sk.load_robot("motoman_sk120"))
found = sk.fit(paper, readings)

place = np.arange(len(readings.poses))
for k, (name, model) in enumerate({"the paper's": paper, "identified": found.model}.items()):
    gap = readings.displacement - sk.predict(model, readings).displacement  # m
    rms = [1e6 * np.sqrt(np.mean(gap[readings.rows_of(pose)] ** 2)) for pose in readings.poses]
    plt.bar(place + 0.4 * k - 0.2, rms, 0.38, label=f"{name} springs")
plt.xticks(place, [f"pose {pose}" for pose in readings.poses])
plt.ylabel("gap [µm rms per axis]")
plt.legend()
plt.show()
