"""Public readings of a real FANUC R-2000iC under cable pulls.

They lie beside the project (see their README there); where they are missing, nothing that needs
them is collected. The controller measures joint 3 against the floor.
"""

import runpy
from pathlib import Path

import numpy as np

from sk120stiff import load_robot
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.robot import Robot

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "fanuc_r2000ic"
SCRIPT = runpy.run_path(str(Path(__file__).parents[2] / "scripts" / "17_cable_pulls.py"))
NAMES = tuple(f"joint_{k}" for k in range(1, 7))


def readings(joints: np.ndarray, sigma: float | None = None) -> Measurements:
    """The cable pulls at these joint angles [rad], with this noise stated [m]."""
    force, moved = (np.loadtxt(FOLDER / f"{name}.csv", delimiter=",")
                    for name in ("forces", "deflections"))  # fmt: skip
    return Measurements(
        pose=tuple(str(k) for k in range(len(joints))),
        joint_names=NAMES,
        joints=joints,
        wrench=np.hstack([force, np.zeros_like(force)]),
        displacement=moved,
        point=np.array([0.0069, 0.2453, 0.3193]),
        zero="separate",
        noise=NoiseStatement(sigma=sigma),
    )


def robot(tmp_path: Path, *signs: int) -> Robot:
    """The arm, read from its URDF."""
    (tmp_path / "arm.urdf").write_text(SCRIPT["urdf"](signs), encoding="utf-8")
    return load_robot(str(tmp_path / "arm.urdf"), base="base_link", tool="link_6")


if FOLDER.is_dir():
    CONTROLLER = np.loadtxt(FOLDER / "joint_angles.csv", delimiter=",")
    MAPPED = np.column_stack(
        [CONTROLLER[:, :2], -(CONTROLLER[:, 1] + CONTROLLER[:, 2]), -CONTROLLER[:, 3:]]
    )
