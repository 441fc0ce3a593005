"""Whatever the separator, decimal mark and encoding: the numbers that were printed."""

import codecs
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sk120stiff.measurements.importers.grid import text_grid
from tests.measurements.importers.reading import sheet_of

NUMBERS = st.decimals(-5000, 5000, allow_nan=False, allow_infinity=False, places=4)
ROWS = st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=3, max_size=8)
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252")


@given(
    rows=ROWS,
    separator=st.sampled_from([";", "\t", ",", "|", " ", "  "]),
    comma=st.booleans(),
    encoding=st.sampled_from(ENCODINGS),
    ending=st.sampled_from(["\n", "\r\n"]),
    named=st.booleans(),
    headed=st.booleans(),
    accent=st.booleans(),
)
@settings(max_examples=150, deadline=None,
          suppress_health_check=[HealthCheck.function_scoped_fixture])  # fmt: skip
def test_a_round_trip(
    tmp_path: Path, rows, separator, comma, encoding, ending, named, headed, accent
) -> None:
    comma = comma and separator != ","
    printed = [[f"{v:.4f}" for v in row] for row in rows]
    label = "Punktä" if accent else "P"
    lines = []
    if headed:
        lines.append(separator.join([*(["name"] if named else []), "X[mm]", "Y[mm]", "Z[mm]"]))
    for k, row in enumerate(printed):
        cells = [cell.replace(".", ",") if comma else cell for cell in row]
        lines.append(separator.join([*([f"{label}{k}"] if named else []), *cells]))
    text = ending.join([*lines, ""])
    data = text.encode(encoding)
    found = sheet_of(tmp_path, data)
    for k, axis in enumerate("xyz"):
        column = found.get(axis)
        assert column is not None and list(column.cells) == [row[k] for row in printed]
    if named:
        names = found.get("name")
        assert names is not None and names.cells[0] == f"{label}0"


def test_quotes_blanks_and_minus_signs(tmp_path: Path) -> None:
    text = 'name,x,y,z\n"Tag, 1", 1.5 ,\N{MINUS SIGN}2.5,+3e-1\n'
    grid = text_grid(tmp_path / "f", codecs.BOM_UTF8 + text.encode())
    assert grid.rows[1] == ("Tag, 1", "1.5", "-2.5", "+3e-1")
    quoted = 'x,y,z\n"1,5","2,5","3,5"\n'
    assert text_grid(tmp_path / "f", quoted.encode()).rows[1] == ("1.5", "2.5", "3.5")


@pytest.mark.parametrize("empty", ["", "\n\n", ";;;\n;;;\n"])
def test_blank_lines_are_nothing(tmp_path: Path, empty: str) -> None:
    text = f"{empty}x;y;z\n{empty}1,5;2;3\n{empty}"
    assert sheet_of(tmp_path, text).get("x").cells == ("1.5",)
