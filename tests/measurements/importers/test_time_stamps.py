"""Times beside positions, whether headers name them or not."""

from pathlib import Path

import pytest

from sk120stiff.measurements.importers.clock import is_clock
from tests.measurements.importers.formats.test_formats import cells
from tests.measurements.importers.reading import sheet_of

HEAD = "// SpatialAnalyzer 2023.1  Points Export\n// Units: Millimeters\n"
ROWS = """\
A,LoadA,P1_A,-3228.7505,-2261.0934,4129.6350,10:00:33.930
A,LoadA,P2_A,-5546.9634,-1382.6634,1829.1664,10:00:59.660
A,LoadA,P3_A,-4594.5943,-2429.6356,3855.4847,10:01:28.548
"""
TIMES = ("10:00:33.930", "10:00:59.660", "10:01:28.548")


@pytest.mark.parametrize(
    "names",
    [
        "// Collection, Group, Target, X, Y, Z, Timestamp\n",
        "// Collection, Group, Target, X, Y, Z, Time Stamp\n",
        "// Collection Group Target X Y Z\n",  # and nothing of the time
        "",
    ],
)
def test_spatial_analyzer_with_times(tmp_path: Path, names: str) -> None:
    found = sheet_of(tmp_path, HEAD + names + ROWS)
    assert found.title == "SpatialAnalyzer's ASCII export"
    assert cells(found, "name") == ("P1_A", "P2_A", "P3_A")
    assert cells(found, "z") == ("4129.6350", "1829.1664", "3855.4847")
    assert cells(found, "time") == TIMES


def test_a_date_and_a_time_behind_the_numbers(tmp_path: Path) -> None:
    rows = ROWS.replace(",10:0", ",2026-10-14,10:0")
    found = sheet_of(tmp_path, HEAD + rows)
    assert cells(found, "date") == ("2026-10-14",) * 3
    assert cells(found, "time") == TIMES


def test_names_that_are_told_of_a_file_with_times(tmp_path: Path) -> None:
    told = ("-", "-", "name", "x", "y", "z", "time")
    found = sheet_of(tmp_path, ROWS, columns=told)
    assert cells(found, "x") == ("-3228.7505", "-5546.9634", "-4594.5943")
    assert cells(found, "time") == TIMES


@pytest.mark.parametrize(
    "cell",
    [
        "10:00:33.930",
        "10:00",
        "2026-10-14",
        "14.10.2026 10:00:33",
        "2026-10-14T10:00:33Z",
        "1:05 PM",
    ],
)
def test_a_clock(cell: str) -> None:
    assert is_clock(cell)


@pytest.mark.parametrize("cell", ["", "P1", "10", "10.5", "A:1", "Z", "PM", "1-2", "2026"])
def test_no_clock(cell: str) -> None:
    assert not is_clock(cell)


MOTIVE = """\
Format Version,1.23,Rotation Type,Quaternion,Length Units,Millimeters,Coordinate Space,Global

,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body
,,Tool,Tool,Tool,Tool,Tool,Tool,Tool,Tool
,,"A1B2","A1B2","A1B2","A1B2","A1B2","A1B2","A1B2","A1B2"
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,
36000,300.0,0.73000087,0.45828624,0.27113581,0.42843649,591.9998,-367.8080,-2380.7021,0.000152
37200,310.0,-0.94583138,-0.05736613,0.25111788,0.19761561,476.8952,285.9394,-2380.3349,0.000152
"""


def test_motive_with_a_blank_last_header(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, MOTIVE)
    assert cells(found, "z") == ("-2380.7021", "-2380.3349")
    assert cells(found, "qw") == ("0.42843649", "0.19761561")
    assert cells(found, "time") == ("300.0", "310.0")
    assert [c.header for c in found.spare] == ["Frame", "Mean Marker Error"]


def test_a_blank_last_header_is_a_column_without_a_name(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, "name,x[mm],y[mm],z[mm],\nA,1,2,3,0.5\nB,4,5,6,0.5\n")
    assert cells(found, "z") == ("3", "6")
    assert [(c.header, c.cells) for c in found.spare] == [("column 5", ("0.5", "0.5"))]
