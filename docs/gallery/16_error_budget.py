"""
Who moves the point by how much?
================================

The error budget of an explained arm: what each effect brings at the measured loads, with its
standard error. The hidden effect is small beside the springs, and still seen. ``Options`` limits
the search to gears here.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "hidden_cause.csv")
gears = sk.Options(only=("gear_hardening", "lost_motion", "friction_hysteresis"))
answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings, options=gears)

names = [share.name for share in answer.budget]
plt.figure(figsize=(7.2, 2.4))
plt.barh(
    names,
    [1e6 * share.rms for share in answer.budget],
    xerr=[1e6 * share.std for share in answer.budget],
    capsize=4,
)
plt.gca().invert_yaxis()
plt.gca().set(xlabel="moves the point by [µm rms per axis]", xscale="log")
plt.show()
