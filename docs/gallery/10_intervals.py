"""
How well is a spring known?
===========================

A stiffness is one over what readings show, so its interval is not symmetric. What fifteen readings
leave open shows when the fit is repeated with fewer of them.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "table2_measured.csv")
model = sk.base_model(sk.load_robot("motoman_sk120"))
fig, axes = plt.subplots(1, 3, sharey=True, figsize=(7.2, 2.6))
parts = {"all poses": readings}
parts |= {f"pose {pose}": readings.select(readings.rows_of(pose)) for pose in readings.poses}
for row, part in enumerate(parts.values()):
    found = sk.fit(model, part)
    for panel, p, (low, high) in zip(axes, found.parameters, found.intervals()):
        panel.plot([low / 1e6, min(high, 1e9) / 1e6], [row, row], "-", lw=3)
        panel.plot(p.value / 1e6, row, "ko")
        panel.set(title=p.effect.where, xlabel="10⁶ N·m/rad")
        if part is readings:  # intervals that are open upwards leave the picture
            panel.set_xlim(0, 2.2 * p.value / 1e6)
axes[0].set_yticks(range(len(parts)), parts)
plt.show()
