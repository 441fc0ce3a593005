"""
Which poses are worth measuring?
================================

Six planned poses against sixty draws of six random ones: how well the springs would be known.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

model = sk.base_model(sk.load_robot("motoman_sk120"))
many = sk.plan(model, 60, seed=1)  # poses within limits, to draw from
noise = sk.NoiseModel(10e-6)


def errors(readings):
    """Standard errors of the springs in per cent, from simulated readings."""
    found = sk.fit(model, sk.simulate(model, readings, noise=noise).measurements, noise=noise)
    return [100 * p.std / p.value for p in found.parameters]


rng = np.random.default_rng(0)
drawn = [rng.choice(many.n_readings, 6, replace=False) for _ in range(60)]
random = np.array([errors(many.select(rows)) for rows in drawn])
planned = errors(sk.plan(model, 6, sigma=10e-6))

names = [p.effect.where for p in model.parameters]
plt.boxplot(random, tick_labels=names, whis=(0, 100))
plt.plot([1, 2, 3], planned, "r*", ms=12, label="six planned readings")
plt.ylabel("standard error of the spring [%]")
plt.legend()
plt.show()
