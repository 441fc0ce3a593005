"""How laboratories call positions before and after a load, displacements, and units behind them."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.words import meaning_of, unit_of_header
from sk120stiff.measurements.importers.loads.pairs import unfolded
from tests.measurements.importers.reading import sheet_of

TWO = ("joint_1", "joint_2")


@pytest.mark.parametrize(
    ("without", "under"),
    [
        ("{} vorher", "{} nachher"),
        ("{}_before", "{}_after"),
        ("before {} [mm]", "after {} [mm]"),
        ("Position {} before loading (mm)", "Position {} after loading (mm)"),
        ("{} ohne Last", "{} mit Last"),
        ("{}Initial", "{}Final"),
        ("{} zero", "{} load"),
        ("{} vor Belastung / mm", "{} nach Belastung / mm"),
        ("pos {} unloaded", "pos {} loaded"),
        ("ist {} unbelastet", "ist {} belastet"),
        ("{}_vor", "{}_nach"),
        ("Tracker {} start", "Tracker {} end"),
        ("Nullmessung {}", "Lastmessung {}"),
    ],
)
def test_positions_before_and_after(tmp_path: Path, without: str, under: str) -> None:
    axes = [form.format(axis) for form in (without, under) for axis in "xyz"]
    text = f"q1;q2;{';'.join(axes)};Kraft X [N]\n1;2;3;4;5;6;7;8;-9\n"
    found = {c.meaning: c.cells for c in unfolded(sheet_of(tmp_path, text, TWO)).columns}
    assert (found["x"], found["y"], found["z"]) == (("3", "6"), ("4", "7"), ("5", "8"))
    assert found["fx"] == ("0", "-9")


@pytest.mark.parametrize(
    "header", ["x after unloading", "x nach Entlastung", "Fx before", "load x"]
)
def test_what_may_be_something_else_is_not_taken_for_it(header: str) -> None:
    assert meaning_of(header) is None


@pytest.mark.parametrize(
    "header", ["deltaX", "Delta x / mm", "Δx [mm]", "delta_x", "ΔX in mm", "x delta"]
)
def test_a_difference_without_a_position_is_a_displacement(tmp_path: Path, header: str) -> None:
    axes = [header.replace("x", axis).replace("X", axis.upper()) for axis in "xyz"]
    sheet = sheet_of(tmp_path, f"q1;q2;{';'.join(axes)}\n1;2;3;4;5\n", TWO)
    assert [c.meaning for c in sheet.columns][2:] == ["dx", "dy", "dz"]


def test_beside_a_nominal_position_it_is_a_deviation(tmp_path: Path) -> None:
    text = "q1,q2,nom x,nom y,nom z,delta x,delta y,delta z\n1,2,3,4,5,6,7,8\n"
    sheet = sheet_of(tmp_path, text, TWO)
    assert sheet.has("nominal x", "deviation x") and not sheet.has("dx")


@pytest.mark.parametrize(
    ("header", "name", "unit"),
    [
        ("Theta_1 / Grad", "Theta_1", "deg"),
        ("Delta x / mm", "Delta x", "mm"),
        ("q1 in degrees", "q1", "deg"),
        ("Mx / Nm", "Mx", "Nm"),
        ("x, mm", "x", "mm"),
        ("X/mm", "X", "mm"),
        ("date / time", "date / time", None),
        ("Datum/Uhrzeit", "Datum/Uhrzeit", None),
    ],
)
def test_units_behind_a_name(header: str, name: str, unit: str | None) -> None:
    assert unit_of_header(header) == (name, unit)


def test_the_message_names_what_was_not_understood(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        sheet_of(tmp_path, "q1,q2,u (mm),v (mm),Fx [N]\n1,2,3,4,5\n", TWO)
    assert "unknown meaning are u (mm), v (mm)" in caught.value.what
    assert "x unloaded" in str(caught.value.remedy)
    with pytest.raises(InputError, match="no positions") as caught:
        sheet_of(tmp_path, "name,q1,q2\na,1,2\n", TWO)
    assert "--joints-file" in str(caught.value.remedy) and "--columns" not in str(caught.value)
