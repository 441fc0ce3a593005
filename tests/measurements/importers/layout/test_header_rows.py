"""Headers in two rows, and positions before and after a load side by side."""

import io
from pathlib import Path

import openpyxl
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Sheet
from sk120stiff.measurements.importers.loads.pairs import unfolded
from tests.measurements.importers.reading import sheet_of

TWO = ("joint_1", "joint_2")
ROWS = "P1,10,20,0,0,-100,1,2,3,1.5,2.5,3.5\nP2,30,40,0,0,-90,4,5,6,4.5,5.5,6.5\n"


def table(first: str, second: str, force: str = "Force [N]", axes: str = "x,y,z") -> str:
    """Two rows of headers above two poses of an arm with two joints."""
    upper = f"Pose,Joint angles [deg],,{force},,,{first},,,{second},,\n"
    return f"{upper},q1,q2,x,y,z,{axes},{axes}\n{ROWS}"


def cells(sheet: Sheet) -> dict[str, tuple[str, ...]]:
    return {column.meaning: column.cells for column in sheet.columns}


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("Position before", "Position after"),
        ("before", "after"),
        ("Coordinates unloaded [mm]", "Coordinates loaded [mm]"),
        ("Reflektor vorher", "Reflektor nachher"),
        ("unbelastet", "belastet"),
        ("Position ohne Last (mm)", "Position mit Last (mm)"),
        ("vor Belastung", "nach Belastung"),
        ("initial", "final"),
        ("Zero", "Load"),
        ("Sans charge", "Avec charge"),
        ("Without", "With"),
        ("Position 1 (unloaded)", "Position 2 (loaded)"),
        ("Anfangsposition", "Endposition"),
        ("Nullmessung", "Lastmessung"),
        ("Initial position", "Deformed position"),
    ],
)
def test_groups_without_and_with_load_are_no_markers(
    tmp_path: Path, first: str, second: str
) -> None:
    sheet = sheet_of(tmp_path, table(first, second), TWO)
    assert sheet.get("marker") is None
    found = cells(unfolded(sheet))
    assert found["pose"] == ("P1", "P1", "P2", "P2")
    assert found["x"] == ("1", "1.5", "4", "4.5") and found["z"] == ("3", "3.5", "6", "6.5")
    assert found["fz"] == ("0", "-100", "0", "-90")


def test_the_loaded_group_may_come_first(tmp_path: Path) -> None:
    found = cells(unfolded(sheet_of(tmp_path, table("nachher", "vorher"), TWO)))
    assert found["x"] == ("1.5", "1", "4.5", "4")


def test_units_stand_above_or_below(tmp_path: Path) -> None:
    above = sheet_of(tmp_path, table("Position before [mm]", "Position after [mm]"), TWO)
    units = {column.meaning: column.unit for column in above.columns}
    assert (units["joint 2"], units["fy"], units["unloaded x"]) == ("deg", "N", "mm")
    axes = "x [mm],y [mm],z [mm]"
    below = sheet_of(tmp_path, table("before", "after", "Kraft [N]", axes), TWO)
    assert {c.unit for c in below.columns if c.meaning.startswith(("un", "loa"))} == {"mm"}


def test_units_may_stand_below_the_names(tmp_path: Path) -> None:
    text = (
        "Pose,Joint 1,Joint 2,Force,Force,Force,before,before,before,after,after,after\n"
        ",deg,deg,x,y,z,x,y,z,x,y,z\n,,,N,N,N,mm,mm,mm,mm,mm,mm\n" + ROWS
    )
    units = {column.meaning: column.unit for column in sheet_of(tmp_path, text, TWO).columns}
    assert (units["joint 2"], units["fx"], units["loaded z"]) == ("deg", "N", "mm")


def test_a_row_of_units_with_blanks_is_no_second_row_of_headers(tmp_path: Path) -> None:
    text = "Pose,Point,Time,q1,q2,x,y,z\n,,,deg,deg,mm,mm,furlong\nA,1,0,10,20,1,2,3\n"
    sheet = sheet_of(tmp_path, text, TWO)
    assert sheet.lines == (3,) and sheet.has("pose", "name", "time", "x", "y", "z")


def test_axes_above_before_and_after(tmp_path: Path) -> None:
    text = (
        "Pose,q1 [deg],q2 [deg],Fz [N],x,,y,,z,\n,,,,before,after,before,after,before,after\n"
        "P1,10,20,-100,1,1.5,2,2.5,3,3.5\n"
    )
    found = cells(unfolded(sheet_of(tmp_path, text, TWO)))
    assert (found["x"], found["y"], found["z"]) == (("1", "1.5"), ("2", "2.5"), ("3", "3.5"))


@pytest.mark.parametrize(
    ("first", "second", "meaning"),
    [
        ("Nominal", "Measured", "nominal x"),
        ("Soll", "Ist", "nominal x"),
        ("Position", "TCP", "tcp x"),
        ("Sigma [mm]", "Position [mm]", "sx"),
    ],
)
def test_other_groups_have_their_meaning(
    tmp_path: Path, first: str, second: str, meaning: str
) -> None:
    found = cells(sheet_of(tmp_path, table(first, second), TWO))
    assert meaning in found and "x" in found and "marker" not in found


@pytest.mark.parametrize(
    "force", ["Load", "Last", "Carga", "Força", "Applied force", "Belastung", "Effort"]
)
def test_units_tell_what_is_a_force(tmp_path: Path, force: str) -> None:
    """In the third row or above x y z: no word for it need be known."""
    upper = f"Pose,Joints,,{force},,,Laser tracker,,\n,J1,J2,X,Y,Z,X,Y,Z\n"
    rows = "P1,10,20,0,0,-100,1,2,3\nP2,30,40,0,0,-90,4,5,6\n"
    below = sheet_of(tmp_path, f"{upper},deg,deg,N,N,N,mm,mm,mm\n{rows}", TWO)
    above = upper.replace(force, f"{force} [N]").replace("tracker", "tracker [mm]")
    for sheet in (below, sheet_of(tmp_path, above + rows, TWO)):
        assert cells(sheet)["fz"] == ("-100", "-90") and cells(sheet)["x"] == ("1", "4")
        assert {c.unit for c in sheet.columns if c.meaning in ("x", "y", "z")} == {"mm"}


def test_moments_beside_forces(tmp_path: Path) -> None:
    text = (
        "Pose,Joints,,Load,,,Torsion,,,Tracker,,\n,J1,J2,X,Y,Z,X,Y,Z,X,Y,Z\n"
        ",deg,deg,N,N,N,N*m,N*m,N*m,mm,mm,mm\nP1,10,20,0,0,-100,1,2,3,7,8,9\n"
    )
    found = cells(sheet_of(tmp_path, text, TWO))
    assert (found["fz"], found["mz"], found["z"]) == (("-100",), ("3",), ("9",))


@pytest.mark.parametrize(
    "moved",
    ["Displacements", "Measured displacement", "Durchbiegung", "Deslocamento", "Flèche",
     "Deformación", "Tracker deflection"],
)  # fmt: skip
def test_displacements_below_a_word_for_them(tmp_path: Path, moved: str) -> None:
    text = f"Pose,Joints,,Force,,,{moved},,\n,1,2,X,Y,Z,X,Y,Z\n,°,°,N,N,N,mm,mm,mm\n"
    found = cells(sheet_of(tmp_path, text + "P1,10,20,0,0,-100,1,2,3\n", TWO))
    assert found["dz"] == ("3",) and found["joint 2"] == ("20",)


@pytest.mark.parametrize(("word", "known"), [("Achsen", True), ("Axis", True), ("Cycle", False)])
def test_numbers_below_a_word_for_joints(tmp_path: Path, word: str, known: bool) -> None:
    text = f"Pose,{word},,Tracker,,\n,1,2,X,Y,Z\n,deg,deg,mm,mm,mm\nP1,10,20,1,2,3\n"
    assert ("joint 2" in cells(sheet_of(tmp_path, text, TWO))) is known


def test_names_of_markers_stay_names(tmp_path: Path) -> None:
    for first, second in (("SMR1", "SMR2"), ("Base", "Tool"), ("F", "M")):
        sheet = sheet_of(tmp_path, table(first, second), TWO)
        assert sheet.get("marker") is not None
        assert cells(sheet)["fz"][:2] == ("-100", "-100")


def test_markers_without_and_with_load_side_by_side_are_refused(tmp_path: Path) -> None:
    names = ["A before", "A after", "B before", "B after"]
    upper = "Pose," + ",,,".join(names) + ",,\n"
    text = upper + "," + ",".join(["x,y,z"] * 4) + "\n" + "P1" + ",1" * 12 + "\n"
    with pytest.raises(InputError, match="several markers without and with load"):
        sheet_of(tmp_path, text, TWO)


def test_cells_merged_downwards_hold_for_all_their_rows(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    page = book.active
    for row in (
        ["Stiffness of the arm"],
        ["Pose", "Joints", None, "Force", None, None, "before", None, None, "after"],
        [None, "q1", "q2", "Fx", "Fy", "Fz", *"xyz", *"xyz"],
        [None, "[°]", "[°]", "[N]", "[N]", "[N]", *["[mm]"] * 6],
        ["A", 10.0, 20.0, 0.0, 0.0, -100.0, 1.0, 2.0, 3.0, 1.5, 2.5, 3.5],
        [None, None, None, 0.0, 0.0, -50.0, 1.1, 2.1, 3.1, 1.3, 2.3, 3.3],
        ["B", 30.0, 40.0, 0.0, 0.0, -90.0, 4.0, 5.0, 6.0, 4.5, 5.5, 6.5],
    ):
        page.append(row)
    for area in ("A1:L1", "A2:A4", "B2:C2", "D2:F2", "G2:I2", "J2:L2", "A5:A6", "B5:B6", "C5:C6"):
        page.merge_cells(area)
    stored = io.BytesIO()
    book.save(stored)
    sheet = sheet_of(tmp_path, stored.getvalue(), TWO)
    assert not sheet.skipped
    found = cells(sheet)
    assert found["pose"] == ("A", "A", "B")
    assert found["joint 1"] == ("10", "10", "30")
    assert found["unloaded x"] == ("1", "1.1", "4")
    assert not any("not known" in note for note in sheet.notes)
