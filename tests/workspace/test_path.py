"""A path is told from a file of readings."""

import warnings
from pathlib import Path

import pytest

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import joint_spring_model
from sk120stiff.robot import load_robot
from sk120stiff.workspace import elastic_arm, joints_along, read_path

DATA = Path(__file__).resolve().parents[2] / "robots/motoman_sk120/data/table2_measured.csv"


def test_readings_that_are_taken_for_a_path_are_told(tmp_path: Path) -> None:
    robot = load_robot("motoman_sk120")
    with pytest.warns(ToolkitWarning, match=r"looks like readings.*\(dx, dy, dz\)"):
        read_path(DATA, robot)
    header, *rows = (line.split(",") for line in DATA.read_text().split())
    kept = [k for k, name in enumerate(header) if not name.startswith(("dx", "dy", "dz"))]
    assert len(kept) == len(header) - 3
    plain = tmp_path / "path.csv"
    plain.write_text("\n".join(",".join(row[k] for k in kept) for row in [header, *rows]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read_path(plain, robot).count == len(rows)


def test_positions_of_an_instrument_beside_joints_are_no_path(tmp_path: Path) -> None:
    robot = load_robot("motoman_sk120")
    file = tmp_path / "readings.csv"
    joints = ",".join(f"{name}[deg]" for name in robot.actuated)
    file.write_text(f"{joints},fx[N],fy[N],fz[N],x[mm],y[mm],z[mm]\n0,0,0,0,0,0,0,0,-9,10,20,30\n")
    arm = elastic_arm(joint_spring_model(robot))
    with pytest.raises(InputError, match="an instrument read are no path"):
        joints_along(read_path(file, robot), arm)
