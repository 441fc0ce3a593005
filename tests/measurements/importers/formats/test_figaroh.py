"""FIGAROH's calibration files: what is read, what is assumed, what is refused."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.drafting import Draft, paired_loads
from tests.measurements.importers.reading import draft_of, sheet_of

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


def read(folder: Path, text: str = ROWS, **told: object) -> Draft:
    options = {**UNITS, "load": "N", **told}
    marker = {"marker": options.pop("marker", None)}
    return draft_of(folder, text, JOINTS, ("slide",), known=marker, **options)


def test_rows_are_paired_with_the_lightest_of_their_pose(tmp_path: Path) -> None:
    found = read(tmp_path)
    assert "FIGAROH" in found.sheet.title
    assert found.pose == ("P1", "P1", "P2", "P2", "P3")
    np.testing.assert_allclose(found.measured[1], [1.5e-3, 2e-3, 2e-3])
    np.testing.assert_allclose(found.joints.values[0], [np.pi / 2, 0.25])
    differences, rows, shifted = paired_loads(found)
    np.testing.assert_allclose(differences[:, 2], [0, -10, 0, -10, 0])
    assert (rows.tolist(), shifted) == ([False, True, False, True, False], 2)


def test_what_was_assumed_is_said(tmp_path: Path) -> None:
    found = read(tmp_path)
    assert "act on the robot" in " ".join(found.said)
    assert [item.partition(":")[0] for item in found.unused] == ["column phix1"]


def test_payload_and_counted_load(tmp_path: Path) -> None:
    rows = "1,2,3,10,1,0\n1,2,2.9,10,1,2\n"
    weight = read(tmp_path, f"x1,y1,z1,q1,q2,payload\n{rows}", load="kg").loads
    np.testing.assert_allclose(weight.wrench[1], [0, 0, -19.6133, 0, 0, 0])
    np.testing.assert_allclose(weight.payload, [0.0, 2.0])
    wrench = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    counted = read(tmp_path, f"x1,y1,z1,q1,q2,load\n{rows}", load=None, wrench=wrench)
    np.testing.assert_allclose(counted.loads.wrench[1], 2.0 * wrench)


def test_markers_joint_names_and_units_in_headers(tmp_path: Path) -> None:
    text = "x1,y1,z1,x2[m],y2[m],z2[m],a[rad],b[m]\n0,0,0,1,2,3,0.5,0.25\n"
    nothing = {"length": None, "angle": None, "load": None}
    found = read(tmp_path, text, **nothing, marker="2", joints=("a", "b"))
    np.testing.assert_allclose(found.measured, [[1, 2, 3]])
    np.testing.assert_allclose(found.joints.values, [[0.5, 0.25]])
    assert "a is shoulder, b is slide" in " ".join(found.said)


def test_a_masked_row_is_no_zero_reading(tmp_path: Path) -> None:
    text = "x1,y1,z1,q1,q2,payload,use\n9,9,9,1,1,0,0\n1,2,3,1,1,1,1\n1,2,2,1,1,3,1\n"
    differences, rows, _ = paired_loads(read(tmp_path, text, load="N"))
    np.testing.assert_allclose(differences[:, 2], [1.0, 0.0, -2.0], atol=1e-12)
    assert rows.tolist() == [False, False, True]


def test_a_row_without_a_position_is_left_out_and_said(tmp_path: Path) -> None:
    for cell in ("", "nan", "---"):
        found = read(tmp_path, ROWS.replace("1.5", cell))
        assert (len(found.pose), found.sheet.lines) == (4, (2, 4, 5, 6))
        assert found.sheet.skipped == ((3, "nothing stands in x1"),)


@pytest.mark.parametrize(
    ("text", "told", "words"),
    [
        ("shoulder,slide\n1,2\n", {}, ["no positions", "--joints-file"]),
        ("x,y,shoulder,slide\n1,2,3,4\n", {}, ["the column z is not there", "--columns"]),
        ("x[ell],y[ell],z[ell],shoulder,slide\n1,2,3,4,5\n", {}, ["units of x[ell]", "--length"]),
        ("a,b\n1,2\n", {}, ["no format", "--columns"]),
        ("x1,z1,q1,q2\n1,2,3,4\n", {}, ["'y1' is missing"]),
        ("x1,y1,z1,x2,y2,q1,q2\n1,2,3,4,5,7,8\n", {}, ["'z2' is missing"]),
        (ROWS, {"marker": "3"}, ["no marker 3"]),
        ("x1,y1,z1,sholder,slide\n1,2,3,4,5\n", {}, ["'shoulder'", "'sholder'", "--joints"]),
        ("x1,y1,z1,q1\n1,2,3,4\n", {}, ["'slide' has no column 'q2'"]),
        (ROWS, {"joints": ("shoulder",)}, ["1 columns for 2 joints"]),
        (ROWS, {"length": None}, ["which unit", "'slide'", "--length", "mm"]),
        (ROWS, {"angle": None}, ["which unit", "'shoulder'", "--angle", "deg"]),
        (ROWS, {"load": None}, ["which unit", "'fx'", "--load"]),
        (ROWS.replace("x1,", "x1[m],", 1), {}, ["the file says m", "--length says mm"]),
        (ROWS.replace("1.5", "1.5mm"), {}, ["line 3", "column x1", "is no number"]),
        (ROWS.replace("1.5,", ""), {}, ["line 3", "8 cells"]),
        (ROWS.replace(",fy,", ",g,"), {}, ["fy has no column", "'g'"]),
        (ROWS.replace("phix1", "payload"), {}, ["given twice"]),
        (ROWS.replace("phix1", "mx"), {}, ["which unit", "'mx'"]),
        (ROWS, {"wrench": np.ones(6)}, ["no column says in which rows"]),
        ("x1,y1,z1,q1,q2,load\n1,2,3,4,5,1\n", {}, ["--wrench"]),
        ("x1,y1,z1,q1,q2,payload\n1,2,3,4,5,-1\n", {}, ["not negative"]),
        ("x1,y1,z1,q1,q2,use\n1,2,3,4,5,2\n", {}, ["neither 1 nor 0"]),
        ("x1,y1,z1,q1,q2,use\n1,2,3,4,5,0\n", {}, ["masks every row"]),
    ],
)
def test_bad_files_are_refused(
    tmp_path: Path, text: str, told: dict[str, object], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text, **told)
    for word in words:
        assert word in str(caught.value)


def test_markers_side_by_side_under_told_names(tmp_path: Path) -> None:
    names = ("x1", "y1", "z1", "x2", "y2", "z2", "q1", "q2")
    found = sheet_of(tmp_path, "1,2,3,4,5,6,7,8\n", columns=names, marker="2")
    assert [c.cells for c in map(found.get, "xyz") if c] == [("4",), ("5",), ("6",)]
    displacement = tuple(f"d{name}" if name[0] != "q" else name for name in names)
    moved = sheet_of(tmp_path, "1,2,3,4,5,6,7,8\n", columns=displacement, marker="1")
    assert [c.cells for c in map(moved.get, ("dx", "dy", "dz")) if c] == [("1",), ("2",), ("3",)]


@pytest.mark.parametrize("header", ["x{}", "y_{}", "SMR{} x", "M{}.x", "{}x"])
def test_each_of_several_markers_is_a_reading(tmp_path: Path, header: str) -> None:
    """Three reflectors in a row, as trackers measure a whole pose; one of them was lost once."""
    own = [header.replace("y", "x").replace("x", axis).format(k) for k in "123" for axis in "xyz"]
    text = ",".join([*own, "q1", "q2", "payload", "note"]) + "\n"
    text += "1,2,3,4,5,6,7,8,9,10,20,0,a\n1,2,2,,,,7,8,8,10,20,5,b\n"
    found = read(tmp_path, text, load="kg")
    assert found.marker_of == ("1", "2", "3", "1", "3")
    np.testing.assert_allclose(1e3 * found.measured[:, 2], [3, 6, 9, 2, 8])
    np.testing.assert_allclose(found.loads.payload, [0, 0, 0, 5, 5])
    assert found.sheet.lines == (2, 2, 2, 3, 3)
    assert found.sheet.skipped == ((3, f"marker 2: nothing stands in {', '.join(own[3:6])}"),)
    assert found.unused == ("column note",)
