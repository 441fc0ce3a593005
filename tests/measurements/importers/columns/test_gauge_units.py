"""Units of dial gauges, and rows of units of which not every cell is understood."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.gauge_units import counted_unit
from sk120stiff.measurements.importers.columns.unread_axes import with_gauges
from sk120stiff.measurements.importers.columns.words import is_unit, unit_of_header
from sk120stiff.measurements.importers.drafting import Draft
from tests.measurements.importers.reading import draft_of, sheet_of, written

HEAD = "Pose;A1;A2;A3;A4;A5;A6;Fz;Bemerkung;dX;dY;dZ\n"
ROWS = "1;1,5;2;3;4;5;6;10,0;gut;-62,9;169,2;-324,20\n2;2,5;2;3;4;5;6;-10,0;-;-6,9;16,2;-32,4\n"


def read(folder: Path, units: str, head: str = HEAD, **told: object) -> Draft:
    return draft_of(folder, f"{head}{units}{ROWS}", **told)


@pytest.mark.parametrize(
    ("unit", "cells"),
    [
        ("1/100 mm", ("-629", "-69")), ("1/100mm", ("-629", "-69")), ("0,01 mm", ("-629", "-69")),
        ("0.01 mm", ("-629", "-69")), ("[0,01 mm]", ("-629", "-69")),
        ("hundredths of mm", ("-629", "-69")), ("Hundertstel mm", ("-629", "-69")),
        ("Hundertstel", ("-629", "-69")), ("1/1000 mm", ("-62.9", "-6.9")),
        ("0.001 mm", ("-62.9", "-6.9")), ("thousandths of a mm", ("-62.9", "-6.9")),
        ("1/10 mm", ("-6290", "-690")), ("10 µm", ("-629", "-69")), ("µm", ("-62.9", "-6.9")),
        ("microns", ("-62.9", "-6.9")), ("10^-2 mm", ("-629", "-69")),
        ("10⁻² mm", ("-629", "-69")), ("10-2 mm", ("-629", "-69")), ("1e-2 mm", ("-629", "-69")),
        ("10**-2 mm", ("-629", "-69")), ("x 0.01 mm", ("-629", "-69")),
        ("Skt. = 0,01 mm", ("-629", "-69")), ("div 0.01 mm", ("-629", "-69")),
    ],
)  # fmt: skip
def test_units_of_dial_gauges(unit: str, cells: tuple[str, str], tmp_path: Path) -> None:
    found = read(tmp_path, f";°;°;°;°;°;°;kgf;;{unit};{unit};{unit}\n")
    assert written(found)["dx[um]"] == cells
    np.testing.assert_allclose(found.measured[:, 0], 1e-6 * np.array(cells, float), rtol=1e-12)
    np.testing.assert_allclose(found.joints.values[:, 0], np.radians([1.5, 2.5]))
    np.testing.assert_allclose(found.loads.wrench[:, 2], [98.0665, -98.0665])


@pytest.mark.parametrize("unit", ["mil", "mils", "thou", "1/1000 in", "0.001 in", "10^-3 in"])
def test_thousandths_of_an_inch(unit: str, tmp_path: Path) -> None:
    found = read(tmp_path, f";°;°;°;°;°;°;kgf;;{unit};{unit};{unit}\n")
    np.testing.assert_allclose(found.measured[:, 0], 25.4e-6 * np.array([-62.9, -6.9]))


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("Messuhr 1/100 mm", "Messuhr"), ("Messuhr in 1/100 mm", "Messuhr"),
        ("dX 0,01 mm", "dX"), ("X x 0.01 mm", "X x"), ("Marker 1 mm", "Marker 1"),
        ("J 10 deg", "J 10"), ("x mm", "x"),
    ],
)  # fmt: skip
def test_units_behind_a_name_without_brackets(header: str, name: str) -> None:
    assert unit_of_header(header)[0] == name


@pytest.mark.parametrize(
    "name",
    ["Messuhr", "Dial reading", "Messuhrablesung", "Anzeige Messuhr", "Comparador", "Indicator",
     "Gauge 1", "DTI", "Reloj comparador"],
)  # fmt: skip
def test_names_of_gauges(name: str) -> None:
    known = with_gauges([name, "Messrichtung"], [None, ("reading direction", 1.0)])
    assert known[0] == ("gauge", 1.0)


def test_a_gauge_that_names_its_axis_is_a_displacement_and_told(tmp_path: Path) -> None:
    head = HEAD.replace("dX;dY;dZ", "Messuhr X [1/100 mm];Dial Y [0.01 mm];Gauge z [1/100 mm]")
    found = read(tmp_path, ";°;°;°;°;°;°;kgf;;;;\n", head)
    assert written(found)["dz[um]"] == ("-3242.0", "-324")
    assert any("Dial Y [0.01 mm] along y" in said for said in found.said)


def test_a_unit_of_displacements_that_is_not_known_is_told(tmp_path: Path) -> None:
    head = HEAD.replace("dX;dY;dZ", "dX [cmm];dY [cmm];dZ [cmm]")
    with pytest.raises(InputError, match=r"units of dX \[cmm\], dY \[cmm\], dZ \[cmm\] are not"):
        read(tmp_path, "", head)


def test_the_same_in_headers_says_what_it_was(tmp_path: Path) -> None:
    head = "Pose;A1 [°];A2 [°];A3 [°];A4 [°];A5 [°];A6 [°];Fz kp;Bemerkung;dX [0,01 mm];"
    found = read(tmp_path, "", f"{head}dY (1/100 mm);dZ [hundredths of mm]\n")
    assert written(found)["dz[um]"] == ("-3242.0", "-324")
    assert found.loads.wrench[0, 2] == pytest.approx(98.0665)
    column = found.sheet.get("dx")
    assert column is not None and column.unit == "um"
    assert column.stated == "the header, line 1: 0,01 mm"


def test_a_cell_that_is_no_unit_is_named_and_the_others_count(tmp_path: Path) -> None:
    units = ";°;°;°;°;°;°;daN;Text;Skt;Skt;Skt\n"
    with pytest.raises(InputError, match="the unit 'Skt' of the column 'dX' is not known"):
        read(tmp_path, units)
    found = read(tmp_path, units, length="mm")
    assert written(found)["dx[mm]"] == ("-62.9", "-6.9")
    assert found.loads.wrench[0, 2] == pytest.approx(100.0)
    assert any("line 2" in note and "'Text' (Bemerkung)" in note for note in found.said)


@pytest.mark.parametrize("row", ["a;b;c;d;e;f;g;h;i;m;k;l\n", ";;;;;;;;;;;\n"])
def test_a_row_of_words_is_no_row_of_units(row: str, tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, HEAD + row + ROWS)
    assert all(c.unit is None for c in sheet.columns)


@pytest.mark.parametrize(
    "text", ["1/100", "0 mm", "1/30 mm", "0.01 kg", "x mm", "mm/100", "", "1", "100 mm"]
)
def test_what_is_no_unit_of_a_gauge(text: str) -> None:
    assert counted_unit(text) is None
    assert not is_unit("0 mm")


def test_units_of_the_file_count_for_columns_that_were_named(tmp_path: Path) -> None:
    names = ("pose", *(f"q{k}" for k in range(1, 7)), "fz", "-", "dx", "dy", "dz")
    head = "Pose;A1;A2;A3;A4;A5;A6;Fz;Bemerkung;Messuhr X;Messuhr Y;Messuhr Z\n"
    units = ";°;°;°;°;°;°;kgf;;1/100 mm;1/100 mm;1/100 mm\n"
    found = draft_of(tmp_path, head + units + ROWS, known={"columns": names})
    assert written(found)["dx[um]"] == ("-629", "-69")
    assert found.loads.wrench[0, 2] == pytest.approx(98.0665)
