"""Headers of several words where blanks stand between cells: which words belong together."""

from pathlib import Path

import pytest

from tests.measurements.importers.reading import sheet_of

ONE = ("joint_1",)


def rows(count: int) -> str:
    return "\n".join(
        f"P{k} " + " ".join(f"{10 * k + c}.5" for c in range(count - 1)) for k in (1, 2, 3)
    )


@pytest.mark.parametrize(
    ("headers", "measured"),
    [
        ("Name Nominal X Nominal Y Nominal Z Measured X Measured Y Measured Z Residual", 4),
        ("Point Name X Actual Y Actual Z Actual X Nominal Y Nominal Z Nominal Total Error", 1),
        ("名称 名义 X 名义 Y 名义 Z 测量 X 测量 Y 测量 Z 余量 位置", 4),
    ],
)
def test_the_words_of_a_header_are_found(tmp_path: Path, headers: str, measured: int) -> None:
    sheet = sheet_of(tmp_path, f"{headers}\n{rows(8)}\n", ONE)
    x = sheet.get("x")
    assert x is not None
    assert x.cells == tuple(f"{10 * k + measured - 1}.5" for k in (1, 2, 3))
    assert "as the headers of 8 columns" in " ".join(sheet.notes)


def test_angles_that_were_measured_are_the_orientation(tmp_path: Path) -> None:
    named = ("X", "Y", "Z", "Rx", "Ry", "Rz")
    axes = [f"{of} {axis}" for of in ("Nominal", "Measured") for axis in named]
    sheet = sheet_of(tmp_path, f"Name {' '.join(axes)}\n{rows(13)}\n", ONE)
    turned = sheet.get("orientation x")
    assert turned is not None and turned.header == "Measured Rx"
    assert [column.header for column in sheet.spare] == ["Nominal Rx", "Nominal Ry", "Nominal Rz"]


def test_rows_as_long_as_their_headers_are_left_alone(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, f"name x y z\n{rows(4)}\n", ONE)
    assert "as the headers" not in " ".join(sheet.notes)


def test_a_sentence_above_the_numbers_is_no_header(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, f"what ever this may be about in all\n{rows(4)}\n", ONE)
    assert "as the headers" not in " ".join(sheet.notes)
    assert sheet.has("name", "x", "y", "z")
