"""A column that may be the mass on the tool, and what the user said of it."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Sheet
from sk120stiff.measurements.importers.loads.told_mass import with_told_mass
from sk120stiff.measurements.importers.told import Told
from tests.measurements.importers.reading import draft_of, sheet_of

TWO = ("joint_1", "joint_2")


def read(folder: Path, *headers: str) -> Sheet:
    head = ",".join(["q1[deg]", "q2[deg]", "x[mm]", "y[mm]", "z[mm]", *headers])
    rows = [f"{k},2,3,4,5{',5' * len(headers)}" for k in range(2)]
    return sheet_of(folder, "\n".join([head, *rows]), TWO)


@pytest.mark.parametrize("header", ["m_payload", "Payload_mass", "m_load", "mPayload"])
def test_words_of_a_payload(tmp_path: Path, header: str) -> None:
    assert read(tmp_path, header).has("payload")


@pytest.mark.parametrize(
    "header", ["load_kg", "Last_kg", "carga (kg)", "Traglast_kg", "m_payload_kg"]
)
def test_a_unit_of_mass_tells_it(tmp_path: Path, header: str) -> None:
    column = read(tmp_path, header).get("payload")
    assert column is not None and column.unit == "kg"


@pytest.mark.parametrize("header", ["mass", "Masse", "m", "Last"])
def test_words_that_mean_much_are_it_if_kg_was_told(tmp_path: Path, header: str) -> None:
    sheet = read(tmp_path, header)
    assert with_told_mass(sheet, Told(load="kg")).has("payload")
    left = with_told_mass(sheet, Told())
    assert not left.has("payload") and "--load kg says it" in left.notes[-1]


def test_two_that_may_be_it_are_asked_for(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mass and m may each be the mass on the tool"):
        with_told_mass(read(tmp_path, "mass", "m"), Told(load="kg"))


def test_a_told_unit_of_no_column_is_pointed_out(tmp_path: Path) -> None:
    sheet = with_told_mass(read(tmp_path, "remark"), Told(load="kg"))
    assert "--load kg is of no column; not understood are remark" in sheet.notes[-1]


def test_a_payload_without_a_unit_asks_for_it(tmp_path: Path) -> None:
    text = "q1[deg],q2[deg],x[mm],y[mm],z[mm],m_payload\n1,2,3,4,5,6\n"
    with pytest.raises(InputError, match="--load"):
        draft_of(tmp_path, text, TWO)
    assert draft_of(tmp_path, text, TWO, load="kg").loads.wrench[0, 2] < -50.0
