"""A FANUC R-2000iC pulled by a cable: the controller's own columns, springs, and what is missing.

The data are public: data/stiffness_data of
github.com/longton2001-pixel/breakthrough-surge-suppression-in-high-speed-robotic-drilling (MIT), 43
poses, one pull each: joint_angles.csv [rad], forces.csv [N], deflections.csv [m], without headers,
base axes. Such controllers measure joint 3 against the floor and turn joints 4 to 6 the other way;
the key `joints` says so once, and the columns stay as they are.

Run:  python scripts/17_cable_pulls.py FOLDER_OF_DATA --out explained
"""

import argparse
import csv
import subprocess
import sys
from pathlib import Path

import numpy as np

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
CONTROLLER = (
    "{joint_1: J1, joint_2: J2, joint_3: -(J2 + J3), joint_4: -J4, joint_5: -J5, joint_6: -J6}"
)


def urdf(signs: tuple[int, ...] = (1,) * 6) -> str:
    """The arm with axes that turn with (1) or against (-1) the rows."""
    parts = ['<robot name="r2000ic"><link name="base_link"/>']
    for k, (alpha, a, theta, d) in enumerate(ROWS):
        # R_x(alpha) then R_z(theta): roll, pitch, yaw of the product are (alpha, 0, theta) turned.
        c, s = np.cos(alpha), np.sin(alpha)
        ct, st = np.cos(theta), np.sin(theta)
        R = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ np.array(
            [[ct, -st, 0], [st, ct, 0], [0, 0, 1]]
        )
        roll, pitch = np.arctan2(R[2, 1], R[2, 2]), np.arcsin(-R[2, 0])
        yaw = np.arctan2(R[1, 0], R[0, 0])
        parts.append(
            f'<link name="link_{k + 1}"/><joint name="joint_{k + 1}" type="revolute">'
            f'<parent link="{f"link_{k}" if k else "base_link"}"/><child link="link_{k + 1}"/>'
            f'<origin xyz="{a} {-s * d:.12f} {c * d:.12f}" '
            f'rpy="{roll:.12f} {pitch:.12f} {yaw:.12f}"/>'
            f'<axis xyz="0 0 {signs[k]}"/>'
            '<limit lower="-6.3" upper="6.3" effort="0" velocity="1"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])


def converted(folder: Path, out: Path) -> Path:
    """The three files under one header, the controller's names, and what goes with them."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "r2000ic.urdf").write_text(urdf())
    parts = [np.loadtxt(folder / f"{name}.csv", delimiter=",")
             for name in ("joint_angles", "forces", "deflections")]  # fmt: skip
    path = out / "r2000ic.csv"
    with path.open("w", newline="") as target:
        table = csv.writer(target)
        table.writerow([
            "pose", *(f"J{k}[rad]" for k in range(1, 7)), *(f"f{axis}[N]" for axis in "xyz"),
            *(f"d{axis}[m]" for axis in "xyz"),
        ])  # fmt: skip
        for k, row in enumerate(np.hstack(parts)):
            table.writerow([f"pose_{k + 1}", *(repr(float(v)) for v in row)])
    path.with_suffix(".yaml").write_text(
        "robot: r2000ic.urdf\nbase_frame: base_link\ntool_frame: link_6\n"
        "point: {xyz: [6.9, 245.3, 319.3], unit: mm}\n"
        f"joints: {CONTROLLER}\n"
        "force: {frame: base}\ndisplacement: {frame: base, zero: separate}\n"
    )
    return path


def main() -> None:
    """Convert the files, then one command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds joint_angles.csv and the other two")
    parser.add_argument("--out", type=Path, default=Path("explained"))
    given = parser.parse_args()
    if not (given.folder / "joint_angles.csv").is_file():
        parser.error(f"no joint_angles.csv in {given.folder}: give the folder of that arm")
    data = converted(given.folder, given.out / "data")
    subprocess.run(
        [sys.executable, "-m", "sk120stiff", "explain", str(data), "--out", str(given.out)],
        check=True,
    )


if __name__ == "__main__":
    main()
