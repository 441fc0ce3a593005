"""Headers that programs compose: topics, instruments, qualifiers, numbers from 0, units behind."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.compound_headers import compound
from tests.measurements.importers.reading import draft_of, sheet_of, written

SIX = tuple(f"joint_{k}" for k in range(1, 7))
TWO = ("joint_1", "joint_2")


def table(*headers: str, rows: int = 2) -> str:
    """So many rows of numbers below headers, each other than the next."""
    cells = [",".join(str(10 * row + k) for k in range(len(headers))) for row in range(rows)]
    return "\n".join([",".join(headers), *cells]) + "\n"


def joints(form: str, first: int = 1, count: int = 6) -> tuple[str, ...]:
    return tuple(form.format(k) for k in range(first, first + count))


def axes(form: str) -> tuple[str, ...]:
    return tuple(form.format(axis) for axis in "xyz")


@pytest.mark.parametrize(
    ("header", "meaning", "unit"),
    [
        ("A3_ist", "joint 3", None),
        ("joint_4_actual_deg", "joint 4", "deg"),
        ("target_q_0", "joint 0", None),
        ("rtde.actual_q_5", "joint 5", None),
        ("/joint_states/position[10]", "joint 10", None),
        ("joint_states.position.0", "joint 0", None),
        ("field.position2", "joint 2", None),
        ("/joint_states/joint_2/position", "joint 2", None),
        ("/tracker/target/pose/position/z", "z", None),
        (".pose.position.x", "x", None),
        ("field.transform.translation.y", "y", None),
        ("/mocap/tool/pose/orientation/w", "qw", None),
        ("leica_y_mm", "y", "mm"),
        ("lt_z_m", "z", "m"),
        ("lt_x_before_mm", "unloaded x", "mm"),
        ("after_lt_x_mm", "loaded x", "mm"),
        ("y_leica", "y", None),
        ("leica_at960_x_mm", "x", "mm"),
        ("/ft/wrench/force/x", "fx", None),
        ("/ft/wrench/torque/y", "my", None),
        ("ati_fz_N", "fz", "N"),
        ("Fx_kN", "fx", "kN"),
        ("ft_tx_Nm", "tx", "Nm"),
        ("time_ms", "time", "ms"),
        ("field.header.stamp", "time", None),
        ("T_amb[°C]", "temperature", "°C"),
        ("/arm_controller/state/actual/positions[2]", "joint 2", None),
        ("position_3", "joint 3", None),
        ("Achse2_ist_Grad", "joint 2", "deg"),
        ("vicon_x_meters", "x", "m"),
        ("t_s", "time", "s"),
        ("Temperature_K", "temperature", "K"),
        ("room_temp_degC", "temperature", "degC"),
    ],
)
def test_what_headers_say(header: str, meaning: str, unit: str | None) -> None:
    found = compound(header, SIX)
    assert found is not None and (found.meaning, found.unit) == (meaning, unit)


@pytest.mark.parametrize(
    "header",
    [
        "/joint_states/velocity[0]", "/joint_states/effort[3]", "field.velocity0", "actual_qd_0",
        "actual_current_1", "actual_TCP_pose_0", "actual_TCP_force_2", "/odom/twist/linear/x",
        "/joint_states/header/stamp/nsecs", "gripper_q_1", "x_error_mm", "temp_limit_N",
        "tracker_x_kg", "operator", "lt_serial_2",
    ],
)  # fmt: skip
def test_what_is_none_of_these(header: str) -> None:
    assert compound(header, SIX) is None


def test_measured_joints_are_preferred_to_commanded_ones_and_that_is_said(tmp_path: Path) -> None:
    text = table(
        *joints("q{}_cmd_rad"), *joints("q{}_meas_rad"), *axes("lt_{}_m"), *axes("ft_f{}_N"),
        *axes("ft_t{}_Nm"),
    )  # fmt: skip
    found = draft_of(tmp_path, text, forces="tool")
    assert [c.header for c in found.joints.taken] == list(joints("q{}_meas_rad"))
    assert [c.meaning for c in found.loads.taken] == ["fx", "fy", "fz", "mx", "my", "mz"]
    assert written(found)["x[m]"] == ("12", "22")
    assert any("q1_meas_rad to q6_meas_rad are taken, as measured" in said for said in found.said)
    assert any("q1_cmd_rad: commanded" in left for left in found.unused)
    column = found.sheet.get("x")
    assert column is not None and column.stated == "the header, line 1"


def test_plain_joints_beside_commanded_ones_are_the_measured(tmp_path: Path) -> None:
    found = draft_of(tmp_path, table(*joints("q{}_cmd_deg"), *joints("q{}_deg"), *axes("{}_mm")))
    assert found.joints.taken[0].header == "q1_deg"
    assert any("q1_deg to q6_deg are taken for measured joints" in said for said in found.said)


def test_an_instrument_beside_nominal_places_and_angles(tmp_path: Path) -> None:
    head = (*joints("q{}_deg"), *axes("target_{}"), "rx", "ry", "rz", *axes("lt_{}_mm"))
    column = sheet_of(tmp_path, table(*head)).get("x")
    assert column is not None and column.header == "lt_x_mm"


def test_commanded_joints_alone_are_taken_and_that_is_said(tmp_path: Path) -> None:
    text = table(*joints("target_q_{}", 0), *axes("tracker_{}"))
    found = draft_of(tmp_path, text, angle="rad", length="mm")
    assert found.joints.taken[0].header == "target_q_0"
    assert any("Joint values are commanded ones" in said for said in found.said)


def test_a_part_of_a_topic_may_say_measured(tmp_path: Path) -> None:
    form = "/arm/state/{}/positions[{{}}]"
    parts = [joints(form.format(word), 0) for word in ("desired", "actual", "error")]
    text = table(*parts[0], *parts[1], *parts[2], *axes("/mocap/target/pose/position/{}"))
    found = draft_of(tmp_path, text, angle="rad", length="m")
    assert tuple(c.header for c in found.joints.taken) == parts[1]


def test_joints_that_the_user_names_may_be_the_commanded_ones(tmp_path: Path) -> None:
    text = table(*joints("target_q_{}", 0), *joints("actual_q_{}", 0), *axes("tracker_{}"))
    names = joints("target_q_{}", 0)
    found = draft_of(tmp_path, text, angle="rad", length="mm", joints=names)
    assert tuple(c.header for c in found.joints.taken) == names


def test_two_groups_of_joints_are_asked_for(tmp_path: Path) -> None:
    text = table(*joints("/left/actual_q_{}", 0), *joints("/right/actual_q_{}", 0), "x", "y", "z")
    with pytest.raises(InputError, match=r"these may each be: /left/actual_q_0.*or /right/actual"):
        draft_of(tmp_path, text, angle="rad", length="mm")


def test_a_recording_as_text(tmp_path: Path) -> None:
    text = table(
        "/joint_states/header/stamp", *joints("/joint_states/position[{}]", 0),
        *joints("/joint_states/effort[{}]", 0), *axes("/vicon/tool/pose/position/{}"),
        *(f"/vicon/tool/pose/orientation/{axis}" for axis in "xyzw"),
    )  # fmt: skip
    sheet = sheet_of(tmp_path, text)
    assert sheet.has("time", "joint 0", "joint 5", "x", "y", "z", "qw", "qx", "qy", "qz")
    assert sheet.get("joint 1") and sheet.get("joint 1").unit is None  # type: ignore[union-attr]
    assert len(sheet.spare) == 6  # efforts


def test_comma_separated_text_of_older_programs(tmp_path: Path) -> None:
    head = ["%time", "field.header.seq", *joints("field.position{}", 0)]
    text = table(*head, *axes("field.pose.position.{}"))
    sheet = sheet_of(tmp_path, text)
    assert sheet.has("time", "joint 0", "joint 5", "x", "y", "z")


def test_of_two_topics_with_positions_one_is_asked_for_and_can_be_told(tmp_path: Path) -> None:
    text = table(
        *joints("q{}[deg]"), *axes("/vicon/base/pose/position/{}"),
        *axes("/vicon/tool/pose/position/{}"),
    )  # fmt: skip
    with pytest.raises(InputError, match=r"or /vicon/tool/pose/position/x.*--topic"):
        sheet_of(tmp_path, text)
    sheet = sheet_of(tmp_path, text, topic="/vicon/tool")
    column = sheet.get("x")
    assert column is not None and column.header == "/vicon/tool/pose/position/x"
    with pytest.raises(InputError, match="no positions stand in columns of the topic"):
        sheet_of(tmp_path, text, topic="/vicon/other")


def test_an_instrument_is_preferred_to_the_robots_own_pose(tmp_path: Path) -> None:
    text = table(*joints("q{}[deg]"), *axes("/ee/pose/position/{}"), *axes("/vicon/smr/point/{}"))
    sheet = sheet_of(tmp_path, text)
    column = sheet.get("x")
    assert column is not None and column.header == "/vicon/smr/point/x"
    assert any("as an instrument read them" in note for note in sheet.notes)


def test_forces_of_two_sensors_are_asked_for(tmp_path: Path) -> None:
    text = table(*joints("q{}[deg]"), *axes("{}[mm]"), *axes("/a/force/{}"), *axes("/b/force/{}"))
    with pytest.raises(InputError, match=r"/a/force/x.*or /b/force/x.*may be the load"):
        draft_of(tmp_path, text)


def test_a_letter_behind_an_axis_says_measured(tmp_path: Path) -> None:
    units = ",".join(["(deg)"] * 6 + ["(mm)"] * 3)
    text = table(*joints("J{}"), "Xm", "Ym", "Zm").replace("\n", f"\n{units}\n", 1)
    assert written(draft_of(tmp_path, text))["x[mm]"] == ("6", "16")


def test_a_metre_behind_an_axis_is_none_beside_nominal_ones(tmp_path: Path) -> None:
    text = table(*joints("q{}_deg"), *axes("{}_m"), *axes("{}_n"))
    sheet = sheet_of(tmp_path, text)
    column = sheet.get("x")
    assert column is not None and (column.header, column.unit) == ("x_m", None)
    alone = sheet_of(tmp_path, table(*joints("q{}_deg"), *axes("{}_m"))).get("x")
    assert alone is not None and alone.unit == "m"


def test_a_row_of_units_overrules_a_letter(tmp_path: Path) -> None:
    units = ",".join(["deg"] * 6 + ["mm"] * 3)
    text = table(*joints("q{}"), *axes("{}_m")).replace("\n", f"\n{units}\n", 1)
    column = sheet_of(tmp_path, text).get("x")
    assert column is not None and column.unit == "mm"


@pytest.mark.parametrize(
    ("header", "kelvin"), [("Temp_C", 0), ("temp_degC", 0), ("T_amb[°C]", 0), ("T_K", 1)]
)
def test_temperatures(tmp_path: Path, header: str, kelvin: int) -> None:
    found = written(draft_of(tmp_path, table(header, *joints("q{}_deg"), *axes("{}_mm"))))
    assert found[("temperature[degC]", "temperature[K]")[kelvin]] == ("0", "10")


@pytest.mark.parametrize(
    ("header", "cells", "seconds"),
    [
        ("time_ms", ("250", "1750"), ("0.250", "1.750")),
        ("timestamp_ns", ("0", "4000000"), ("0E-9", "0.004000000")),
        ("timestamp_ns", ("1700000000000000000", "1700000000500000000"),
         ("0.000000000", "0.500000000")),
    ],
)  # fmt: skip
def test_clocks_in_parts_of_seconds(
    tmp_path: Path, header: str, cells: tuple[str, str], seconds: tuple[str, str]
) -> None:
    rows = [f"{cell},1,2,3,4,5,{k},1,2,3" for k, cell in enumerate(cells)]
    text = "\n".join([",".join([header, *joints("q{}_deg"), *axes("{}_mm")]), *rows])
    found = written(draft_of(tmp_path, text))["time[s]"]
    assert [float(cell) for cell in found] == [float(cell) for cell in seconds]


def test_a_number_behind_position_may_be_an_axis(tmp_path: Path) -> None:
    text = table(*(f"/node/position[{k}]" for k in range(3)), "x", "y", "z")
    with pytest.raises(InputError, match="no joint values"):
        draft_of(tmp_path, text, ("a", "b", "c"), length="mm", angle="rad")


def test_values_in_two_units_are_asked_for(tmp_path: Path) -> None:
    text = table(*joints("q{}_meas_rad"), *joints("q{}_meas_deg"), *axes("lt_{}_mm"))
    with pytest.raises(InputError, match=r"q6_meas_rad or q1_meas_deg"):
        draft_of(tmp_path, text)


def test_axes_of_the_robot_do_not_go_with_a_position_of_an_instrument(tmp_path: Path) -> None:
    turns = [f"/ee/pose/orientation/{axis}" for axis in "wxyz"]
    sheet = sheet_of(tmp_path, table(*joints("q{}[deg]"), *axes("lt_{}_mm"), *turns))
    assert sheet.has("x") and not sheet.has("qw")


def test_rows_of_one_topic_each_are_told(tmp_path: Path) -> None:
    head = [*joints("/joint_states/position[{}]", 0), *axes("/vicon/tool/point/{}")]
    text = "\n".join([",".join(head), "1,2,3,4,5,6,,,", ",,,,,,1,2,3"])
    with pytest.raises(InputError, match=r"in none of 2 rows .* all topics") as caught:
        draft_of(tmp_path, text)
    assert "ffill" in str(caught.value)
