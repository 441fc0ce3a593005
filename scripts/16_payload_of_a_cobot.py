"""How far a UR5e sags under its payload, near and far: the maker's geometry, assumed springs."""

import numpy as np

import sk120stiff as sk

robot = sk.load_robot("ur5e")
model = sk.base_model(robot)  # typical springs; `sk120stiff identify` finds those of your arm
payload = [0.0, 0.0, -5.0 * 9.81]  # N, at the flange

print("reach [mm]  sag [mm]  softest [N/mm]")
for elbow in (140, 110, 80, 50, 20):
    pose = np.radians([0, -90 + (140 - elbow) / 2, elbow, -90, -90, 0])
    found = sk.stiffness(model, pose, payload)
    x, y, z = robot.placement(pose, "tool0")[:3, 3]
    sag = -1e3 * found.deflection_equilibrium[2]
    print(f"{1e3 * np.hypot(x, y):10.0f}  {sag:8.3f}  {1e-3 * found.principal.values.min():14.1f}")
