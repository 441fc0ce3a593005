"""Displacements of which an axis was lost, of one gauge, and along a direction, imported."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import import_readings
from tests.measurements.importers.reading import draft_of, written
from tests.measurements.importers.tracked import ur5

HEAD = "Pose;A1 [°];A2 [°];A3 [°];A4 [°];A5 [°];A6 [°];Fx [N];Fy [N];Fz [N];"
POSE = ("1;1,5;2;3;4;5;6;0;0;-10;", "1;1,5;2;3;4;5;6;0;20;0;", "2;2,5;2;3;4;5;6;0;0;-10;")


def table(head: str, *rows: str) -> str:
    return "\n".join([HEAD + head, *(POSE[k] + row for k, row in enumerate(rows))]) + "\n"


@pytest.mark.parametrize("blank", ["", "--", "n.a.", "n/a", "NaN", "-"])
def test_a_lost_axis_leaves_the_others(blank: str, tmp_path: Path) -> None:
    text = table("dX [µm];dY [µm];dZ [µm]", f"-629;1692;{blank}", f"1;{blank};3", "4;5;6")
    found = draft_of(tmp_path, text)
    assert written(found)["dz[um]"] == ("", "3", "6")
    assert written(found)["dy[um]"] == ("1692", "", "5")
    np.testing.assert_allclose(
        1e6 * found.measured, [[-629, 1692, np.nan], [1, np.nan, 3], [4, 5, 6]]
    )
    assert not found.sheet.skipped
    said = next(note for note in found.said if "was not read" in note)
    assert "In 2 rows" in said and "dY [µm] in 1 and dZ [µm] in 1" in said


def test_a_row_without_any_axis_is_left_out(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table("dX [µm];dY [µm];dZ [µm]", "1;2;3", ";--;", "4;5;6"))
    assert found.pose == ("1", "2")
    assert found.sheet.skipped == ((3, "nothing stands in dX [µm], dY [µm], dZ [µm]"),)
    assert not any("was not read" in note for note in found.said)


def test_of_positions_a_row_without_an_axis_is_left_out(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table("X [mm];Y [mm];Z [mm]", "1;2;3", "1;2;", "4;5;6"))
    assert found.sheet.skipped == ((3, "nothing stands in Z [mm]"),)


def test_what_is_no_number_is_told_with_what_to_do(tmp_path: Path) -> None:
    text = table("dX [µm];dY [µm];dZ [µm]", "1;2;broken", "1;2;3")
    with pytest.raises(InputError, match="'broken' is no number") as caught:
        draft_of(tmp_path, text)
    assert "not read" in str(caught.value.remedy) and "line 2" in str(caught.value.where)


def test_a_factor_of_a_unit_leaves_blank_cells(tmp_path: Path) -> None:
    text = table("dX [1/100 mm];dY [1/100 mm];dZ [1/100 mm]", "1,5;2;--", "1;2;3")
    assert written(draft_of(tmp_path, text))["dz[um]"] == ("", "30")


def test_one_gauge_is_one_axis(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table("dz [µm]", "-2795", "--", "-5650"))
    assert found.displaced and found.pose == ("1", "2")
    assert found.readings == (
        ("dx[um]", ("", "")), ("dy[um]", ("", "")), ("dz[um]", ("-2795", "-5650")),
    )  # fmt: skip
    assert "Of dx and dy there is no column: not read." in found.said


def test_two_gauges_are_two_axes_in_their_own_units(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table("dz [µm];dx [mm]", "-2795;1", "3;2"))
    assert [header for header, _ in found.readings] == ["dx[mm]", "dy[mm]", "dz[um]"]
    np.testing.assert_allclose(found.measured[:, [0, 2]], [[1e-3, -2795e-6], [2e-3, 3e-6]])


def test_a_gauge_and_its_direction(tmp_path: Path) -> None:
    path = tmp_path / "gauges.csv"
    path.write_text(table("d[mm];ux;uy;uz", "-1,247;0;0;1", "0,442;0,6;0,8;0", "1;1;0;0"), "utf-8")
    found = import_readings(path, load_robot(ur5(), tool="tool0"), Told())
    assert found.mode == "displacements"
    assert dict(found.columns)["d[mm]"] == ("-1.247", "0.442", "1")
    assert not any(header.startswith(("sx", "dx")) for header, _ in found.columns)
    found.write(tmp_path / "out.csv")
    back = read_measurements(tmp_path / "out.csv").absolute
    assert back is not None and back.channels.shift is not None
    np.testing.assert_allclose(back.channels.shift, [-1.247e-3, 0.442e-3, 1e-3])
    np.testing.assert_allclose(back.channels.along, [[0, 0, 1], [0.6, 0.8, 0], [1, 0, 0]])


@pytest.mark.parametrize("off", ["0", "1e-9"])
def test_gauges_along_axes_are_displacements(off: str, tmp_path: Path) -> None:
    """Against an axis the number changes its sign, digit by digit; vectors need no unit length."""
    rows = (f"-1,2470;{off};0;1", "0,442;0;-2;0", "0;-1;0;0")
    path = tmp_path / "gauges.csv"
    path.write_text(table("d[mm];ux;uy;uz", *rows), "utf-8")
    found = import_readings(path, load_robot(ur5(), tool="tool0"), Told())
    columns = dict(found.columns)
    assert columns["dx[mm]"] == ("", "", "0")
    assert columns["dy[mm]"] == ("", "-0.442", "")
    assert columns["dz[mm]"] == ("-1.2470", "", "")
    assert found.readings.absolute is None
    np.testing.assert_allclose(
        found.draft.measured,
        [[np.nan, np.nan, -1.247e-3], [np.nan, -0.442e-3, np.nan], [0.0, np.nan, np.nan]],
    )
    assert any("each number stands under dx, dy or dz" in said for said in found.said)


def test_beside_displacements_the_same_letters_are_uncertainties(tmp_path: Path) -> None:
    text = table("dx [mm];dy [mm];dz [mm];ux;uy;uz", "1;2;3;0,1;0,2;0,3", "1;2;3;0,1;0,2;0,3")
    assert written(draft_of(tmp_path, text))["sy[mm]"] == ("0.2", "0.2")


def test_a_gauge_without_a_direction_is_asked_for_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no positions") as caught:
        draft_of(tmp_path, table("d [mm]", "1", "2"))
    assert "ux,uy,uz" in str(caught.value.remedy)
