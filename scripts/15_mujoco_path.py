"""A loaded path in MuJoCo, with the commands as they are and with compensated ones.

    pip install mujoco
    python scripts/15_mujoco_path.py [FOLDER]

The SK120 on a foundation that rocks mills along a straight line. The arm is exported with its
springs and servos and driven at a constant feed by two sets of commands; what is printed is how far
MuJoCo's tool strays from the line. Writes the exported arm and a picture of the two runs.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

from sk120stiff import base_model, compensate, load_robot
from sk120stiff.effects import effect
from sk120stiff.exports import export
from sk120stiff.model import Model
from sk120stiff.workspace import Task, elastic_arm, solve_inverse

START, END = np.array([1.6, -0.2, -0.3]), np.array([1.6, 0.2, -0.3])  # m, base axes
FEED = 0.05  # m/s
POINTS = 161
SETTLED = 1.0  # s before the feed begins


def arm_on_its_foundation() -> Model:
    """The paper's springs, and a base that rocks."""
    robot = load_robot("motoman_sk120")
    springs = base_model(robot)
    rocking = springs + effect(robot, "base_rocking", robot.base_frame)
    return rocking.with_public(
        **{f"base_rocking:{robot.base_frame}.stiffness_{axis}": 5e6 for axis in "xy"}
    )


def driven(arm: mujoco.MjModel, commands: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """(T, 3) where MuJoCo's tool goes [m], once the first point has settled.

    Args:
        arm: The exported arm.
        commands: (N, n) joint commands at points of equal distance along the line [rad].
        loads: (N, 6) wrench on the tool, base axes [N, N·m].
    """
    data = mujoco.MjData(arm)
    mujoco.mj_resetDataKeyframe(arm, data, 0)
    site = arm.site("tool0").id
    duration = np.linalg.norm(END - START) / FEED
    told = []
    for step in range(int((SETTLED + duration) / arm.opt.timestep)):
        share = max(step * arm.opt.timestep - SETTLED, 0.0) / duration * (len(commands) - 1)
        k = min(int(share), len(commands) - 2)
        now, then = k + 1 - share, share - k
        data.ctrl[:] = now * commands[k] + then * commands[k + 1]
        load = now * loads[k] + then * loads[k + 1]
        data.qfrc_applied[:] = 0.0
        mujoco.mj_kinematics(arm, data)
        mujoco.mj_comPos(arm, data)
        place, body = data.site_xpos[site], arm.site_bodyid[site]
        mujoco.mj_applyFT(arm, data, load[:3], load[3:], place, body, data.qfrc_applied)
        mujoco.mj_step(arm, data)
        if step * arm.opt.timestep >= SETTLED:
            told.append(place.copy())
    return np.array(told)


def strayed(places: np.ndarray) -> np.ndarray:
    """(T,) distance from the straight line [m]."""
    along = (END - START) / np.linalg.norm(END - START)
    off = places - START
    return np.linalg.norm(off - np.outer(off @ along, along), axis=1)


def main(folder: Path) -> tuple[float, float]:
    """Both runs; rms of what they stray [m]."""
    model = arm_on_its_foundation()
    share = np.linspace(0.0, 1.0, POINTS)
    line = START + share[:, None] * (END - START)
    loads = np.zeros((POINTS, 6))
    loads[:, 1], loads[:, 2] = -150.0, -490.0 - 200.0 * np.sin(2.0 * np.pi * share)
    tool_down = np.radians([0.0, 30.0, -30.0, 0.0, -60.0, 0.0])
    plain = solve_inverse(elastic_arm(model), Task(line), np.tile(tool_down, (POINTS, 1))).a
    mended = compensate(model, plain, loads)

    export(model, folder / "sk120.xml", pose=plain[0])
    arm = mujoco.MjModel.from_xml_path(str(folder / "sk120.xml"))
    runs = {"as planned": plain, "compensated": mended.a}
    off = {name: strayed(driven(arm, commands, loads)) for name, commands in runs.items()}
    rms = {name: float(np.sqrt(np.mean(away**2))) for name, away in off.items()}
    for name, value in rms.items():
        print(f"{name}: MuJoCo's tool strays {value * 1e6:.1f} µm rms from the line")

    figure, axes = plt.subplots(figsize=(6.0, 3.0), layout="constrained")
    way = 1e3 * np.linalg.norm(END - START)
    for name, away in off.items():
        axes.semilogy(np.linspace(0.0, way, len(away)), away * 1e6, label=name)
    axes.legend()
    axes.set(xlabel="way along the line [mm]", ylabel="distance from it [µm]")
    figure.savefig(folder / "path.png", dpi=150)
    return rms["as planned"], rms["compensated"]


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "mujoco_path"))
