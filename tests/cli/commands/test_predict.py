"""`sk120stiff predict`: predictions, gaps, and loads that nothing can hold."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from sk120stiff.measurements import read_measurements
from sk120stiff.model import joint_spring_model, write_model
from sk120stiff.robot import load_robot
from tests.positions.arm import errors, poses, tracked, write
from tests.positions.test_forms import FIT, NOISE, SIGMA
from tests.positions.test_references import WARM, A, grown, readings_of

MODEL = "robots/motoman_sk120/model.yaml"
DATA = Path("robots/motoman_sk120/data")


def test_the_papers_calculated_column_comes_out(run) -> None:
    """0.18, 0.24 and 0.06 µm rms: rounding of the print and what it left unsaid."""
    found = run("predict", MODEL, str(DATA / "table2_calculated.csv"), "--json").document
    rms = [pose["rms_um"] for pose in found["per_pose"]]
    assert [pose["pose"] for pose in found["per_pose"]] == ["1", "2", "3"]
    assert max(rms) < 0.3
    assert len(found["rows"]) == 15


def test_gaps_by_hand(run, tmp_path: Path) -> None:
    out = tmp_path / "gaps.csv"
    data = str(DATA / "table2_measured.csv")
    found = run("predict", MODEL, data, "--out", str(out), "--json").document
    table = pd.read_csv(out)
    measured = read_measurements(data).displacement
    predicted = table[[f"predicted_d{axis}[mm]" for axis in "xyz"]].to_numpy() * 1e-3
    gap = 1e6 * (measured - predicted)
    np.testing.assert_allclose(table[[f"gap_{a}[um]" for a in "xyz"]].to_numpy(), gap, atol=1e-6)
    assert found["rms_um"] == pytest.approx(np.sqrt(np.mean(gap**2)), rel=1e-9)
    second = np.sqrt(np.mean(gap[5:10] ** 2))
    assert found["per_pose"][1]["rms_um"] == pytest.approx(second, rel=1e-9)
    assert "reason" not in table


def test_a_plan_has_predictions_and_no_gap(run, tmp_path: Path) -> None:
    rows = (DATA / "table2_measured.csv").read_text(encoding="utf-8").splitlines()
    plan = tmp_path / "plan.csv"
    plan.write_text("\n".join(",".join(row.split(",")[:10]) for row in rows), encoding="utf-8")
    settings = (DATA / "table2_measured.yaml").read_text(encoding="utf-8")
    plan.with_suffix(".yaml").write_text(settings, encoding="utf-8")
    outcome = run("predict", MODEL, str(plan), "--json")
    assert outcome.document["rms_um"] is None
    assert outcome.document["per_pose"] == []
    assert "Predicted" in run("predict", MODEL, str(plan)).stdout


COLUMN = """<robot name="column"><link name="floor"/><link name="bar"/><link name="top"/>
<joint name="hinge" type="revolute"><parent link="floor"/><child link="bar"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint>
<joint name="end" type="fixed"><parent link="bar"/><child link="top"/>
<origin xyz="0 0 2"/></joint></robot>"""


def test_loads_that_nothing_holds_are_left_empty_and_say_so(run, tmp_path: Path) -> None:
    """A column of 2 m on 1000 N·m/rad carries 500 N and no more."""
    urdf, soft = tmp_path / "column.urdf", tmp_path / "soft.yaml"
    urdf.write_text(COLUMN, encoding="utf-8")
    write_model(joint_spring_model(load_robot(str(urdf)), [1000.0]), soft)
    data, out = tmp_path / "loads.csv", tmp_path / "predicted.csv"
    rows = ["pose,hinge[deg],fx[N],fy[N],fz[N]", "a,0,0,0,-490", "b,0,0,0,-600", "c,0,1,0,-450"]
    data.write_text("\n".join(rows), encoding="utf-8")
    data.with_suffix(".yaml").write_text("robot: column.urdf\n", encoding="utf-8")
    outcome = run("predict", str(soft), str(data), "--out", str(out), "--json")
    assert outcome.code == 0
    assert "1 of 3 loads are beyond what the springs can hold" in outcome.stderr
    found = outcome.document["rows"]
    assert [row["predicted_dx[mm]"] is None for row in found] == [False, True, False]
    assert ["no static equilibrium" in row["reason"] for row in found] == [False, True, False]
    assert "no static equilibrium" in out.read_text(encoding="utf-8")
    data.write_text("\n".join([rows[0], rows[2]]), encoding="utf-8")
    refused = run("predict", str(soft), str(data), "--json")
    assert (refused.code, refused.answered) == (1, False)


def test_an_arm_that_bends_like_no_arm_is_doubted(run, tmp_path: Path) -> None:
    """Springs of 500 N·m/rad for 5e5: the way from zero load is stable, and ends far away."""
    robot = load_robot("motoman_sk120")
    soft = tmp_path / "soft.yaml"
    write_model(joint_spring_model(robot, [500.0] * 3 + [np.inf] * 3), soft)
    data = str(DATA / "table2_measured.csv")
    outcome = run("predict", str(soft), data, "--json")
    assert outcome.code == 0
    assert all(row["predicted_dx[mm]"] is not None for row in outcome.document["rows"])
    assert "of the arm's length" in outcome.stderr
    pose, wrench = ("--pose", "0,30,0,0,0,0 deg"), ("--wrench", "0,0,-400 N")
    shown = run("stiffness", "motoman_sk120", "--model", str(soft), *pose, *wrench, "--json")
    assert "of the arm's length" in shown.stderr
    usual = run("stiffness", "motoman_sk120", *pose, *wrench, "--json")
    assert "of the arm's length" not in usual.stderr


def test_bad_input(run) -> None:
    data = str(DATA / "table2_measured.csv")
    for model, hint in (("missing.yaml", "missing.yaml"), (data, "model file")):
        outcome = run("predict", model, data)
        assert outcome.code == 2
        assert hint in outcome.stderr


def test_where_the_marker_of_a_calibration_sat_is_said(run, tmp_path: Path) -> None:
    """It moves the point of other readings too, and they may be of another point."""
    model = tmp_path / "model.yaml"
    off = zip("xyz", (0.03, 0.0, 0.04), strict=True)
    offset = ", ".join(f"offset_{axis}: {{value: {size}, unit: m}}" for axis, size in off)
    model.write_text(
        f"{Path(MODEL).read_text()}  - name: tool_offset\n    where: tool0\n"
        f"    parameters: {{{offset}}}\n"
    )
    for used, told in ((str(model), True), (MODEL, False)):
        found = run("predict", used, str(DATA / "table2_measured.csv"))
        assert found.code == 0, found.stderr
        assert ("50 mm off its stated place" in " ".join(found.stdout.split())) == told


def test_identify_takes_growth_and_writes_from_where_it_counts(run, tmp_path: Path) -> None:
    """Read at a temperature and without a clock."""
    x = tracked(grown(A, WARM - 20.0)) + SIGMA * np.random.default_rng(7).normal(size=(60, 3))
    data = readings_of(tmp_path, A, x, FIT + NOISE, "temperature[degC]", WARM)
    out = tmp_path / "model.yaml"
    asked = ("--with", "thermal_growth:l2", "--out", str(out), "--json")
    assert run("identify", str(data.path), *asked).code == 0
    assert f"reference: {{temperature: {WARM.mean():.3f}"[:30] in out.read_text(encoding="utf-8")
    for t, kelvin in ((20.0, 0.0), (60.0, 40.0)):
        settings = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm}\n"
        at = tracked(grown(A[:1], np.array([kelvin])))
        row = readings_of(tmp_path / f"{t:g}", A[:1], at, settings, "temperature[degC]", [t])
        said = run("predict", str(out), str(row.path), "--json").document["rows"][0]
        for axis in "xyz":
            assert abs(said[f"gap_{axis}[um]"]) < 4.0 * said[f"std_parameters_{axis}[um]"]


def test_positions_far_off_all_others_are_told_apart(run, tmp_path: Path) -> None:
    """`explain` and `identify` set such a row aside: their gap is the one without it."""
    a = poses(30, 4)
    x = tracked(errors(4).stands(a)[0]) + 2e-5 * np.random.default_rng(4).normal(size=(30, 3))
    x[7] += [0.004, 0.0, 0.003]
    file, model = str(write(tmp_path, a, x, FIT)), str(tmp_path / "model.yaml")
    fitted = run("identify", file, "--out", model, "--json").document
    found = run("predict", model, file, "--json").document
    assert [each["line"] for each in found["far_off"]] == [9]
    assert [each["line"] for each in fitted["set_aside"]] == [9]
    assert found["rms_without_um"] == pytest.approx(fitted["rms_um"], rel=0.01)
    assert found["rms_um"] > 20.0 * found["rms_without_um"]
    assert "line 9 (pose " in run("predict", model, file).stdout
