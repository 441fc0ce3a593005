"""A UR5 and 1000 laser-tracker positions: what is geometry, transmission, weight, and what remains.

The data are public: grid_1000.csv of github.com/pauljac7700/serial_robots_datasets (MIT). The robot
is any URDF of a UR5 with masses, such as ur5_robot.urdf of the package example-robot-data.

Run:  python scripts/13_tracker_positions.py FOLDER_OF_DATA ur5_robot.urdf --out explained
"""

import argparse
import subprocess
import sys
from pathlib import Path

import sk120stiff as sk
from sk120stiff.measurements.importers import Told, import_readings


def converted(grid: Path, urdf: Path, out: Path) -> Path:
    """The published file, targets and differences, as measurements; so does 'sk120stiff import'."""
    robot = sk.load_robot(urdf, base="base_link", tool="tool0")
    found = import_readings(grid, robot, Told(length="mm", angle="deg"))
    found.write(out / "ur5.csv")
    return out / "ur5.csv"


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
