"""Rows that hold a pose with and without load, and headers in the languages of laboratories."""

from dataclasses import replace
from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.words import meaning_of, unit_of_header
from sk120stiff.measurements.importers.loads.pairs import unfolded
from tests.measurements.importers.reading import sheet_of

PAIRS = "pose,q1,x_unloaded,y_unloaded,z_unloaded,x_loaded,y_loaded,z_loaded,Fx,Fy,Fz,time\n"
ROWS = "a,0.1,1,2,3,1.5,2.5,3.5,10,20,30,1\nb,0.2,4,5,6,4.5,5.5,6.5,-1,-2,-3,2\n"


def test_a_row_is_a_reading_without_load_and_one_with_it(tmp_path: Path) -> None:
    found = unfolded(sheet_of(tmp_path, PAIRS + ROWS))
    cells = {c.meaning: c.cells for c in found.columns}
    assert cells["x"] == ("1", "1.5", "4", "4.5") and cells["z"] == ("3", "3.5", "6", "6.5")
    assert cells["fy"] == ("0", "20", "0", "-2")
    assert cells["joint 1"] == ("0.1", "0.1", "0.2", "0.2")
    assert found.lines == (2, 2, 3, 3) and found.total == 4
    assert "time" not in cells and any("column time" in text for text in found.unused)
    assert any("two readings" in note for note in found.notes)


def test_rows_that_repeat_the_reading_without_load_share_it(tmp_path: Path) -> None:
    found = unfolded(sheet_of(tmp_path, PAIRS + ROWS))
    assert found.zero == "separate" and any("of its own" in note for note in found.notes)
    again = "a,0.1,1,2,3,1.9,2.9,3.9,15,25,35,3\n"
    found = unfolded(sheet_of(tmp_path, PAIRS + ROWS + again))
    assert found.zero == "shared" and any("share a zero reading" in note for note in found.notes)


@pytest.mark.parametrize(
    ("header", "words"),
    [
        (PAIRS.replace("y_unloaded", "other"), ["unloaded y", "--columns"]),
        (PAIRS.replace("Fx,Fy,Fz", "a,b,c"), ["no column says the load", "--loads-file"]),
        (PAIRS.replace("x_loaded", "x_loaded[mm]"), ["different units"]),
    ],
)
def test_half_a_pair_is_refused(tmp_path: Path, header: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        unfolded(sheet_of(tmp_path, header + ROWS))
    assert all(word in str(caught.value) for word in words)


def test_a_sheet_without_pairs_stays(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, "x,y,z\n1,2,3\n")
    assert unfolded(sheet) == replace(sheet)


@pytest.mark.parametrize(
    ("header", "meaning"),
    [
        ("px", "x"), ("pos_y", "y"), ("PosZ", "z"), ("Kraft X [N]", "fx"), ("Force Y (N)", "fy"),
        ("Déplacement X (mm)", "dx"), ("Verschiebung z [mm]", "dz"), ("x deflection [mm]", "dx"),
        ("X unbelastet [mm]", "unloaded x"), ("belastet y", "loaded y"), ("Messpunkt", "name"),
    ],
)  # fmt: skip
def test_what_headers_mean(header: str, meaning: str) -> None:
    assert meaning_of(unit_of_header(header)[0]) == (meaning, 1.0)


def test_a_file_of_joints_names_the_columns_that_were_not_understood(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        sheet_of(tmp_path, "q1,q2,u (mm),v (mm)\n1,2,3,4\n", ("a", "b"))
    assert "u (mm), v (mm)" in str(caught.value) and "--columns" in str(caught.value)


def test_a_row_of_units_may_hold_dashes(tmp_path: Path) -> None:
    found = sheet_of(tmp_path, "pose,x,y,z\n-,mm,mm,mm\n1,2,3,4\n")
    assert [(c.meaning, c.unit) for c in found.columns][1:] == [(a, "mm") for a in "xyz"]
    assert found.lines == (3,)
