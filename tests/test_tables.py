"""What users print, and tables that go to pandas and come back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import sk120stiff as sk

DATA = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"


@pytest.fixture(scope="module")
def readings() -> sk.Measurements:
    return sk.read(DATA)


@pytest.fixture(scope="module")
def found(readings: sk.Measurements) -> sk.Fit:
    return sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)


def test_readings_go_to_a_table_and_come_back_as_they_were(readings) -> None:
    frame = readings.to_frame(angle="rad", length="m")
    point = {"xyz": (1e3 * readings.point).tolist(), "unit": "mm"}
    again = sk.Measurements.from_frame(
        frame, robot=readings.robot, base_frame=readings.base_frame,
        tool_frame=readings.tool_frame, point=point, displacement={"zero": readings.zero},
        noise={"sigma": 1e6 * readings.noise.sigma, "unit": "um"} if readings.noise.sigma else {},
    )  # fmt: skip
    for name in ("joints", "wrench", "displacement", "use", "zero_group"):
        np.testing.assert_array_equal(getattr(again, name), getattr(readings, name))
    assert again.pose == readings.pose and again.joint_names == readings.joint_names
    np.testing.assert_allclose(again.point, readings.point, rtol=1e-15)
    assert again.zero == readings.zero and again.path is None
    assert len(again.data_hash) == 64


def test_a_table_is_in_the_units_of_its_headers(readings) -> None:
    frame = readings.to_frame()
    joint = readings.joint_names[1]
    np.testing.assert_allclose(frame[f"{joint}[deg]"], np.degrees(readings.joints[:, 1]))
    np.testing.assert_allclose(frame["dz[mm]"], 1e3 * readings.displacement[:, 2])
    np.testing.assert_allclose(frame["fx[N]"], readings.wrench[:, 0])
    turned = frame.assign(**{f"{joint}[rad]": np.radians(frame[f"{joint}[deg]"])})
    again = sk.Measurements.from_frame(turned.drop(columns=f"{joint}[deg]"), readings.joint_names)
    np.testing.assert_allclose(again.joints, readings.joints, atol=1e-15)


def test_what_is_wrong_in_a_table_is_said_with_row_and_column(readings) -> None:
    frame = readings.to_frame()
    frame.loc[3, "fy[N]"] = np.nan
    with pytest.raises(sk.InputError, match="the cell is empty") as refused:
        sk.Measurements.from_frame(frame)
    assert refused.value.where == "frame, line 5, column fy[N]"
    with pytest.raises(sk.InputError, match="no unit"):
        sk.Measurements.from_frame(readings.to_frame().rename(columns={"fy[N]": "fy"}))
    with pytest.raises(sk.InputError, match="robott"):
        sk.Measurements.from_frame(readings.to_frame(), robott="motoman_sk120")


def test_a_table_without_rows_is_refused(readings) -> None:
    with pytest.raises(sk.InputError, match="no row of data"):
        sk.Measurements.from_frame(readings.to_frame().head(0))


def test_a_fit_is_a_table_in_public_units(found) -> None:
    frame = found.to_frame()
    assert list(frame["name"]) == [p.name for p in found.parameters]
    for row, parameter in zip(frame.itertuples(), found.parameters, strict=True):
        assert row.value == parameter.value and row.std == parameter.std
        assert row.low_95 < row.value < row.high_95
        assert row.unit == "N*m/rad"
    told = found.model.to_frame()
    pd.testing.assert_series_equal(told["value"].head(3), frame["value"], check_index=False)


def test_what_is_not_identifiable_has_no_number(readings) -> None:
    model = sk.base_model(sk.load_robot("motoman_sk120"))
    last = sk.joint_spring_model(model.robot).parameters[5:]
    blind = replace(readings, point=np.array([0.0, 0, 0.1]), force_point=np.array([0.0, 0, 0.1]))
    frame = sk.fit(model + last, blind).to_frame()
    row = frame.iloc[3]
    assert row["name"] == "joint_springs:joint_6_t.stiffness" and row["note"] == "not identifiable"
    assert np.isnan(row["value"]) and np.isnan(row["std"]) and np.isnan(row["low_95"])


def test_what_is_printed_is_one_short_line(readings, found) -> None:
    for item in (readings, found, found.model, found.model.robot, sk.CATALOGUE):
        assert "\n" not in repr(item) and len(repr(item)) < 500, repr(item)
    assert repr(found).startswith("<Fit: 17.2 µm rms; joint_springs:joint_1_s.stiffness 1.357e+06")
    assert repr(found.model) == (
        "<Model of motoman_sk120: joint_springs at joint_1_s, joint_2_l, joint_3_u>"
    )


def test_notebooks_show_tables_that_are_escaped(readings, found) -> None:
    named = replace(readings, pose=tuple(f"<b>{name}</b>" for name in readings.pose))
    for item in (named, found, found.model, found.model.robot):
        page = item._repr_html_()
        assert "<table" in page and "<b>" not in page
    assert "… 5 more rows" in named._repr_html_()
    assert "joint_6_t" in found.model.robot._repr_html_()


def test_what_a_model_says_and_makes_are_tables_too(readings, found) -> None:
    load = [0.0, 0.0, -490.0, 0.0, 0.0, 0.0]
    parameter = found.parameters[0]
    assert repr(parameter) == (
        f"<Parameter joint_springs:joint_1_s.stiffness = {parameter.value:.4g} ± "
        f"{parameter.std:.2g} N*m/rad>"
    )
    said = sk.predict(found.model, readings)
    for item, told in (
        (sk.CATALOGUE, "base_rocking"),
        (said, "x [µm]"),
        (replace(said, position=said.displacement), "x [mm]"),
        (sk.stiffness(found.model, [0, 0.2, -0.3, 0, -1, 0], load), "principal stiffness"),
        (sk.simulate(found.model, readings, seed=1), "exact dx"),
    ):
        page = item._repr_html_()
        assert "<table" in page and told in page and "nan" not in page
