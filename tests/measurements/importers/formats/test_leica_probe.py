"""A six-degree probe of a Leica tracker: Q0 to Q3 are a quaternion, U(95) an uncertainty."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements.importers import Sheet
from tests.measurements.importers.reading import draft_of, sheet_of

HEADERS = (
    "X  [mm],Y  [mm],Z  [mm],U(95)  [mm],U(95) X  [mm],U(95) Y  [mm],U(95) Z  [mm],Tilt  [deg],"
    "Q0 ,Q1 ,Q2 ,Q3 ,Image RMS  [µm],Target,Temperature  [°C],Pressure  [mBar],Time Stamp,Delete"
)
QUATERNIONS = ((0.5, -0.5, 0.5, 0.5), (0.6, 0.0, -0.8, 0.0), (0.0, 0.28, 0.96, 0.0))


def table(rows: tuple[tuple[float, ...], ...] = QUATERNIONS, headers: str = HEADERS) -> str:
    lines = [headers]
    for k, row in enumerate(rows):
        turned = ",".join(f"{x:.6f}" for x in row)
        lines.append(
            f"{700 + k}.5,-3193.366,303.745,0.004,0.003,0.001,0.003,29.9,{turned},0.22,"
            f"Probe #5,22.{k},1018,'11.10.2022 15:06:4{k}.043,"
        )
    return "\n".join(lines) + "\n"


def test_the_table_is_understood(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, table())
    assert "U(95" in sheet.why
    uncertainty = sheet.get("sx")
    assert uncertainty is not None and (uncertainty.unit, uncertainty.factor) == ("mm", 0.5)
    meanings = [column.meaning for column in sheet.columns]
    assert [m for m in meanings if m.startswith("q")] == ["qw", "qx", "qy", "qz"]
    assert not [m for m in meanings if m.startswith("joint")]


def test_clocks_that_a_spreadsheet_marked_as_text_are_read(tmp_path: Path) -> None:
    headers = HEADERS.replace("Pressure  [mBar]", "joint_1 [deg]")
    found = draft_of(tmp_path, table(headers=headers), ("joint_1",))
    time = dict(found.other)["time[s]"]
    np.testing.assert_allclose([float(cell) for cell in time], [0.0, 1.0, 2.0])


def numbered(sheet: Sheet) -> set[str]:
    return {c.meaning for c in sheet.columns if c.header.strip().lower() in ("q0", "q1", "q2")}


@pytest.mark.parametrize("first", [0, 1])
def test_four_numbers_of_length_one_are_no_joints(tmp_path: Path, first: int) -> None:
    names = ",".join(f"q{first + k}" for k in range(4))
    rows = "\n".join(f"1,2,{k},{a},{b},{c},{d}" for k, (a, b, c, d) in enumerate(QUATERNIONS))
    sheet = sheet_of(tmp_path, f"x,y,z,{names}\n{rows}\n", ("a", "b", "c", "d"))
    assert sheet.has("qw", "qx", "qy", "qz")


def test_four_joints_stay_four_joints(tmp_path: Path) -> None:
    rows = "\n".join(f"1,2,{k},0.1,{k}.2,-0.3,0.7" for k in range(5))
    sheet = sheet_of(tmp_path, f"x,y,z,q0,q1,q2,q3\n{rows}\n", ("a", "b", "c", "d"))
    assert not sheet.has("qw")
    assert len(numbered(sheet)) == 3 and all(m.startswith("joint") for m in numbered(sheet))
