"""
A row that should not be there
==============================

Readings are a pandas table whenever you like: look, mask what you know to be wrong, go on. Nothing
is deleted, and a robust fit finds such rows by itself.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
model = sk.base_model(sk.load_robot("motoman_sk120"))
frame = sk.read(data / "table2_measured.csv").to_frame()
frame.loc[7, "dz[mm]"] += 0.3  # somebody touched the arm

settings = {"robot": "motoman_sk120", "displacement": {"zero": "shared"}}
spoilt = sk.Measurements.from_frame(frame, **settings)
masked = sk.Measurements.from_frame(frame.assign(use=(frame.index != 7).astype(int)), **settings)
fits = {
    "as read": sk.fit(model, spoilt),
    "robust": sk.fit(model, spoilt, robust=True),
    "masked": sk.fit(model, masked),
}
print("trusted less than the others: row", fits["robust"].down_weighted.tolist())
for name, found in fits.items():
    change = [p.value / q.value - 1 for p, q in zip(found.parameters, fits["masked"].parameters)]
    plt.plot(100 * np.array(change), "o-", label=name)
plt.xticks(range(3), [p.effect.where for p in model.parameters])
plt.ylabel("spring, from that without the row [%]")
plt.legend()
plt.show()
