"""Marker positions of a calibration: what is read, what is assumed, what is refused."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import Imported, read_figaroh, read_measurements, write_measurements

JOINTS = ("shoulder", "slide")
UNITS = {"length": "mm", "angle": "deg"}
ROWS = """\
x1,y1,z1,phix1,shoulder,slide,fx,fy,fz
1,2,3,0.1,90,250,0,0,0
1.5,2,2,0.1,90,250,0,0,-10
4,5,6,0.1,45,100,0,0,-2
4,5,4,0.1,45,100,0,0,-12
7,8,9,0.1,30,100,0,0,-5
"""


def read(folder: Path, text: str = ROWS, **told: object) -> Imported:
    path = folder / "marks.csv"
    path.write_text(text, encoding="utf-8")
    options = {**UNITS, "load": "N", **told}
    return read_figaroh(path, JOINTS, prismatic=("slide",), **options)  # type: ignore[arg-type]


def test_rows_are_paired_with_the_lightest_of_their_pose(tmp_path: Path) -> None:
    found = read(tmp_path)
    out = write_measurements(found.measurements, tmp_path / "out.csv", as_positions=True)
    back = read_measurements(out, JOINTS, ("slide",))
    assert back.pose == ("P1", "P2")
    assert back.displacement is not None
    np.testing.assert_allclose(back.displacement, [[5e-4, 0, -1e-3], [0, 0, -2e-3]], atol=1e-15)
    np.testing.assert_allclose(back.wrench, [[0, 0, -10, 0, 0, 0], [0, 0, -10, 0, 0, 0]])
    np.testing.assert_allclose(back.joints, [[np.pi / 2, 0.25], [np.pi / 4, 0.1]])
    assert back.zero == "shared"


def test_what_was_assumed_and_what_can_be_identified_is_said(tmp_path: Path) -> None:
    found = read(tmp_path)
    said = " ".join(found.assumed)
    for words in (
        "axes of the base", "origin of the tool frame", "At 2 poses the lightest load is not zero",
        "Not taken over: phix1", "lengths in mm, joint angles in deg, loads in N",
    ):  # fmt: skip
        assert words in said
    assert (found.differences, found.useful_poses) == (2, 2)
    assert "2 rows at 2 of 3 poses" in found.identifiable
    assert "other 1 poses show stiffness through the arm's weight alone" in found.identifiable


def test_positions_alone_are_readings_of_where_the_marker_stands(tmp_path: Path) -> None:
    for text in (
        "x1,y1,z1,q1,q2\n1,2,3,10,1\n4,5,6,20,1\n",
        "x1,y1,z1,q1,q2,payload\n1,2,3,10,1,5\n1,2,3,10,1,5\n4,5,6,20,1,8\n",
    ):
        told = {"load": "kg"} if "payload" in text else {"load": None}
        found = read(tmp_path, text, **told)
        assert found.differences == 0
        assert "geometry of the arm, and springs as far as its weight" in found.identifiable
        out = write_measurements(found.measurements, tmp_path / "out.csv", as_positions=True)
        again = read_measurements(out).absolute
        assert again is not None and again.channels.present == ("position",)
        assert again.channels.position[0] == pytest.approx([1e-3, 2e-3, 3e-3])


def test_payload_and_counted_load(tmp_path: Path) -> None:
    rows = "1,2,3,10,1,0\n1,2,2.9,10,1,2\n"
    weight = read(tmp_path, f"x1,y1,z1,q1,q2,payload\n{rows}", load="kg")
    np.testing.assert_allclose(weight.measurements.wrench[1], [0, 0, -19.6133, 0, 0, 0])
    wrench = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    counted = read(tmp_path, f"x1,y1,z1,q1,q2,load\n{rows}", load=None, wrench=wrench)
    np.testing.assert_allclose(counted.measurements.wrench[1], 2.0 * np.array(wrench))


def test_markers_joint_names_and_units_in_headers(tmp_path: Path) -> None:
    text = "x1,y1,z1,x2[m],y2[m],z2[m],a[rad],b[m]\n0,0,0,1,2,3,0.5,0.25\n"
    nothing = {"length": None, "angle": None, "load": None}
    found = read(tmp_path, text, **nothing, marker=2, joints=("a", "b"))
    np.testing.assert_allclose(found.measurements.displacement, [[1, 2, 3]])
    np.testing.assert_allclose(found.measurements.joints, [[0.5, 0.25]])
    assert "a is shoulder, b is slide" in " ".join(found.assumed)


def test_a_masked_row_is_no_zero_reading(tmp_path: Path) -> None:
    text = "x1,y1,z1,q1,q2,payload,use\n9,9,9,1,1,0,0\n1,2,3,1,1,1,1\n1,2,2,1,1,3,1\n"
    found = read(tmp_path, text, load="N")
    out = write_measurements(found.measurements, tmp_path / "out.csv", as_positions=True)
    back = read_measurements(out).masked()
    assert back.displacement is not None
    np.testing.assert_allclose(back.displacement, [[0, 0, -1e-3]], atol=1e-15)
    np.testing.assert_allclose(back.wrench[:, 2], [-2.0])


@pytest.mark.parametrize(
    ("text", "told", "words"),
    [
        ("shoulder,slide\n1,2\n", {}, ["no marker", "x1, y1, z1"]),
        ("x1,z1,q1,q2\n1,2,3,4\n", {}, ["'y1' is missing"]),
        ("x1,y1,z1,x2,y2,z2,q1,q2\n1,2,3,4,5,6,7,8\n", {}, ["markers 1, 2", "--marker"]),
        (ROWS, {"marker": 3}, ["no marker 3"]),
        ("x1,y1,z1,sholder,slide\n1,2,3,4,5\n", {}, ["'shoulder'", "'sholder'", "--joints"]),
        ("x1,y1,z1,q1\n1,2,3,4\n", {}, ["'slide' has no column 'q2'"]),
        (ROWS, {"joints": ("shoulder",)}, ["1 columns for 2 joints"]),
        (ROWS, {"length": None}, ["which unit", "'slide'", "--length", "mm"]),
        (ROWS, {"angle": None}, ["which unit", "'shoulder'", "--angle", "deg"]),
        (ROWS, {"load": None}, ["which unit", "'fx'", "--load"]),
        (ROWS.replace("x1,", "x1[m],", 1), {}, ["header says m", "--length says mm"]),
        (ROWS.replace("1.5", "nan"), {}, ["line 3", "column x1", "not a finite number"]),
        (ROWS.replace("1.5", ""), {}, ["line 3", "column x1", "empty"]),
        (ROWS.replace("1.5,", ""), {}, ["line 3", "8 cells"]),
        (ROWS.replace(",fy,", ",g,"), {}, ["'fy' is missing"]),
        (ROWS.replace("phix1", "payload"), {}, ["given twice"]),
        (ROWS.replace("phix1", "mx"), {}, ["'my' is missing"]),
        (ROWS, {"wrench": np.ones(6)}, ["no column says in which rows"]),
        ("x1,y1,z1,q1,q2,load\n1,2,3,4,5,1\n", {}, ["--wrench"]),
        ("x1,y1,z1,q1,q2,payload\n1,2,3,4,5,-1\n", {}, ["not negative"]),
        ("x1,y1,z1,q1,q2,use\n1,2,3,4,5,2\n", {}, ["neither 1 nor 0"]),
        ("x1,y1,z1,q1,q2,use\n1,2,3,4,5,0\n", {}, ["masks every row"]),
        ("pose,x1,y1,z1,q1,q2\nA,1,2,3,4,5\nA,1,2,3,5,5\n", {}, ["'A'", "same joint values"]),
    ],
)
def test_bad_files_are_refused(
    tmp_path: Path, text: str, told: dict[str, object], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text, **told)
    for word in words:
        assert word in str(caught.value)
