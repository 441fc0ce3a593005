"""
A measurement that never took place
===================================

`sk.simulate` reads a modelled arm as a tracker would: five load steps, a zero reading a pose, 10 µm
of noise. All rows of a pose subtract the same zero reading, so their errors go together.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

model = sk.base_model(sk.load_robot("motoman_sk120"))
plan = sk.plan(model, 6)
steps = sk.Schedule("ascending", levels=5)
made = sk.simulate(model, plan, noise=sk.NoiseModel(10e-6), schedule=steps, seed=4)

error = 1e6 * (made.measurements.displacement - made.exact)
for pose in made.measurements.poses:
    rows = made.measurements.rows_of(pose)
    plt.plot(rows, error[rows, 2], "o-", label=pose)
    plt.plot(rows, -1e6 * made.zero_error[rows, 2], color="gray", lw=0.8)
plt.gca().set(xlabel="number of the reading", ylabel="error along z [µm]")
plt.title("grey: what the pose's zero reading alone makes")
plt.legend(ncols=6, loc="lower center")
plt.show()
print(f"spread of one difference: {np.std(error):.1f} µm")
