"""Joint targets of robots' programs: every controller's way of writing, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Sheet
from tests.measurements.importers.reading import SIX, sheet_of

DEG = [[10.5, -20.0, 30.25, 0.0, 45.0, -90.0], [0.0, 1.0, 2.0, 3.0, 4.0, 5e-3]]
RAD = np.deg2rad(DEG).tolist()


def lines(form: str, rows: list[list[float]] = DEG) -> str:
    """A line for each target: {k} its number, {0} to {5} its values, {all} these with commas."""
    return "\n".join(
        form.format(*row, k=k, all=",".join(map(str, row))) for k, row in enumerate(rows, 1)
    )


PROGRAMS = {
    "RAPID": "MODULE Calib\n"
    + lines("  CONST jointtarget jp{k}:=[[{all}],[9E9,9E9,9E9,9E9,9E9,9E9]];")
    + "\n  PROC main()\n    MoveAbsJ jp1, v100, fine, tool0;\n  ENDPROC\nENDMODULE\n",
    "MoveAbsJ": lines(r"MoveAbsJ [[{all}],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]\NoEOffs, v50;"),
    "ROKAE": lines("LOCAL VAR jointtarget jp{k} = j:{{\t {all},\t0\t}}\t{{EJ 0,0,0,0,0,0}}"),
    "KRL": lines(
        "DECL GLOBAL E6AXIS XP{k}={{A1 {0},A2 {1},A3 {2},A4 {3},A5 {4},A6 {5},E1 0.0,E2 0.0}}"
    ),
    "PTP": lines("PTP {{E6AXIS: A1 {0}, A2 {1}, A3 {2}, A4 {3}, A5 {4}, A6 {5}}} C_PTP"),
    "FANUC": "/POS\n"
    + lines(
        'P[{k}:"cal"]{{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1= {0} deg,\tJ2= {1} deg,\tJ3= {2} deg,\n'
        "\tJ4= {3} deg,\tJ5= {4} deg,\tJ6= {5} deg\n}};"
    )
    + "\n/END\n",
    "URScript": "def cal():\n" + lines("  movej([{all}], a=1.4, v=1.05)", RAD) + "\nend\n",
    "URScript, named": lines("  global Waypoint_{k}_q=[{all}]\n  movej(Waypoint_{k}_q)", RAD),
    "DRL": lines("movej(posj({all}), vel=30)"),
    "Kawasaki": ".JOINTS\n" + lines("#c{k}  {0} {1} {2} {3} {4} {5}") + "\n.END\n",
    "VAL3": lines('<Value key="{k}" j1="{0}" j2="{1}" j3="{2}" j4="{3}" j5="{4}" j6="{5}" />'),
    "INFORM": "/JOB\n//NAME CAL\n//POS\n///NPOS 2,0,0,0,0,0\n///POSTYPE ANGLE\n"
    + lines("C0000{k}={all}")
    + "\n//INST\nNOP\nMOVJ C00001 VJ=5.00\nEND\n",
}


def joints_of(folder: Path, text: str, robot: tuple[str, ...] = SIX) -> Sheet:
    return sheet_of(folder, text, robot, role="joints")


def values(sheet: Sheet) -> list[list[float]]:
    """Rows of joint values in degrees."""
    columns = sheet.those(*(f"joint {k}" for k in range(1, 7)))
    assert {column.unit for column in columns} in ({"deg"}, {"rad"})
    table = np.array([[float(cell) for cell in column.cells] for column in columns]).T
    return (np.rad2deg(table) if columns[0].unit == "rad" else table).tolist()


@pytest.mark.parametrize("which", PROGRAMS)
def test_joint_targets_of_every_controller_are_read(tmp_path: Path, which: str) -> None:
    found = joints_of(tmp_path, PROGRAMS[which])
    np.testing.assert_allclose(values(found), DEG, atol=1e-12)
    assert "2 joint targets" in " ".join(found.notes)


def test_lines_are_those_of_the_targets_and_names_their_own(tmp_path: Path) -> None:
    found = joints_of(tmp_path, PROGRAMS["RAPID"])
    assert found.lines == (2, 3)
    name = found.get("name")
    assert name is not None and name.cells == ("jp1", "jp2")


def test_the_waypoints_in_space_are_told(tmp_path: Path) -> None:
    space = "CONST robtarget p1:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
    found = joints_of(tmp_path, PROGRAMS["RAPID"] + space)
    assert "1 targets in space" in " ".join(found.unused)
    assert not joints_of(tmp_path, PROGRAMS["RAPID"]).unused


def test_an_external_axis_that_moves_is_told_and_one_that_stands_is_not(tmp_path: Path) -> None:
    still = PROGRAMS["KRL"]
    assert not joints_of(tmp_path, still).unused
    moved = joints_of(tmp_path, still.replace("E1 0.0", "E1 812.5"))
    assert "behind the joint 6" in " ".join(moved.unused)
    np.testing.assert_allclose(values(moved), DEG)


def test_a_seventh_joint_is_the_first_external_axis(tmp_path: Path) -> None:
    text = PROGRAMS["RAPID"].replace("[9E9,", "[77,")
    seven = joints_of(tmp_path, text, (*SIX, "joint_7"))
    last = seven.get("joint 7")
    assert last is not None and last.cells == ("77", "77")


def test_counts_of_encoders_are_refused(tmp_path: Path) -> None:
    text = "/JOB\n//POS\n///PULSE\nC00000=0,100,-2000,3,4,5\nC00001=1,2,3,4,5,6\n//INST\n"
    with pytest.raises(InputError, match="counts of the encoders"):
        joints_of(tmp_path, text)


def test_too_few_axes_are_refused_with_their_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="6 axes, but the robot has 7") as caught:
        joints_of(tmp_path, PROGRAMS["ROKAE"].replace(",\t0\t", ""), (*SIX, "joint_7"))
    assert "line 1" in str(caught.value)


def test_a_program_in_place_of_positions_is_no_measurement(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="joint values, and no positions") as caught:
        sheet_of(tmp_path, PROGRAMS["URScript"])
    assert "--joints-file" in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "name,x,y,z\nA1,1,2,3\nA2,4,5,6\nJ1,7,8,9\n",
        "A1 10.0 20.0 30.0\nA2 11.0 21.0 31.0\n",
        "x;y;z;remark\n1;2;3;{A1 5\n4;5;6;movej([1,2,3])\n",
    ],
)
def test_tables_of_points_stay_what_they_are(tmp_path: Path, text: str) -> None:
    assert sheet_of(tmp_path, text).has("x", "y", "z")
