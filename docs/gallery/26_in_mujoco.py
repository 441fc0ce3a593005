"""
The same arm in MuJoCo
======================

`sk.export` writes the arm with its springs as an MJCF file. MuJoCo, which shares no code with this
package, lets it sag under the same load to the same place.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import sk120stiff as sk

model = sk.base_model(sk.load_robot("motoman_sk120"))
pose = np.radians([0, 20, -30, 0, -60, 0])
file = Path(tempfile.mkdtemp()) / "sk120.xml"
sk.export(model, file, pose=pose)
arm = mujoco.MjModel.from_xml_path(str(file))
data, tool = mujoco.MjData(arm), arm.site("tool0").id

mujoco.mj_resetDataKeyframe(arm, data, 0)
data.ctrl[:] = pose
mujoco.mj_forward(arm, data)
start, body, sag = data.site_xpos[tool].copy(), arm.site_bodyid[tool], []
for _ in range(2000):
    place, data.qfrc_applied[:] = data.site_xpos[tool], 0
    force, moment = np.array([0, 0, -490.0]), np.zeros(3)
    mujoco.mj_applyFT(arm, data, force, moment, place, body, data.qfrc_applied)
    mujoco.mj_step(arm, data)
    sag.append(1e3 * (start - data.site_xpos[tool])[2])
plt.plot(1e3 * arm.opt.timestep * np.arange(2000), sag, label="MuJoCo, let go at once")
plt.axhline(-1e3 * model.deflect(pose, [0, 0, -490, 0, 0, 0])[0, 2], color="k", ls="--",
            label="this package, at rest")  # fmt: skip
plt.gca().set(xlabel="time [ms]", ylabel="sag by 490 N [mm]")
plt.legend()
plt.show()
