"""Readings with and without load along one axis or two, or of a gauge along a direction."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.drafting import Draft, drafted
from sk120stiff.measurements.importers.loads.pairs import unfolded
from sk120stiff.measurements.importers.told import Told
from tests.measurements.importers.reading import sheet_of, written

TWO = ("joint_1", "joint_2")
ROWS = "1;10;20;500;57,2;56,3\n2;10;20;1000;53,8;52,6\n3;30;40;500;57,2;50,0\n"
HEAD = "Test;A1 [°];A2 [°];Masse (g);"


def read(folder: Path, text: str, **known: object) -> Draft:
    return drafted(unfolded(sheet_of(folder, text, TWO, **known)), Told(), TWO, ())


def test_one_axis_is_enough_for_differences(tmp_path: Path) -> None:
    found = read(tmp_path, f"{HEAD}z vorher (1/100 mm);z nachher (1/100 mm)\n{ROWS}")
    assert written(found)["dz[um]"] == ("-9", "-12", "-72")
    assert written(found)["dx[um]"] == ("", "", "")
    np.testing.assert_allclose(found.measured[:, 2], [-9e-6, -12e-6, -72e-6])
    np.testing.assert_allclose(found.loads.wrench[:, 2], [-4.903325, -9.80665, -4.903325])
    assert found.sheet.zero == "separate" and found.sheet.subtracted
    assert any("dz is z nachher (1/100 mm) less z vorher" in said for said in found.said)


def test_readings_without_load_that_rows_of_a_pose_repeat_are_shared(tmp_path: Path) -> None:
    text = f"{HEAD}z before [mm];z after [mm]\n{ROWS.replace('53,8', '57,2')}"
    assert read(tmp_path, text).sheet.zero == "shared"


def test_two_axes(tmp_path: Path) -> None:
    head = "A1 [°];A2 [°];Fz [N];x_before_mm;y_before_mm;x_after_mm;y_after_mm\n"
    found = read(tmp_path, f"{head}1;2;-9;1,5;2,5;1,25;2,75\n")
    assert [written(found)[f"d{a}[mm]"] for a in "xyz"] == [("-0.25",), ("0.25",), ("",)]


def test_half_a_pair_beside_a_whole_one_is_refused(tmp_path: Path) -> None:
    head = "A1 [°];A2 [°];Fz [N];z_before_mm;z_after_mm;y_after_mm\n"
    with pytest.raises(InputError, match="are not there"):
        read(tmp_path, f"{head}1;2;-9;1;2;3\n")


def test_a_gauge_without_a_direction_is_asked_for_it(tmp_path: Path) -> None:
    text = f"{HEAD}Messuhr vorher (1/100 mm);Messuhr nachher (1/100 mm)\n{ROWS}"
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    remedy = str(caught.value)
    assert "along which axis" in remedy and "z unloaded [1/100 mm],z loaded [1/100 mm]" in remedy
    names = remedy.partition("--columns '")[2].partition("'")[0].split(",")
    assert written(read(tmp_path, text, columns=tuple(names)))["dz[um]"][0] == "-9"


def test_a_gauge_along_a_direction(tmp_path: Path) -> None:
    head = f"{HEAD}Messuhr vorher (1/100 mm);Messuhr nachher (1/100 mm);ux;uy;uz\n"
    text = head + ROWS.replace("\n", ";0;0;-1\n")
    found = written(read(tmp_path, text))
    assert found["dz[um]"] == ("9", "12", "72") and found["dx[um]"] == ("", "", "")
