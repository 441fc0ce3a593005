"""Columns with the names of joints tell which joint a numbered column is."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from tests.measurements.importers.reading import draft_of

JOINTS = ("pan", "lift", "elbow")
HEAD = ",".join(
    [f"/joint_states/{what}[{k}]" for what in ("name", "position") for k in range(4)]
    + ["x[mm]", "y[mm]", "z[mm]"]
)


def test_names_beside_the_numbers_count(tmp_path: Path) -> None:
    rows = ["elbow,finger,lift,pan,1,2,3,4,5,6,7", "elbow,finger,lift,pan,8,9,1,2,3,4,5"]
    found = draft_of(tmp_path, "\n".join([HEAD, *rows]), JOINTS, angle="rad")
    assert found.joints.values.tolist() == [[4.0, 3.0, 1.0], [2.0, 1.0, 8.0]]
    assert any("/joint_states/position[3] is pan" in said for said in found.said)
    assert any("position[1]" in left for left in found.unused)


def test_names_that_change_from_row_to_row_are_refused(tmp_path: Path) -> None:
    rows = ["elbow,finger,lift,pan,1,2,3,4,5,6,7", "pan,finger,lift,elbow,8,9,1,2,3,4,5"]
    with pytest.raises(InputError, match=r"name\[0\] is elbow and pan"):
        draft_of(tmp_path, "\n".join([HEAD, *rows]), JOINTS, angle="rad")


def test_names_of_points_beside_plain_joints_tell_nothing(tmp_path: Path) -> None:
    text = "name_1,position_1,q1,q2,q3,x[mm],y[mm],z[mm]\nP1,1,2,3,4,5,6,7\nP2,2,3,4,5,6,7,8\n"
    found = draft_of(tmp_path, text, JOINTS, angle="rad")
    assert found.joints.values.tolist() == [[2.0, 3.0, 4.0], [3.0, 4.0, 5.0]]


def test_names_that_change_are_refused_where_their_numbers_are_the_joints(tmp_path: Path) -> None:
    rows = ["a,b,c,1,2,3,4,5,6", "c,a,b,8,9,1,2,3,4"]
    head = ",".join(
        [f"/joint_states/{what}[{k}]" for what in ("name", "position") for k in range(3)]
    )
    with pytest.raises(InputError, match=r"name\[0\] is a and c"):
        draft_of(tmp_path, "\n".join([f"{head},x[mm],y[mm],z[mm]", *rows]), JOINTS, angle="rad")
