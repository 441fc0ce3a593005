"""A sample of each format, read back to the digit that is printed in it."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import FORMATS, Column, Guess, Sheet, Source
from tests.measurements.importers.reading import SIX, draft_of, sheet_of, written

SAMPLES = Path(__file__).parent / "samples"
XYZ = ("x[mm]", "y[mm]", "z[mm]")
JOINTS = "q1,q2,q3,q4,q5,q6\n" + "10,20,30,40,50,60\n11,21,31,41,51,61\n12,22,32,42,52,62\n"


def sample(name: str) -> bytes:
    return (SAMPLES / name).read_bytes()


def cells(sheet, meaning: str) -> tuple[str, ...]:
    column = sheet.get(meaning)
    assert column is not None, [c.meaning for c in sheet.columns]
    return column.cells


def test_spatial_analyzer(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, sample("spatial_analyzer.txt"))
    assert found.title == "SpatialAnalyzer's ASCII export"
    assert found.frame == "A::TRACKER_HOME"
    assert cells(found, "name") == ("P1", "P2", "P3")
    assert cells(found, "x") == ("2345.67812", "2400.00000", "2512.34567")
    assert cells(found, "sz") == ("0.01490", "0.01480", "0.01500")
    for axis in "xyz":
        column = found.get(axis)
        assert column is not None and column.unit == "mm"
        assert column.stated == "the lines above the table"


def test_spatial_analyzer_without_any_comment(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, sample("spatial_analyzer_plain.txt"))
    assert found.title == "SpatialAnalyzer's ASCII export"
    assert cells(found, "name") == ("P1", "P2", "P3")
    assert cells(found, "z") == ("1200.1234", "1180.5000", "1155.2500")
    assert found.get("x").unit is None  # and so --length is asked for


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8", "utf-8-sig", "utf-16", "utf-16-le"])
def test_leica(tmp_path: Path, encoding: str) -> None:
    text = sample("leica.csv").decode()
    found = sheet_of(tmp_path, text.encode(encoding))
    assert found.title == "a Leica tracker's table"
    assert cells(found, "x") == ("2345.6781", "2400.0000", "2512.3457")
    assert found.get("y").unit == "mm"
    assert (found.get("sx").unit, found.get("sx").factor) == ("µm", 0.5)  # U95, k = 2
    assert found.skipped == ((6, "nothing stands in X, Y, Z"),)
    columns = written(draft_of(tmp_path, _with_joints(text).encode(encoding), angle="deg"))
    assert columns["sx[um]"] == ("15.1", "15.0", "15.3")
    assert columns["temperature[degC]"] == ("20.41", "20.43", "20.47")
    assert columns["time[s]"] == ("0.0", "30.0", "90.0")
    assert columns["x[mm]"] == ("2345.6781", "2400.0000", "2512.3457")


def _with_joints(text: str) -> str:
    *above, header, first, second, third, fourth = text.splitlines()
    more = [f"{header};{';'.join(f'A{k}' for k in range(1, 7))}"]
    more += [f"{row};{';'.join(f'{k},5' for k in range(6))}" for row in (first, second)]
    more += [third, f"{fourth};{';'.join(f'{k},5' for k in range(6))}"]
    return "\n".join([*above, *more])


def test_polyworks_report(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, sample("polyworks.txt"))
    assert found.title == "a PolyWorks report table"
    assert cells(found, "name") == ("point 1", "point 2")
    assert cells(found, "y") == ("-512.003", "-498.999")
    assert found.get("x").unit == "mm"
    assert found.skipped == ((11, "nothing stands in y [mm]"),)
    assert {"column Nominal", "column Deviation", "control 3D"} <= set(found.unused)


def test_robodk(tmp_path: Path) -> None:
    draft = draft_of(tmp_path, sample("robodk.csv"))
    assert draft.sheet.title == "RoboDK's calibration measurements"
    columns = written(draft)
    assert columns["joint_2[deg]"] == ("-80.2500", "-70.0000", "-95.5000")
    assert columns["x[mm]"] == ("2345.6780", "2400.0000", "2512.3460")
    assert draft.sheet.get("x").stated == "the format prescribes it"
    names, places = draft.markers
    assert names == ("M2", "M2", "M1")
    np.testing.assert_allclose(places["M1"], [-0.05, 0.01, 0.12])


def test_a_tool_of_zeros_was_never_set(tmp_path: Path) -> None:
    lines = sample("robodk.csv").decode().splitlines()
    zeros = [",".join([*line.split(",")[:-3], "0", "0", "0"]) for line in lines[1:]]
    draft = draft_of(tmp_path, "\n".join([lines[0], *zeros]).encode())
    assert draft.sheet.title == "RoboDK's calibration measurements"
    assert draft.markers == ((), {})


def test_delmia(tmp_path: Path) -> None:
    draft = draft_of(tmp_path, sample("delmia.txt"))
    assert draft.sheet.title == "a DELMIA tag table"
    assert draft.pose == ("Tag.1", "Tag.2")
    columns = written(draft)
    assert columns["z[mm]"] == ("1200.123", "1180.500")
    assert columns["joint_6[deg]"] == ("12.500", "-8.000")
    assert not any("Roll" in item for item in draft.unused)  # the placed robot tells of them


def test_a_joint_that_slides_is_in_mm_there(tmp_path: Path) -> None:
    text = "Tag\tX\tY\tZ\tRoll\tPitch\tYaw\tJ1\tJ2\nT1\t1\t2\t3\t0\t0\t0\t250.5\t90\n"
    draft = draft_of(tmp_path, text, ("slide", "turn"), ("slide",))
    assert [header for header, _ in draft.joints.written] == ["slide[mm]", "turn[deg]"]
    np.testing.assert_allclose(draft.joints.values, [[0.2505, np.pi / 2]])


def test_a_plain_list(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, sample("plain_points.txt"))
    assert cells(found, "name") == ("P1", "P2", "P3")
    assert cells(found, "y") == ("-512.0034", "-498.9999", "-470.1230")


def test_a_comment_may_hold_the_headers(tmp_path: Path) -> None:
    text = "# q1 q2 q3 q4 q5 q6 x y z\n1 2 3 4 5 6 7.5 8 9\n2 3 4 5 6 7 8.5 9 1\n"
    columns = written(draft_of(tmp_path, text, angle="deg", length="m"))
    assert columns["joint_3[deg]"] == ("3", "4")
    assert columns["x[m]"] == ("7.5", "8.5")


def test_two_readings_of_a_file_are_one_question(tmp_path: Path) -> None:
    nine = "1 2 3 4 5 6 7.5 8 9\n2 3 4 5 6 7 8.5 9 1\n"
    with pytest.raises(InputError, match=r"either order.*--columns 'x,y,z,q1.*or --columns 'q1"):
        sheet_of(tmp_path, nine)
    told = sheet_of(tmp_path, nine, columns=(*(f"q{k}" for k in range(1, 7)), "x", "y", "z"))
    assert cells(told, "x") == ("7.5", "8.5")
    both = "\n".join(["T1 " + " ".join(map(str, range(12))), "T2 " + " ".join(map(str, range(12)))])
    assert sheet_of(tmp_path, both).title == "a DELMIA tag table"
    rival = "Tag,X,Y,Z,Roll,Pitch,Yaw,J1,J2,J3,J4,J5,J6,TCP X,TCP Y,TCP Z\nT1" + ",1" * 15
    with pytest.raises(InputError, match=r"more than one way.*--format robodk or --format delmia"):
        sheet_of(tmp_path, rival)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x[mm],y[mm],z[mm]\n1,2,3\n1,2,3,4\n", ["line 3", "4 cells", "3 columns"]),
        ("x[mm],y[mm],z[mm]\n1,2,3\n1,2\n", ["line 3", "2 cells"]),
        ("x;y;z\n1,5;2,5;3,5\n1.5;2,5;3,5\n", ["with a comma (1,5) and with a point (1.5)"]),
        ("x;y;z\n1.234,5;2,5;3,5\n", ["'1.234,5'", "thousands"]),
        ("x;y;z\n", ["no row of readings"]),
        ("", ["the file is empty"]),
        ("hello\nworld\n", ["no line of this file holds readings"]),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x81\0", ["no text"]),
        (b"\0\1\2\3" * 40, ["no text"]),
        ('x,y,z\n"1,2,3\n', ["line 2", "Quotation marks"]),
    ],
)
def test_what_cannot_be_read_is_one_message(
    tmp_path: Path, text: str | bytes, words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        sheet_of(tmp_path, text)
    for word in words:
        assert word in str(caught.value)


def test_units_are_never_guessed(tmp_path: Path) -> None:
    rows = "10,20,30,40,50,60,1,2,3\n"
    for head, told, word in (
        ("q1,q2,q3,q4,q5,q6,x,y,z", {"length": "mm"}, "--angle"),
        ("q1,q2,q3,q4,q5,q6,x,y,z", {"angle": "deg"}, "--length"),
        ("q1,q2,q3,q4,q5,q6,x [mm],y [mm],z [mm]", {"angle": "deg", "length": "m"}, "says mm"),
    ):
        with pytest.raises(InputError, match=word):
            draft_of(tmp_path, f"{head}\n{rows}", **told)


def test_every_column_is_used_or_listed(tmp_path: Path) -> None:
    head = "id,q1,q2,q3,q4,q5,q6,x [mm],y (mm),z/mm,quality,RMS,comment,air temp"
    text = f"{head}\nP1,1,2,3,4,5,6,7,8,9,0.9,0.01,ok,20.1\nP2,2,2,3,4,5,6,7,8,9,0.9,0.01,ok,20.2\n"
    draft = draft_of(tmp_path, text, angle="rad")
    used = [c.header for c in draft.sheet.columns if c.meaning != "temperature"]
    listed = [item.partition(":")[0].removeprefix("column ") for item in draft.unused]
    assert sorted([*used, *listed]) == sorted(head.split(","))
    assert any("air temp: its unit is not stated" in item for item in draft.unused)


@pytest.mark.parametrize("names", [SIX, tuple(f"q{k}" for k in range(6)), ("J1", "J 2", "A3",
                         "Axis 4", "theta5", "joint6 angle")])  # fmt: skip
def test_joints_go_by_name_or_number(tmp_path: Path, names: tuple[str, ...]) -> None:
    text = f"{','.join(names)},x[m],y[m],z[m]\n1,2,3,4,5,6,7,8,9\n"
    columns = written(draft_of(tmp_path, text, angle="deg"))
    assert [columns[f"{name}[deg]"][0] for name in SIX] == list("123456")


def test_nominal_and_deviation_add_up_in_decimals(tmp_path: Path) -> None:
    head = "x_t,y_t,z_t,x_dif,y_dif,z_dif," + ",".join(SIX)
    text = f"{head}\n100.1,200.2,300.3,0.03,-0.2,0.05,1,2,3,4,5,6\n"
    draft = draft_of(tmp_path, text, angle="deg", length="mm")
    assert [cells[0] for _, cells in draft.readings] == ["100.13", "200.0", "300.35"]
    assert draft.reversed is not None
    np.testing.assert_allclose(draft.reversed[0], [0.10007, 0.2004, 0.30025])


def test_what_is_called_measured_goes_before_what_is_not(tmp_path: Path) -> None:
    joints = ",".join(f"{k}" for k in range(6))
    for head in ("X,Y,Z,X meas,Y meas,Z meas", "X nom,Y nom,Z nom,Actual X,Actual Y,Actual Z"):
        text = f"{head},{','.join(SIX)}\n1,2,3,1.5,2.5,3.5,{joints}\n"
        draft = draft_of(tmp_path, text, angle="deg", length="mm")
        assert [cells[0] for _, cells in draft.readings] == ["1.5", "2.5", "3.5"]
        assert len([u for u in draft.unused if "the measured position stands beside it" in u]) == 3
    text = f"X nom,Y nom,Z nom,dX,dY,dZ,{','.join(SIX)}\n1,2,3,0.5,0.5,0.5,{joints}\n"
    draft = draft_of(tmp_path, text, angle="deg", length="mm")
    assert not draft.displaced
    assert [cells[0] for _, cells in draft.readings] == ["1.5", "2.5", "3.5"]


class Mine:
    """A format of somebody's own, in a dozen lines."""

    name, title = "mine", "my own format"

    def sniff(self, source: Source) -> Guess:
        return Guess(0.95, "it says so") if source.data.startswith(b"MINE") else Guess(0.0)

    def read(self, source: Source) -> Sheet:
        values = source.data.decode().split()[1:]
        columns = [Column(a, a, "mm", "my word", (v,)) for a, v in zip("xyz", values, strict=True)]
        return Sheet(source.path, self.title, "it says so", tuple(columns), (1,), total=1)


def test_formats_add(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("MINE 1 2 3")
    source = Source(path, SIX)
    importer, why = (FORMATS + (Mine(),)).chosen(source)
    assert (importer.name, why) == ("mine", "it says so")
    assert importer.read(source).get("z").cells == ("3",)
    assert FORMATS.chosen(source)[0].name == "points"
    assert FORMATS.chosen(source, "sa")[0].name == "sa"
    with pytest.raises(InputError, match=r"no format is called 'mine'.*sa, leica"):
        FORMATS.chosen(source, "mine")
