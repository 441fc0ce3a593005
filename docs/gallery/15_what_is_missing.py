"""
What is missing?
================

A campaign of 20 poses in which something is hidden. The model knows joint springs; `sk.explain`
names what else there is, adds it, and the gap shrinks to the noise.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "hidden_cause.csv")
answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
for finding in answer.findings:
    print(f"{finding.effect.sentence()} [{finding.effect.id}, P = {finding.probability:.2f}]")

place = np.arange(len(answer.steps))
plt.bar(place - 0.2, [1e6 * step.fit_rms for step in answer.steps], 0.38, label="fitted")
plt.bar(place + 0.2, [1e6 * step.heldout_rms for step in answer.steps], 0.38, label="held out")
plt.axhline(1e6 * answer.noise_floor, color="gray", ls="--", label="what noise alone makes")
plt.xticks(place, [step.label for step in answer.steps])
plt.ylabel("gap [µm rms per axis]")
plt.legend()
plt.show()
