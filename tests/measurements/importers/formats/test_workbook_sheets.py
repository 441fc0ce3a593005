"""Sheets of one workbook: positions without and with load, joints and forces."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import Imported, Told, import_readings
from sk120stiff.measurements.importers.formats.workbook_sheets import named_sheets, under_load
from tests.measurements.importers.tracked import TURN, campaign, ur5

SEEN = campaign(14)
MOVED = np.random.default_rng(3).normal(0.0, 2.0, (14, 3))  # mm, what the load moves, tracker axes
NAMES = {"free": "Tracker unloaded (mm)", "pushed": "Tracker loaded (mm)", "q": "Joints (deg)",
         "force": "Force (N)"}  # fmt: skip


def workbook(path: Path, **titles: str) -> Path:
    """Titles of the sheets of positions without load and with it, joints and force."""
    content = {
        "free": (["X", "Y", "Z"], SEEN.x), "pushed": (["X", "Y", "Z"], SEEN.x + MOVED),
        "q": ([f"A{k}" for k in range(1, 7)], SEEN.q), "force": (["Fz"], np.full((14, 1), -200.0)),
    }  # fmt: skip
    book = openpyxl.Workbook()
    book.active.title = "Info"
    for row in (["Campaign", "A"], ["Operator", "B"]):
        book.active.append(row)
    for what, title in titles.items():
        sheet = book.create_sheet(title)
        sheet.append(["Pose", *content[what][0]])
        for name, row in zip(SEEN.names, content[what][1], strict=True):
            sheet.append([name, *map(float, row)])
    stream = io.BytesIO()
    book.save(stream)
    path.write_bytes(stream.getvalue())
    return path


def brought(path: Path, told: Told | None = None, **given: Any) -> Imported:
    return import_readings(path, load_robot(ur5(), tool="tool0"), told, **given)


def test_all_sheets_of_a_campaign_by_their_names(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", **NAMES)
    found = brought(book, before=book)
    assert found.mode == "load pairs" and found.useful_poses == 14
    moved = 1e3 * found.readings.displacement
    np.testing.assert_allclose(moved, TURN.inv().apply(MOVED), atol=0.15)
    np.testing.assert_allclose(found.readings.wrench[:, 2], -200.0)
    assert [item for item in found.draft.unused if "sheet" in item] == ["sheet Info"]
    column = found.draft.sheet.get("fz")
    assert column is not None and column.stated == "the name of the sheet Force (N)"


def test_sheets_whose_names_say_nothing_are_told_what_they_are_for(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", free="A (mm)", pushed="B (mm)", q="C (deg)", force="D")
    told = Told(load="N")
    with pytest.raises(InputError, match=r"sheets A \(mm\), B \(mm\).*--sheet 'A \(mm\)'"):
        brought(book, told, before=book, loads_file=book)
    found = brought(book, told, before=book, loads_file=book, sheet="B (mm)")
    assert found.useful_poses == 14
    sheets = ["B (mm)", "before=A (mm)", "joints=C (deg)", "loads=D"]
    again = brought(book, told, before=book, sheet=sheets)
    np.testing.assert_array_equal(again.readings.displacement, found.readings.displacement)


def test_the_question_which_sheet_says_how_to_give_both(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", **NAMES)
    with pytest.raises(InputError, match=r"--sheet 'Tracker loaded \(mm\)' --before all\.xlsx"):
        brought(book)


def test_a_loaded_sheet_takes_the_loads_of_its_workbook(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", **NAMES)
    loaded = brought(book, sheet=NAMES["pushed"])
    np.testing.assert_allclose(loaded.draft.loads.wrench[:, 2], -200.0)
    assert f"sheet {NAMES['pushed']}" not in loaded.draft.unused and not loaded.draft.sheet.doubts
    free = brought(book, sheet=NAMES["free"])
    assert not free.draft.loads.wrench.any()
    assert f"sheet {NAMES['force']}" in free.draft.unused


def test_a_loaded_sheet_without_a_load_is_doubted(tmp_path: Path) -> None:
    names = {what: title for what, title in NAMES.items() if what != "force"}
    found = brought(workbook(tmp_path / "all.xlsx", **names), sheet=NAMES["pushed"])
    assert any("is under a load, and no column says which" in doubt for doubt in found.doubts)


def test_two_sheets_for_one_purpose_are_refused() -> None:
    assert named_sheets(["A", "loads=B=C"]) == {"": "A", "loads": "B=C"}
    assert named_sheets(["x=1"]) == {"": "x=1"}
    with pytest.raises(InputError, match="two sheets for one purpose, A and B"):
        named_sheets(["A", "B"])


@pytest.mark.parametrize(
    ("title", "loaded"),
    [
        ("Tracker loaded", True), ("belastet", True), ("with load", True), ("mit Tracker", False),
        ("End", False), ("unloaded", False), ("Loads", False), (None, False),
    ],
)  # fmt: skip
def test_names_that_say_under_load(title: str | None, loaded: bool) -> None:
    assert under_load(title) is loaded


def test_a_sheet_of_joints_whose_positions_are_the_robots_own_is_named(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", free="Readings (mm)", q="Robot (deg)")
    made = openpyxl.load_workbook(book)
    for column, axis in enumerate("XYZ", 8):
        made["Robot (deg)"].cell(1, column).value = f"{axis} [mm]"
        for row in range(2, 16):
            made["Robot (deg)"].cell(row, column).value = 1.0
    made.save(book)
    names = r"--sheet 'Readings \(mm\)' --sheet 'joints=Robot \(deg\)'"
    with pytest.raises(InputError, match=names):
        brought(book)
    found = brought(book, sheet=["Readings (mm)", "joints=Robot (deg)"])
    assert found.fitted is not None and found.fitted.rms < 3e-3


def test_joints_in_a_sheet_of_that_name_may_be_numbered(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", free="Readings (mm)", q="Gelenke (deg)")
    made = openpyxl.load_workbook(book)
    for k in range(1, 7):
        made["Gelenke (deg)"].cell(1, k + 1).value = k
    made.save(book)
    assert brought(book).fitted is not None


def test_without_joints_the_sheets_that_may_have_them_are_named(tmp_path: Path) -> None:
    book = workbook(tmp_path / "all.xlsx", free="Readings (mm)", force="Force (N)")
    with pytest.raises(InputError, match=r"Info and Force \(N\)\).*--sheet 'joints=Info'"):
        brought(book)
