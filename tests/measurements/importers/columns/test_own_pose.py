"""Which of several groups of columns was measured: the controller's own pose is not, and where no
word says so, somebody is asked."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from tests.measurements.importers.columns.test_compound_headers import axes, joints, table
from tests.measurements.importers.reading import draft_of, sheet_of

DEGREES = joints("q{}[deg]")


@pytest.mark.parametrize(
    "form",
    [
        "robot_{}[mm]", "flange_{}[mm]", "controller_{}[mm]", "rtde_{}[mm]", "ee_{}[mm]",
        "tcp_pose_{}[mm]", "actual_tcp_{}[mm]", "{}_robot[mm]", "/tcp_pose/pose/position/{}",
    ],
)  # fmt: skip
def test_the_controllers_own_pose_is_not_taken_for_a_measured_one(
    form: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="the robot's own, and no position that was measured"):
        sheet_of(tmp_path, table(*DEGREES, *axes(form)))


def test_actual_beside_target_is_the_controllers_own_all_the_same(tmp_path: Path) -> None:
    text = table(*DEGREES, *axes("actual_tcp_{}[mm]"), *axes("target_tcp_{}[mm]"))
    with pytest.raises(InputError, match="may be the positions that were measured"):
        sheet_of(tmp_path, text)


def test_who_names_the_topic_gets_it(tmp_path: Path) -> None:
    text = table(*DEGREES, *axes("/tcp_pose/pose/position/{}"))
    assert sheet_of(tmp_path, text, topic="/tcp_pose").has("x", "y", "z")


@pytest.mark.parametrize("form", ["/vicon/tool/point/{}", "tool_marker_{}[mm]", "leica_{}[mm]"])
def test_an_instrument_that_follows_the_tool_is_taken(form: str, tmp_path: Path) -> None:
    assert sheet_of(tmp_path, table(*DEGREES, *axes(form))).has("x", "y", "z")


@pytest.mark.parametrize("form", ["lt_{}_mm", "mocap/base/position/{}", "/cam/pose/position/{}"])
def test_places_beside_plain_coordinates_are_asked_for(form: str, tmp_path: Path) -> None:
    text = table(*DEGREES, *axes("{}_mm"), *axes(form))
    with pytest.raises(InputError, match=r"x_mm, y_mm, z_mm or .* may be the positions") as caught:
        sheet_of(tmp_path, text)
    assert "--columns" in str(caught.value)


def test_words_that_say_measured_decide_beside_plain_coordinates(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, table(*DEGREES, *axes("{}_mm"), *axes("lt_meas_{}_mm")))
    headers = [column.header for m in ("x", "nominal x") if (column := sheet.get(m))]
    assert headers == ["lt_meas_x_mm", "x_mm"]
    assert any("lt_meas_x_mm to lt_meas_z_mm are taken, as measured" in n for n in sheet.notes)


@pytest.mark.parametrize("form", ["goal_{}_mm", "robot_{}_mm"])
def test_plain_coordinates_beside_commanded_or_own_ones_are_taken_and_said(
    form: str, tmp_path: Path
) -> None:
    sheet = sheet_of(tmp_path, table(*DEGREES, *axes("{}_mm"), *axes(form)))
    column = sheet.get("x")
    assert column is not None and column.header == "x_mm"
    assert any("x_mm to z_mm are taken, as measured positions" in note for note in sheet.notes)


def test_a_topic_that_is_told_decides_beside_plain_coordinates(tmp_path: Path) -> None:
    text = table(*DEGREES, *axes("{}_mm"), *axes("/mocap/tool/position/{}"))
    column = sheet_of(tmp_path, text, topic="/mocap/tool").get("x")
    assert column is not None and column.header == "/mocap/tool/position/x"


def test_measured_joints_are_taken_before_plain_ones_and_that_is_said(tmp_path: Path) -> None:
    text = table(*DEGREES, *joints("q{}_meas [deg]"), *axes("{}_mm"))
    found = draft_of(tmp_path, text)
    assert tuple(c.header for c in found.joints.taken) == joints("q{}_meas [deg]")
    assert any("q1_meas [deg] to q6_meas [deg] are taken, as measured" in s for s in found.said)
    named = draft_of(tmp_path, text, joints=joints("q{}"))
    assert tuple(c.header for c in named.joints.taken) == DEGREES


def test_of_two_measured_groups_beside_plain_joints_none_is_taken(tmp_path: Path) -> None:
    text = table(*DEGREES, *joints("q{}_meas_deg"), *joints("q{}_actual_deg"), *axes("{}_mm"))
    with pytest.raises(InputError, match=r"q6_meas_deg or|q6_meas_deg and"):
        draft_of(tmp_path, text)


def test_plain_joints_beside_measured_ones_are_no_quaternion(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table(*DEGREES, *joints("q{}_meas [deg]"), *axes("{}_mm")))
    assert not found.sheet.has("qw")
    assert any("q1[deg]: commanded" in left for left in found.unused)
    abb = table(*joints("J{}_meas [deg]"), *joints("q{}", count=4), *axes("{}_mm"))
    sheet = sheet_of(tmp_path, abb)
    column = sheet.get("joint 1")
    assert sheet.has("qw", "qz") and column is not None and column.header == "J1_meas [deg]"
