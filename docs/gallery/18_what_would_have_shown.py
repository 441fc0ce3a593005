"""
What these readings could not have shown
========================================

"Nothing is missing" means little without the sizes that would have been seen. For stiffnesses that
is the largest one that shows: anything softer would have been named.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

data = sk.bundled_robots()["motoman_sk120"] / "data"
readings = sk.read(data / "table2_measured.csv")
answer = sk.explain(sk.base_model(sk.load_robot("motoman_sk120")), readings)
print(answer.verdict, "after", len(answer.smallest_detectable), "sizes were looked at")

tilts = [
    each
    for each in answer.smallest_detectable
    if each.value is not None and each.name.startswith(("joint_tilt", "base_rocking"))
]
plt.figure(figsize=(7.2, 0.8 + 0.3 * len(tilts)))
plt.barh([each.name for each in tilts], [each.value for each in tilts])
plt.gca().set(xlabel="seen if softer than [N·m/rad]", xscale="log")
plt.show()
