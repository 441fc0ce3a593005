"""
Why causes can be told apart
============================

Each effect moves the tool by its own pattern over poses and loads. Two effects whose patterns are
alike cannot be told apart by these readings; other poses may tell.
"""

import matplotlib.pyplot as plt
import numpy as np

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
base = sk.base_model(robot)
plan = sk.plan(base, 20)
places = {
    "base_rocking": "base_link",
    "joint_tilt": "joint_2_l",
    "link_torsion": "link_2_l",
    "link_bending": "link_3_u",
    "tool_compliance": "tool0",
}
patterns, names = [], []
for name, where in places.items():
    added = base + sk.effect(robot, name, where)
    for parameter in added.parameters[len(base.parameters) :]:
        soft = added.with_public({parameter.name: parameter.spec.public(parameter.spec.typical)})
        moved = (sk.predict(soft, plan).displacement - sk.predict(base, plan).displacement).ravel()
        if not moved.any():  # a twist about the line of pure forces shows in no reading
            continue
        patterns.append(moved / np.linalg.norm(moved))
        names.append(parameter.name.split(".")[0].replace(":", "\n"))
plt.figure(figsize=(7.2, 5.4))
plt.imshow(np.abs(np.array(patterns) @ np.array(patterns).T), cmap="magma", vmin=0, vmax=1)
plt.grid(visible=False)
plt.colorbar(label="likeness of the patterns")
plt.xticks(range(len(names)), names, rotation=90, fontsize=6)
plt.yticks(range(len(names)), names, fontsize=6)
plt.show()
