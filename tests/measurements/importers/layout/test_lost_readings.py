"""Rows in which nothing was read, and what an instrument writes there instead of a blank."""

from pathlib import Path

import pytest

from sk120stiff import load_robot
from sk120stiff.measurements.importers import Imported, Told, import_readings
from sk120stiff.measurements.importers.layout.lost_readings import without_lost
from tests.measurements.importers.reading import sheet_of
from tests.measurements.importers.tracked import campaign, ur5

SEEN = campaign(12)
HEAD = ",".join([*(f"q{k} [deg]" for k in range(1, 7)), "x [mm]", "y [mm]", "z [mm]"])


def brought(folder: Path, lost: dict[int, str], head: str = HEAD, scale: float = 1.0) -> Imported:
    path = folder / "a.csv"
    rows = [
        ",".join([*(f"{v:.5f}" for v in q), *(f"{scale * v:.4f}" for v in x)])
        for q, x in zip(SEEN.q, SEEN.x, strict=True)
    ]
    for row, text in lost.items():
        rows[row] = ",".join([*(f"{v:.5f}" for v in SEEN.q[row]), text])
    path.write_text("\n".join([head, *rows]) + "\n")
    return import_readings(path, load_robot(ur5(), tool="tool0"), Told())


@pytest.mark.parametrize(
    "number", ["9999", "-999", "99999.0", "1e10", "9999.99", "-1e30", "0", "0.000"]
)
def test_a_number_that_stands_for_nothing_is_left_out(tmp_path: Path, number: str) -> None:
    text = ",".join([number] * 3)
    found = brought(tmp_path, {3: text, 7: text})
    assert found.readings.n_readings == 10
    (first, second) = found.draft.sheet.skipped
    assert (first[0], second[0]) == (5, 9) and first[1] == (
        f"{number} in x [mm], y [mm], z [mm], as where nothing was read"
    )
    assert found.fitted is not None and found.fitted.rms < 3e-3


@pytest.mark.parametrize("text", ["9999,9999,1200", "1234.5,1234.5,1234.5", "2500,2500,2500"])
def test_other_numbers_are_readings(tmp_path: Path, text: str) -> None:
    rows = [",".join(f"{v:.4f}" for v in x) for x in SEEN.x]
    sheet = sheet_of(tmp_path, "\n".join(["x [mm],y [mm],z [mm]", *rows, text, text]) + "\n")
    assert len(without_lost(sheet).lines) == 14


def test_one_zero_may_be_where_the_instrument_was_set_to_zero(tmp_path: Path) -> None:
    assert brought(tmp_path, {3: "0,0,0"}).readings.n_readings == 12


def test_displacements_of_zero_are_readings(tmp_path: Path) -> None:
    head = HEAD.replace("x [", "dx [").replace("y [", "dy [").replace("z [", "dz [")
    lost = dict.fromkeys(range(3), "0,0,0") | {5: "9999,9999,9999", 6: "9999,9999,9999"}
    found = brought(tmp_path, lost, head, 1e-4)
    assert found.readings.n_readings == 10
    assert [line for line, _ in found.draft.sheet.skipped] == [7, 8]


def test_a_number_among_the_others_is_a_reading(tmp_path: Path) -> None:
    """Nines within what was measured stand for themselves."""
    rows = [f"{900 + 20 * k},{900 + 15 * k},{1100 - 20 * k}" for k in range(12)]
    head = "x [mm],y [mm],z [mm]"
    sheet = sheet_of(tmp_path, "\n".join([head, *rows, "999,999,999", "999,999,999"]) + "\n")
    assert without_lost(sheet) is sheet
