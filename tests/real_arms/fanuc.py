"""Public readings of a real FANUC R-2000iC under cable pulls.

They lie beside the project (see their README there); where they are missing, nothing that needs
them is collected. The controller measures joint 3 against the floor.
"""

from pathlib import Path

import numpy as np

from sk120stiff import load_robot
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.robot import Robot

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "fanuc_r2000ic"
# Modified Denavit-Hartenberg rows: alpha, a, theta, d [rad, m].
QUARTER = np.pi / 2
ROWS = (
    (0.0, 0.0, 0.0, 0.670),
    (-QUARTER, 0.312, -QUARTER, 0.0),
    (0.0, 1.075, 0.0, 0.0),
    (-QUARTER, 0.225, 0.0, 1.280),
    (QUARTER, 0.0, 0.0, 0.0),
    (-QUARTER, 0.0, 0.0, 0.215),
)
NAMES = tuple(f"joint_{k}" for k in range(1, 7))


def urdf(signs: tuple[int, ...]) -> str:
    """The arm with axes that turn with (1) or against (-1) the rows."""
    parts = ['<robot name="r2000ic"><link name="base_link"/>']
    for k, (alpha, a, theta, d) in enumerate(ROWS):
        # R_x(alpha) then R_z(theta): roll, pitch, yaw of the product are (alpha, 0, theta) turned.
        c, s = np.cos(alpha), np.sin(alpha)
        R = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ np.array(
            [
                [np.cos(theta), -np.sin(theta), 0],
                [np.sin(theta), np.cos(theta), 0],
                [0, 0, 1],
            ]
        )
        roll, pitch = np.arctan2(R[2, 1], R[2, 2]), np.arcsin(-R[2, 0])
        yaw = np.arctan2(R[1, 0], R[0, 0])
        parts.append(
            f'<link name="link_{k + 1}"/><joint name="{NAMES[k]}" type="revolute">'
            f'<parent link="{f"link_{k}" if k else "base_link"}"/><child link="link_{k + 1}"/>'
            f'<origin xyz="{a} {-s * d:.12f} {c * d:.12f}" '
            f'rpy="{roll:.12f} {pitch:.12f} {yaw:.12f}"/>'
            f'<axis xyz="0 0 {signs[k]}"/>'
            '<limit lower="-6.3" upper="6.3" effort="1" velocity="1"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])


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
    (tmp_path / "arm.urdf").write_text(urdf(signs), encoding="utf-8")
    return load_robot(str(tmp_path / "arm.urdf"), base="base_link", tool="link_6")


if FOLDER.is_dir():
    CONTROLLER = np.loadtxt(FOLDER / "joint_angles.csv", delimiter=",")
    MAPPED = np.column_stack(
        [CONTROLLER[:, :2], -(CONTROLLER[:, 1] + CONTROLLER[:, 2]), -CONTROLLER[:, 3:]]
    )
