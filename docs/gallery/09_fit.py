"""
Springs from measured deflections
=================================

Three poses, fifteen readings, three springs. Every point would lie on the line if the model were
the arm and the tracker had no noise.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "table2_measured.csv")
found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
print(found.to_frame().to_string(index=False, float_format="{:.4g}".format))

measured, predicted = 1e6 * readings.displacement, 1e6 * (readings.displacement - found.gap)
for axis, name in enumerate("xyz"):
    plt.plot(measured[:, axis], predicted[:, axis], "o", label=f"along {name}")
plt.axline((0, 0), slope=1, color="gray", lw=0.8)
plt.gca().set(xlabel="measured [µm]", ylabel="predicted [µm]")
plt.legend()
plt.show()
