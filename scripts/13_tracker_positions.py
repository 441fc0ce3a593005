"""A UR5 and 1000 laser-tracker positions: what is geometry, transmission, weight, and what remains.

The data are public: grid_1000.csv of github.com/pauljac7700/serial_robots_datasets (MIT). The robot
is any URDF of a UR5 with masses, such as ur5_robot.urdf of the package example-robot-data.

Run:  python scripts/13_tracker_positions.py FOLDER_OF_DATA ur5_robot.urdf --out explained
"""

import argparse
import csv
import subprocess
import sys
from pathlib import Path

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


def converted(grid: Path, urdf: Path, out: Path) -> Path:
    """The published file under the headers that sk120stiff reads; target + difference [mm]."""
    out.mkdir(parents=True, exist_ok=True)
    path = out / "ur5.csv"
    with grid.open(newline="") as source, path.open("w", newline="") as target:
        table = csv.writer(target)
        table.writerow(["order", *(f"{n}_joint[deg]" for n in JOINTS), "x[mm]", "y[mm]", "z[mm]"])
        for row in csv.DictReader(source):
            where = [float(row[f"{axis}_t"]) + float(row[f"{axis}_dif"]) for axis in "xyz"]
            angles = [row[f"joint_{k}"] for k in range(1, 7)]
            table.writerow([row["step_order"], *angles, *(f"{x:.6f}" for x in where)])
    path.with_suffix(".yaml").write_text(
        f"robot: {urdf.resolve()}\nbase_frame: base_link\ntool_frame: tool0\n"
        "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    )
    return path


def main() -> None:
    """Convert the file, then one command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds grid_1000.csv")
    parser.add_argument("urdf", type=Path, help="a UR5 with masses")
    parser.add_argument("--out", type=Path, default=Path("explained"))
    given = parser.parse_args()
    data = converted(given.folder / "grid_1000.csv", given.urdf, given.out / "data")
    subprocess.run(
        [sys.executable, "-m", "sk120stiff", "explain", str(data), "--out", str(given.out)],
        check=True,
    )


if __name__ == "__main__":
    main()
