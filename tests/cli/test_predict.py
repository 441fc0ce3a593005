"""`sk120stiff predict`: predictions, gaps, and loads that nothing can hold."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from sk120stiff.measurements import read_measurements
from sk120stiff.model import joint_spring_model, write_model
from sk120stiff.robot import load_robot

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


def test_loads_that_nothing_holds_are_left_empty_and_say_so(run, tmp_path: Path) -> None:
    """Springs of 500 N·m/rad: for three of the paper's loads no equilibrium is found."""
    robot = load_robot("motoman_sk120")
    soft = tmp_path / "soft.yaml"
    write_model(joint_spring_model(robot, [500.0] * 3 + [np.inf] * 3), soft)
    data, out = str(DATA / "table2_measured.csv"), tmp_path / "predicted.csv"
    outcome = run("predict", str(soft), data, "--out", str(out), "--json")
    assert outcome.code == 0
    assert "3 of 15 loads are beyond what the springs can hold" in outcome.stderr
    found = outcome.document["rows"]
    missing = [k for k, row in enumerate(found) if row["predicted_dx[mm]"] is None]
    assert len(missing) == 3
    for k, row in enumerate(found):
        assert ("no static equilibrium" in row["reason"]) == (k in missing)
    assert "no static equilibrium" in out.read_text(encoding="utf-8")
    rows = Path(data).read_text(encoding="utf-8").splitlines()
    alone = tmp_path / "alone.csv"
    alone.write_text("\n".join([rows[0], rows[1 + missing[0]]]), encoding="utf-8")
    settings = (DATA / "table2_measured.yaml").read_text(encoding="utf-8")
    alone.with_suffix(".yaml").write_text(settings, encoding="utf-8")
    refused = run("predict", str(soft), str(alone), "--json")
    assert (refused.code, refused.answered) == (1, False)


def test_bad_input(run) -> None:
    data = str(DATA / "table2_measured.csv")
    for model, hint in (("missing.yaml", "missing.yaml"), (data, "model file")):
        outcome = run("predict", model, data)
        assert outcome.code == 2
        assert hint in outcome.stderr
